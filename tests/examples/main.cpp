// Runs the examples of the public headers, each in a folder with the files that they read, and looks for
// those that they write. Usage: header_examples FOLDER
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
    {"trilens/engine_study.h", {"results/engines/engines.csv", "results/engines/clipping.csv"}},
    {"trilens/files.h", {"out.json"}},
    {"trilens/image.h", {"picture.png"}},
    {"trilens/render.h", {"projected.exr", "truth.exr"}},
    {"trilens/sweep.h", {"results/scene/report.html", "results/scene/summary.json"}},
    {"trilens/trilens.h", {"mine.exr"}}};

/// Makes `folder` anew and the working directory: a small scene, its picture and its truth.
void enter(const fs::path& folder) {
    fs::remove_all(folder);
    fs::create_directories(folder);
    fs::current_path(folder);
    const std::vector<trilens::SceneOverride> small{
        {"/film/width", "64"}, {"/film/height", "48"}, {"/film/spp", "1"}};
    const trilens::Scene scene = trilens::parse_scene(trilens::scene_examples()[0].json, "", small);
    trilens::replace_text_file("scene.json", scene.resolved);
    const trilens::Renderer renderer(scene);
    trilens::PictureRequest request;
    trilens::write_image("picture.exr", renderer.draw(request).image);
    trilens::write_image("mine.exr", renderer.draw(request).image);
    request.engine = trilens::Engine::kLimitTruth;
    trilens::write_image("truth.exr", renderer.draw(request).image);
}

bool passes(const HeaderExample& example, const fs::path& folder) {
    enter(folder / fs::path(example.header).stem());
    const auto written = kWritten.find(example.header);
    if (written != kWritten.end())
        for (const std::string& file : written->second) fs::remove(file);
    std::printf("%s\n", example.header);
    try {
        example.run();
    } catch (const std::exception& error) {
        std::printf("%s: FAILED: %s\n", example.header, error.what());
        return false;
    }
    bool good = true;
    if (written != kWritten.end())
        for (const std::string& file : written->second) {
            if (fs::exists(file) && fs::file_size(file) > 0) continue;
            std::printf("%s: FAILED: there is no %s\n", example.header, file.c_str());
            good = false;
        }
    return good;
}

}  // namespace

int main(int argc, char** argv) {
    if (argc != 2) return 2;
    const fs::path folder = fs::absolute(argv[1]);
    int passed = 0, failed = 0;
    for (const HeaderExample& example : kExamples) ++(passes(example, folder) ? passed : failed);
    std::printf("%d passed, %d failed, 0 skipped\n", passed, failed);
    return failed > 0;
}
