#include "render/engines/engine.h"

#include <utility>

#include "base/util/error.h"
#include "base/util/suggestion.h"
#include "render/engines/facet_engine.h"
#include "render/engines/limit_engine.h"
#include "render/frame/camera_media.h"

namespace trilens {

FacetViews make_views(const World& world, const FrameParams& frame, const EngineChoice& engine,
                      const Warn& warn) {
    prepare_shadows(world);
    if (engine.engine == Engine::kLimitTruth) {
        CameraRays camera = make_camera_rays(world.scene, frame.camera);
        warn_of_unsure_media(world, camera_media_of(world, camera), warn);
        return {make_limit_viewer(world, std::move(camera)), {}};
    }
    FrameParams params = frame;
    if (engine.engine == Engine::kEnvironment || engine.engine == Engine::kPlanar)
        params.rays = CornerRays::kInterpolated;
    Frame placed = make_frame(world, params, warn);
    warn_of_unsure_media(world, placed.camera_media, warn);
    return make_facet_views(world, std::move(placed), engine);
}

Viewer make_viewer(const World& world, const FrameParams& frame, const EngineChoice& engine,
                   const Warn& warn) {
    return make_views(world, frame, engine, warn).viewer;
}

namespace {

constexpr std::pair<Engine, const char*> kEngines[] = {
    {Engine::kExact, "exact"},      {Engine::kClassic, "classic"},    {Engine::kFacetsTruth, "facets"},
    {Engine::kLimitTruth, "limit"}, {Engine::kEnvironment, "envmap"}, {Engine::kPlanar, "planar"}};

}  // namespace

std::string engine_name(Engine engine) {
    for (const auto& [known, name] : kEngines)
        if (known == engine) return name;
    return "";
}

const std::vector<std::string>& engine_names() {
    static const std::vector<std::string> names = [] {
        std::vector<std::string> all;
        for (const auto& [engine, name] : kEngines) all.emplace_back(name);
        return all;
    }();
    return names;
}

Engine find_engine(const std::string& name) {
    for (const auto& [engine, known] : kEngines)
        if (name == known) return engine;
    throw UsageError("there is no engine \"" + name + "\"" + suggestion(name, engine_names()));
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
