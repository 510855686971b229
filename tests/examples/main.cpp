// Runs the examples of the public headers and of the README, each in a folder with the files that they read,
// and looks for those that they write. Usage: header_examples FOLDER
#include <trilens/trilens.h>

#include <cstdio>
#include <exception>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "examples.h"

namespace fs = std::filesystem;

namespace {

/// What an example has to leave behind.
const std::map<std::string, std::vector<std::string>> kWritten{
    {"files", {"out.json"}},
    {"image", {"picture.png"}},
    {"render", {"projected.exr", "truth.exr"}},
    {"sweep", {"results/scene/report.html", "results/scene/summary.json"}},
    {"trilens", {"mine.exr"}},
    {"README", {"my.exr"}}};

/// Makes `folder` anew and the working directory: a small scene, its picture and its truth.
void enter(const fs::path& folder) {
    fs::remove_all(folder);
    fs::create_directories(folder);
    fs::current_path(folder);
    const std::vector<trilens::SceneOverride> small{
        {"/film/width", "64"}, {"/film/height", "48"}, {"/film/spp", "1"}};
    const trilens::Scene scene = trilens::parse_scene(trilens::scene_examples()[0].json, "", small);
    for (const char* name : {"scene.json", "my.json"}) trilens::replace_text_file(name, scene.resolved);
    fs::create_directories("tests/render/ball");
    trilens::replace_text_file("tests/render/ball/test.json",
                               R"({ "scene": "../../../scene.json", "against": "truth", "resolution": 8,
                                    "max": { "displacement_p95": 5 } })");
    const trilens::Renderer renderer(scene);
    trilens::PictureRequest request;
    trilens::write_image("picture.exr", renderer.draw(request).image);
    trilens::write_image("mine.exr", renderer.draw(request).image);
    request.engine = trilens::Engine::kLimitTruth;
    trilens::write_image("truth.exr", renderer.draw(request).image);
}

bool passes(const HeaderExample& example, const fs::path& folder) {
    enter(folder / example.name);
    const auto written = kWritten.find(example.name);
    if (written != kWritten.end())
        for (const std::string& file : written->second) fs::remove(file);
    std::printf("%s\n", example.name);
    try {
        example.run();
    } catch (const std::exception& error) {
        std::printf("%s: FAILED: %s\n", example.name, error.what());
        return false;
    }
    bool good = true;
    if (written != kWritten.end())
        for (const std::string& file : written->second) {
            if (fs::exists(file) && fs::file_size(file) > 0) continue;
            std::printf("%s: FAILED: there is no %s\n", example.name, file.c_str());
            good = false;
        }
    return good;
}

}  // namespace

int main(int argc, char** argv) {
    if (argc != 2) return 2;
    std::setvbuf(stdout, nullptr, _IOLBF, 0);  // what ran last is told, however it ends
    const fs::path folder = fs::absolute(argv[1]);
    int passed = 0, failed = 0;
    for (const HeaderExample& example : kExamples) ++(passes(example, folder) ? passed : failed);
    std::printf("%d passed, %d failed, 0 skipped\n", passed, failed);
    return failed > 0;
}
