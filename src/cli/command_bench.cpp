// trilens bench: the projector against Embree on the same rays, in the same run.
#include <trilens/bench.h>

#include "cli/commands.h"
#include "cli/print/race.h"
#include "cli/scene_options.h"
#include "terminal/format.h"

namespace trilens {
namespace {

struct BenchOptions {
    SceneOptions scene;
    int repeat = 9;
    std::string isa;
};

Answer run(const BenchOptions& options, Console& console) {
    BenchRequest request;
    const Scene scene = load_scene(options.scene, console);
    request.frame.camera = find_camera(scene, options.scene.camera);
    request.frame.resolution = options.scene.resolution;
    request.race = {options.repeat, options.isa};
    const BenchResult bench = run_bench(scene, request, console.warner());
    if (bench.race.mismatches.unexplained > 0)
        console.warn(fmt::format("{} pixels show another triangle than Embree's, away from edges",
                                 bench.race.mismatches.unexplained));
    return race_answer(bench);
}

}  // namespace

Command bench_command() {
    auto options = std::make_shared<BenchOptions>();
    Command command{.name = "bench",
                    .summary = "the projector against Embree on the same rays, in the same run",
                    .schema = "bench"};
    command.options = joined({scene_argument(options->scene),
                              scene_overrides(options->scene),
                              {{.names = "--repeat",
                                .target = &options->repeat,
                                .help = "rounds; each draws and traces twice, there and back",
                                .range = {1, 1000}},
                               {.names = "--isa",
                                .target = &options->isa,
                                .help = "instruction set of both sides; default: the best of this machine",
                                .choices = {"avx512", "avx2", "sse4.2"}}}});
    command.body = [options](Console& console) { return run(*options, console); };
    return command;
}

}  // namespace trilens
