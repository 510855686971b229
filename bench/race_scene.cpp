// The projector against Embree's packets on the rays of a scene's optics, in the same run.
// Use: bench_race SCENE [-n N] [--size WxH] [--spp S] [--camera NAME] [--repeat K] [--isa SET] [--threads T]
// [--json]
#include <CLI/CLI.hpp>

#include <cstdio>
#include <exception>

#include "bench/race/scene_race.h"
#include "trilens/scene.h"
#include "trilens/version.h"

int main(int count, char** words) {
    using namespace trilens_bench;
    SceneRequest scene;
    BenchRequest request;
    std::string camera, size;
    int threads = 0, samples = 0;
    bool json = false;
    CLI::App app{"The projector against Embree on the same rays, in the same run."};
    app.add_option("SCENE", scene.file, "a scene file")->required();
    app.add_option("-n,--resolution", request.frame.resolution, "of the optics; default: the scene's")
        ->check(CLI::Range(1, 1024));
    app.add_option("--size", size, "WIDTHxHEIGHT of the film; default: the scene's");
    app.add_option("--spp", samples, "samples along each side of a pixel; default: the scene's")
        ->check(CLI::Range(1, 64));
    app.add_option("--camera", camera, "a camera by name; default: the scene's own");
    app.add_option("--repeat", request.race.repeats, "rounds; each draws and traces twice, there and back")
        ->check(CLI::Range(1, 1000));
    app.add_option("--isa", request.race.isa,
                   "instruction set of both sides; default: the best of this machine")
        ->check(CLI::IsMember({"avx512", "avx2", "sse4.2"}));
    app.add_option("--threads", threads, "at most; default: all")->check(CLI::Range(1, 1024));
    app.add_flag("--json", json, "one JSON object");
    CLI11_PARSE(app, count, words);
    try {
        if (threads > 0) set_threads(threads);
        if (!size.empty()) {
            const std::size_t cross = size.find('x');
            if (cross == std::string::npos) throw CLI::ValidationError("--size", "is WIDTHxHEIGHT");
            scene.overrides.push_back({"/film/width", size.substr(0, cross)});
            scene.overrides.push_back({"/film/height", size.substr(cross + 1)});
        }
        if (samples > 0) scene.overrides.push_back({"/film/spp", std::to_string(samples)});
        const Scene loaded = load_scene(scene);
        request.frame.camera = find_camera(loaded, camera);
        const auto warn = [](const std::string& warning) {
            std::fprintf(stderr, "warning: %s\n", warning.c_str());
        };
        const BenchResult result = run_bench(loaded, request, warn);
        std::fputs((json ? race_json(result) : race_text(result)).c_str(), stdout);
        return result.race.mismatches.unexplained > 0;
    } catch (const std::exception& error) {
        std::fprintf(stderr, "bench_race: %s\n", error.what());
        return 2;
    }
}
