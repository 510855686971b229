#include "study/checked_world.h"

#include <utility>

#include "base/util/error.h"
#include "render/frame/frame.h"
#include "scene/data/check_scene.h"

namespace trilens {

std::unique_ptr<World> make_checked_world(Scene scene, const Warn& warn) {
    check_scene(scene);
    return make_world(std::move(scene), warn);
}

void check_request(const World& world, const PictureRequest& request) {
    check_frame(world, request.frame);
    const ClassicParams& classic = request.engine.classic;
    if (classic.pieces < 1 || classic.pieces > 1024 || !(classic.tolerance > 0))
        throw UsageError("the classic engine needs 1..1024 pieces and a positive tolerance");
}

}  // namespace trilens
