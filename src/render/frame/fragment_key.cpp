#include "render/frame/fragment_key.h"

namespace trilens {

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
