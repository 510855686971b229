#include "render/engines/engine.h"

#include <utility>

#include "base/util/error.h"
#include "base/util/names.h"
#include "render/engines/facet_engine.h"
#include "render/engines/limit_engine.h"
#include "render/frame/camera_media.h"
#include "render/world/caustic_lights.h"

namespace trilens {

std::unique_ptr<Viewer> make_viewer(const World& world, const FrameParams& frame, const EngineChoice& engine,
                                    const Warn& warn) {
    prepare_shadows(world);
    if (has_caustics(world)) warn_of_lost_light(world, caustic_lights(world), warn);
    if (engine.engine == Engine::kLimitTruth) {
        CameraRays camera = make_camera_rays(world.scene, frame.camera);
        warn_of_unsure_media(world, camera_media_of(world, camera), warn);
        return make_limit_viewer(world, std::move(camera));
    }
    FrameParams params = frame;
    if (engine.engine == Engine::kEnvironment || engine.engine == Engine::kPlanar)
        params.rays = CornerRays::kInterpolated;
    Frame placed = make_frame(world, params, warn);
    warn_of_unsure_media(world, placed.camera_media, warn);
    return make_facet_viewer(world, std::move(placed), engine);
}

std::string engine_name(Engine engine) {
    return name_of(engine);
}

const std::vector<std::string>& engine_names() {
    static const std::vector<std::string> names = names_of<Engine>();
    return names;
}

Engine find_engine(const std::string& name) {
    const std::optional<Engine> engine = find_named<Engine>(name);
    if (!engine) throw UsageError("there is no engine \"" + name + "\"" + suggestion(name, engine_names()));
    return *engine;
}

std::string classic_name(const ClassicParams& params) {
    std::string name = name_of(params.curves);
    if (params.curves == Curves::kSlices || params.curves == Curves::kTessellate)
        name += " " + std::to_string(params.pieces);
    if (params.clip != Clip::kScene) name += std::string(", clip ") + name_of(params.clip);
    return name;
}

}  // namespace trilens
