#include "cli/views.h"

#include "cli/facet_viewer.h"
#include "cli/limit_viewer.h"

namespace trilens {

Viewer make_viewer(const World& world, std::size_t camera, Engine engine, const Warn& warn) {
    CameraRays rays = make_camera_rays(world.scene, camera);
    if (engine == Engine::kLimitTruth) return make_limit_viewer(world, std::move(rays));
    return make_facet_viewer(world, std::move(rays), engine, warn);
}

std::string engine_name(Engine engine) {
    switch (engine) {
        case Engine::kExact: return "exact";
        case Engine::kFacetsTruth: return "facets";
        case Engine::kLimitTruth: return "limit";
    }
    return "";
}

}  // namespace trilens
