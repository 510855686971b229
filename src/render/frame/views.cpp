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
    projected_facets = 0;
    crowded_out = 0;
    outline_pixels = outline_error = 0;
}

}  // namespace trilens
