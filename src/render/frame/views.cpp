#include "render/frame/views.h"

#include <algorithm>

namespace trilens {

const PathEnd* SampleViews::find(const SampleView& sample, Path path) const {
    for (const PathEnd& end : ends_of(sample))
        if (end.path == path && end.principal) return &end;
    return nullptr;
}

void SampleViews::reset(std::size_t count) {
    restart(count);
    std::fill(samples.begin(), samples.end(), SampleView());
}

void SampleViews::restart(std::size_t count) {
    samples.resize(count);
    of_optics.resize(count);
    ends.clear();
    steps.clear();
    around.clear();
    volumes.clear();
    projected_facets = 0;
    crowded_out = 0;
    outline_pixels = outline_error = 0;
}

FragmentKey fragment_key(const SampleViews& views, const SampleView& view, Id face) {
    if (view.ray.direction == Vec3(0)) return kNoRay;
    if (view.optic == kNone) return view.unsure ? kAlone : key_of_object(view.hit.triangle);
    if (view.traced || view.unsure || view.nested > 0) return kAlone;
    FragmentKey key = key_of_optic(view.optic, face);
    for (const PathEnd& end : views.ends_of(view)) {
        if (end.node == kNone) return kAlone;
        key = joined(key, end.node, end.hit.triangle);
    }
    return key;
}

}  // namespace trilens
