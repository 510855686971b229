#include "render/engine.h"

#include "render/facet_engine.h"
#include "render/limit_engine.h"

namespace trilens {

Viewer make_viewer(const World& world, const FrameParams& frame, const EngineChoice& engine,
                   const Warn& warn) {
    prepare_shadows(world);
    if (engine.engine == Engine::kLimitTruth)
        return make_limit_viewer(world, make_camera_rays(world.scene, frame.camera));
    FrameParams params = frame;
    if (engine.engine == Engine::kEnvironment || engine.engine == Engine::kPlanar)
        params.rays = CornerRays::kInterpolated;
    return make_facet_viewer(world, make_frame(world, params, warn), engine);
}

std::string engine_name(Engine engine) {
    switch (engine) {
        case Engine::kExact:
            return "exact";
        case Engine::kClassic:
            return "classic";
        case Engine::kFacetsTruth:
            return "facets";
        case Engine::kLimitTruth:
            return "limit";
        case Engine::kEnvironment:
            return "envmap";
        case Engine::kPlanar:
            return "planar";
    }
    return "";
}

std::string classic_name(const ClassicParams& params) {
    std::string name;
    switch (params.curves) {
        case Curves::kStraight:
            name = "straight";
            break;
        case Curves::kSlices:
            name = "slices " + std::to_string(params.pieces);
            break;
        case Curves::kTessellate:
            name = "tessellate " + std::to_string(params.pieces);
            break;
        case Curves::kArcs:
            name = "arcs";
            break;
    }
    if (params.clip == Clip::kScreen) name += ", clip screen";
    if (params.clip == Clip::kUnclipped) name += ", clip none";
    return name;
}

}  // namespace trilens
