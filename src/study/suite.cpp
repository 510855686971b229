#include "study/suite.h"

#include <cstddef>
#include <filesystem>
#include <memory>
#include <system_error>
#include <utility>

#include "base/files/files.h"
#include "base/util/error.h"
#include "base/util/parallel.h"
#include "render/picture/picture.h"
#include "study/checked_world.h"
#include "study/compare_inputs.h"
#include "study/scenes.h"
#include "suite/suite.h"

namespace trilens {
namespace {

EngineChoice engine_of(const RenderTest& test, const std::string& name) {
    try {
        return find_engine(name);
    } catch (const UsageError& error) {
        throw InputError(test.folder + "/test.json", "/engine", error.what());
    }
}

std::size_t camera_of(const RenderTest& test, const Scene& scene) {
    try {
        return find_camera(scene, test.camera);
    } catch (const UsageError& error) {
        throw InputError(test.folder + "/test.json", "/camera", error.what());
    }
}

SceneRequest scene_request(const RenderTest& test) {
    SceneRequest request;
    request.file = test.scene;
    for (const SceneSetting& setting : test.set)
        request.overrides.push_back(
            {.pointer = setting.pointer, .value = setting.value, .set_by = test.folder + "/test.json: /set"});
    return request;
}

/// What the test reads. What is wrong with it or its scene, the test itself will say.
std::vector<std::string> files_of(const std::string& folder) {
    std::vector<std::string> files = {folder + "/test.json"};
    try {
        const RenderTest test = read_render_test(folder);
        files.insert(files.end(), {test.scene, test.reference});
        for (const FileRead& file : load_scene(scene_request(test)).files) files.push_back(file.path);
    } catch (const InputError&) {
    } catch (const UsageError&) {
    }
    return files;
}

std::vector<std::string> files_of_all(const std::vector<std::string>& folders) {
    const std::vector<FoundTest> tests = find_tests(folders);
    std::vector<std::vector<std::string>> of_test(tests.size());
    parallel_for(tests.size(), 1, [&](std::size_t first, std::size_t last) {
        for (std::size_t i = first; i < last; ++i) of_test[i] = files_of(tests[i].folder);
    });
    std::vector<std::string> files;
    for (const std::vector<std::string>& some : of_test) files.insert(files.end(), some.begin(), some.end());
    return files;
}

/// A file that is not there yet is nobody's input.
bool could_be_input(const std::string& output) {
    std::error_code none;
    return !output.empty() && std::filesystem::exists(output, none);
}

void require_outputs_apart(const SuiteRequest& request, const SuiteObserver& observer) {
    for (const std::string& output : {request.junit, request.html})
        if (!output.empty()) check_writable(output, {});
    if (!observer.reads && !could_be_input(request.junit) && !could_be_input(request.html)) return;
    const std::vector<std::string> files = files_of_all(request.folders);
    if (observer.reads) observer.reads(files);
    for (const std::string& output : {request.junit, request.html})
        if (could_be_input(output)) check_writable(output, files);
}

/// A scene that is not there is the test's mistake: its file is named, too.
void require_scene(const RenderTest& test) {
    std::error_code none;
    if (!std::filesystem::exists(test.scene, none))
        throw InputError(test.folder + "/test.json", "/scene", "there is no scene '" + test.scene + "'");
}

/// Loads the scene of a test with what the test sets in it. Pictures tell `warn` what they leave out, and are
/// given up once `progress` says so. Throws what load_scene throws, and InputError for a camera that the
/// scene lacks; the drawing InputError for an engine that does not exist.
SuiteScene open_suite_scene(const RenderTest& test, const Progress& progress, const Warn& warn) {
    require_scene(test);
    Scene scene = load_scene(scene_request(test));
    if (warn)
        for (const std::string& warning : scene.warnings) warn(warning);
    const std::size_t camera = camera_of(test, scene);
    const std::shared_ptr<const World> world = make_checked_world(std::move(scene), warn);
    const Progress quiet{{}, progress.cancel};
    return {[world, camera, test, quiet, warn](const std::string& engine, int resolution) {
        PictureRequest picture;
        picture.frame = {camera, resolution};
        picture.engine = engine_of(test, engine);
        check_request(*world, picture);
        return draw_picture(*world, picture, quiet, warn).image;
    }};
}

}  // namespace

SuiteResult run_suite(const SuiteRequest& request, const SuiteObserver& observer) {
    require_outputs_apart(request, observer);
    SuiteCallbacks callbacks{{}, {}, observer.progress, observer.on_test};
    callbacks.open = [&](const RenderTest& test, const Warn& warn) {
        return open_suite_scene(test, observer.progress, warn);
    };
    callbacks.read = [](const std::string& file) { return read_compared_image(file); };
    return run_suite(request, callbacks);
}

std::vector<FoundTest> list_suite(const std::vector<std::string>& folders, const std::string& pattern) {
    return meant_tests(folders, pattern);
}

}  // namespace trilens
