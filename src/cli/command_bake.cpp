// trilens bake: radiosity of the matt objects, kept in the scene.
#include <trilens/error.h>
#include <trilens/maps.h>
#include <trilens/utilities.h>

#include <filesystem>
#include <memory>

#include "cli/commands.h"
#include "cli/options.h"
#include "cli/print/print.h"
#include "terminal/libraries.h"

namespace trilens {
namespace {

struct BakeOptions {
    SceneOptions scene;
    std::string output, plot;
    std::string solver = std::string(name_of(BakeRequest().solver));
    std::string form_factors = std::string(name_of(BakeRequest().form_factors));
    BakeRequest request;
};

Json power(const Vec3& power) {
    return {power.x, power.y, power.z};
}

Json convergence_json(const BakeReport& report) {
    Json steps = Json::array();
    for (const RadiosityStep& step : report.convergence)
        steps.push_back({{"rows", step.rows}, {"unshot", step.unshot}});
    return steps;
}

Answer run_bake(const BakeOptions& options, Console& console) {
    BakeRequest request = options.request;
    request.solver = *find_named<RadiositySolver>(options.solver);
    request.form_factors = *find_named<FormFactorMethod>(options.form_factors);
    console.files().reads({options.scene.scene});
    check_scene_output(options.output, console);
    if (!options.plot.empty()) {
        check_output(options.plot, console);
        convergence_plot({}, options.plot);  // refuses other endings before the work
    }
    const Renderer renderer = load_renderer(options.scene, console);
    const Stopwatch watch;
    const Bake bake = bake_light(renderer, request, console.progress("bake"));
    const double seconds = watch.seconds();
    const BakeReport& report = bake.report;
    for (const std::string& warning : report.warnings) console.warn(warning);
    if (!options.plot.empty()) replace_text_file(options.plot, convergence_plot(report, options.plot));
    const std::string folder = is_standard_stream(options.output)
                                   ? bake.scene.folder
                                   : std::filesystem::absolute(options.output).parent_path().string();
    Answer answer = write_output(options.output, scene_document(bake.scene, folder), console);
    const RadiosityBalance& balance = report.balance;
    answer.fields["triangles"] = report.triangles;
    answer.fields["patches"] = report.patches;
    answer.fields["elements"] = report.elements;
    answer.fields["vertices"] = report.vertices;
    answer.fields["flat"] = report.flat;
    answer.fields["coarse"] = report.coarse;
    answer.fields["passes"] = report.passes;
    answer.fields["power"] = {
        {"emitted", power(balance.emitted)},   {"from_lights", power(balance.from_lights)},
        {"absorbed", power(balance.absorbed)}, {"blocked", power(balance.blocked)},
        {"escaped", power(balance.escaped)},   {"unshot", power(balance.unshot)}};
    answer.fields["check"] = {{"vertices", report.check.vertices},
                              {"mean_difference", report.check.mean},
                              {"most_difference", report.check.most}};
    answer.fields["convergence"] = convergence_json(report);
    answer.fields["seconds"] = seconds;
    console.note_stage(fmt::format("baked {} elements of {} patches", report.elements, report.patches),
                       watch);
    return answer;
}

std::vector<Option> element_options(BakeRequest& request) {
    return {
        {.names = "--patch-size",
         .target = &request.patch_size,
         .help = "longest edge at most of the patches that send light, as a share of the scene's diagonal",
         .range = {1e-4, 1}},
        {.names = "--smallest-size",
         .target = &request.smallest_size,
         .help = "elements, parts of patches, that are not longer are not halved, whatever the contrast",
         .range = {1e-5, 1}},
        {.names = "--contrast",
         .target = &request.contrast,
         .help = "elements are halved where their light changes by more, in means over the scene",
         .range = {1e-4, 1e6}},
        {.names = "--max-elements",
         .target = &request.most_elements,
         .help = "halving stops before there are more",
         .range = {1, 1e7}}};
}

std::vector<Option> method_options(BakeOptions& options) {
    BakeRequest& request = options.request;
    return {{.names = "--solver",
             .target = &options.solver,
             .help = "progressive: the brightest patch shoots, one row of form factors at a time; "
                     "gauss-seidel: all gather, with all rows in memory",
             .choices = {"progressive", "gauss-seidel"}},
            {.names = "--form-factors",
             .target = &options.form_factors,
             .help = "hemicube: drawn by the projector; rays: traced by Embree, the truth",
             .choices = {"hemicube", "rays"}},
            {.names = "--hemicube",
             .target = &request.hemicube_resolution,
             .help = "pixels along a hemicube's edge, an even number",
             .range = {2, 1024}},
            {.names = "--rays",
             .target = &request.rays,
             .help = "rays from each patch and each vertex, of form factors by rays and of checks",
             .range = {1, 1e7}},
            {.names = "--check",
             .target = &request.checked_vertices,
             .help = "vertices whose light is found both by hemicube and by rays, and compared",
             .range = {0, 1e6}},
            {.names = "--tolerance",
             .target = &request.tolerance,
             .help = "share of the power that may be left on its way",
             .range = {1e-12, 0.5}}};
}

}  // namespace

Command bake_command() {
    auto options = std::make_shared<BakeOptions>();
    Command command{.name = "bake",
                    .summary = "radiosity: the light that matt objects send to one another, kept in a scene",
                    .schema = "bake"};
    command.options =
        joined({scene_argument(options->scene),
                {{.names = "-o,--output",
                  .target = &options->output,
                  .help = "the scene with the light at the corners of its objects' triangles",
                  .value = "BAKED.json",
                  .offer = Offer::kFile,
                  .is_required = true},
                 {.names = "--keep-lights",
                  .target = &options->request.keeps_lights,
                  .help = "the lights go on shining, with their shadows; only what comes after is baked"},
                 {.names = "--plot",
                  .target = &options->plot,
                  .help = ".svg or .pdf: how the light came to rest",
                  .value = "FILE",
                  .offer = Offer::kFile}},
                element_options(options->request),
                method_options(*options),
                scene_overrides(options->scene)});
    command.body = [options](Console& console) { return run_bake(*options, console); };
    return command;
}

}  // namespace trilens
