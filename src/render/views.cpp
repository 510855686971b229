#include "render/views.h"

namespace trilens {

const PathEnd* SampleViews::find(const SampleView& sample, Path path) const {
    // Children stand after their parents, so the last one is nobody's parent.
    const std::span<const PathEnd> own = ends_of(sample);
    for (std::size_t i = own.size(); i-- > 0;)
        if (own[i].path == path) return &own[i];
    return nullptr;
}

void SampleViews::reset(std::size_t count) {
    samples.assign(count, {});
    ends.clear();
}

}  // namespace trilens
