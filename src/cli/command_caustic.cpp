// trilens caustic: the irradiance that a light brings over optics onto an object.
#include <trilens/error.h>
#include <trilens/maps.h>
#include <trilens/utilities.h>
#include <memory>

#include "cli/commands.h"
#include "cli/options.h"
#include "cli/print/print.h"
#include "terminal/libraries.h"

namespace trilens {
namespace {

struct CausticOptions {
    SceneOptions scene;
    std::string onto, output;
    int light = 0;
    double tolerance = CausticMapRequest().tolerance;
    bool back = false, exact = false;
};

std::vector<double> numbers_of(const Vec3& light) {
    return {light.x, light.y, light.z};
}

Answer run_caustic(const CausticOptions& options, Console& console) {
    console.files().reads({options.scene.scene});
    check_output(options.output, console);
    const Renderer renderer = load_smooth_renderer(options.scene, console);
    CausticMapRequest request;
    request.light = static_cast<std::size_t>(options.light);
    request.target = parse_target(options.onto, renderer.scene());
    request.back = options.back;
    request.exact = options.exact;
    request.tolerance = options.tolerance;

    const Stopwatch watch;
    const CausticMap map = make_caustic_map(renderer, request, console.progress("caustic"));
    const double seconds = watch.seconds();
    write_image(options.output, image_of(map));
    for (const std::string& message : map.warnings) console.warn(message);
    Answer answer = name_output(options.output, console);
    answer.fields["light"] = options.light;
    answer.fields["width"] = map.width;
    answer.fields["height"] = map.height;
    answer.fields["flux"] = {{"in", numbers_of(map.flux_in)},
                             {"on_objects", numbers_of(map.flux_on_objects)},
                             {"away", numbers_of(map.flux_away)},
                             {"received", numbers_of(map.flux_received)}};
    answer.fields["beams"] = map.beams;
    answer.fields["histories"] = map.histories;
    answer.fields["seconds"] = seconds;
    console.note_stage(fmt::format("followed {} beams of {} histories", map.beams, map.histories), watch);
    return answer;
}

}  // namespace

Command caustic_command() {
    auto options = std::make_shared<CausticOptions>();
    Command command{.name = "caustic",
                    .summary = "the light that comes over optics to an object, as data",
                    .schema = "caustic"};
    command.options =
        joined({scene_argument(options->scene),
                {{.names = "--onto",
                  .target = &options->onto,
                  .help = "an object as NAME or NAME:WxH, or plane:ox,oy,oz,ux,uy,uz,vx,vy,vz,WxH",
                  .value = "TARGET",
                  .is_required = true},
                 {.names = "-o,--output",
                  .target = &options->output,
                  .help = ".exr: irradiance in R, G and B, and in A whether the object is there",
                  .value = "FILE",
                  .offer = Offer::kFile,
                  .is_required = true},
                 {.names = "--light",
                  .target = &options->light,
                  .help = "which of the scene's lights, counted from 0",
                  .range = {0, 1e6}},
                 {.names = "--back",
                  .target = &options->back,
                  .help = "the light on the other side of the surface than its front"},
                 {.names = "--exact",
                  .target = &options->exact,
                  .help = "the truth, as trace has it: by exact rays at every pixel, however long it takes"},
                 {.names = "--tolerance",
                  .target = &options->tolerance,
                  .help = "how far light may fall from its place, as a share of the scene's size",
                  .range = {1e-8, 0.1}}},
                scene_overrides(options->scene)});
    command.body = [options](Console& console) { return run_caustic(*options, console); };
    return command;
}

}  // namespace trilens
