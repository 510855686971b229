#include "render/frame/check_frame.h"

#include "base/util/error.h"
#include "base/util/format.h"

namespace trilens {

void check_frame(const World& world, const FrameParams& frame) {
    if (frame.camera >= world.scene.cameras.size())
        throw UsageError(fmt::format("there is no camera number {}; the scene has {}", frame.camera,
                                     world.scene.cameras.size()));
    if (frame.resolution < 0 || frame.resolution > kMaxResolution)
        throw UsageError(fmt::format("a resolution of {} is not in 1..{}", frame.resolution, kMaxResolution));
    if (frame.max_error && !(*frame.max_error >= 0 && *frame.max_error <= kMostMaxError))
        throw UsageError(
            fmt::format("an error of {} pixels is not in 0..{}", *frame.max_error, kMostMaxError));
}

}  // namespace trilens
