#include "trilens/suite.h"

#include <map>
#include <memory>
#include <utility>

#include "base/error.h"
#include "base/nearest.h"
#include "suite/suite.h"
#include "trilens/compare_inputs.h"
#include "trilens/render.h"
#include "trilens/scene.h"
#include "trilens/suite_scene.h"

namespace trilens {
namespace {

EngineChoice engine_of(const RenderTest& test, const std::string& name) {
    static const std::map<std::string, Engine> kEngines = {{"exact", Engine::kExact},
                                                           {"classic", Engine::kClassic},
                                                           {"facets", Engine::kFacetsTruth},
                                                           {"limit", Engine::kLimitTruth}};
    const auto found = kEngines.find(name);
    if (found != kEngines.end()) return found->second;
    std::vector<std::string> known;
    for (const auto& [engine, value] : kEngines) known.push_back(engine);
    throw InputError(test.folder + "/test.json", "/engine",
                     "there is no engine \"" + name + "\"" + suggestion(name, known));
}

}  // namespace

SuiteScene open_suite_scene(const RenderTest& test, const Progress& progress, const Warn& warn) {
    SceneRequest request;
    request.file = test.scene;
    for (const SceneSetting& setting : test.set)
        request.overrides.push_back({setting.pointer, setting.value});
    Scene scene = load_scene(request);
    if (warn)
        for (const std::string& warning : scene.warnings) warn(warning);
    const std::size_t camera = find_camera(scene, test.camera);
    const auto renderer = std::make_shared<const Renderer>(std::move(scene), warn);
    const Progress quiet{{}, progress.cancel};
    return {[renderer, camera, test, quiet, warn](const std::string& engine, int resolution) {
        PictureRequest picture;
        picture.frame = {camera, resolution};
        picture.engine = engine_of(test, engine);
        return renderer->draw(picture, quiet, warn).image;
    }};
}

SuiteResult run_suite(const SuiteRequest& request, const SuiteTalk& talk) {
    SuiteParams params;
    params.folders = request.folders;
    params.pattern = request.pattern;
    params.jobs = request.jobs;
    params.update = request.update;
    params.junit = request.junit;
    params.html = request.html;
    params.title = request.title;
    params.progress = talk.progress;
    params.on_test = talk.on_test;
    SuiteCallbacks callbacks;
    callbacks.open = [&](const RenderTest& test, const Warn& warn) {
        return open_suite_scene(test, talk.progress, warn);
    };
    callbacks.read = [](const std::string& file) { return read_compared_image(file); };
    return run_suite(params, callbacks);
}

std::vector<FoundTest> list_suite(const std::vector<std::string>& folders, const std::string& pattern) {
    return meant_tests(folders, pattern);
}

}  // namespace trilens
