// trilens project: where world points appear.
#include <trilens/project.h>
#include <trilens/utilities.h>

#include <algorithm>
#include <utility>

#include "cli/commands.h"
#include "cli/options.h"
#include "cli/print/print.h"
#include "terminal/libraries.h"

namespace trilens {
namespace {

struct ProjectOptions {
    SceneOptions scene;
    std::vector<std::string> point, direction;
    std::string points, directions, path;
    std::vector<std::string> parameters;
    std::size_t max_images = 0;
    double min_weight = 0;
    bool steps = false;
    std::string search;  // empty: complete, but for --refine none
    std::string refine = "exact";
    bool no_visibility = false, derivatives = false;
};

std::vector<Vec3> wanted_points(const ProjectOptions& options) {
    if (!options.point.empty() + !options.points.empty() + !options.direction.empty() +
            !options.directions.empty() !=
        1)
        throw UsageError(
            "project needs either --point X,Y,Z or --points FILE.csv, or the same of --direction");
    const std::string& file = options.points.empty() ? options.directions : options.points;
    if (is_standard_stream(file) && is_standard_stream(options.scene.scene))
        throw UsageError("the scene and the points cannot both be standard input");
    if (is_standard_stream(file)) return parse_points(standard_input("points are"), kStandardInput);
    if (!file.empty()) return read_points(file);
    std::vector<Vec3> points;
    const std::string name = options.point.empty() ? "--direction" : "--point";
    for (const std::string& text : options.point.empty() ? options.direction : options.point) {
        const std::optional<Vec3> point = parse_point(text);
        if (!point) throw UsageError(name + " needs X,Y,Z within 1e30, not \"" + text + "\"");
        points.push_back(*point);
    }
    return points;
}

/// Pointers, also several in one word.
std::vector<std::string> parameter_pointers(const std::vector<std::string>& words) {
    std::vector<std::string> pointers;
    for (const std::string& word : words)
        for (std::size_t from = 0; from <= word.size();) {
            const std::size_t comma = std::min(word.find(',', from), word.size());
            pointers.push_back(word.substr(from, comma - from));
            from = comma + 1;
        }
    return pointers;
}

Answer run(const ProjectOptions& options, Console& console) {
    console.files().reads({options.scene.scene, options.points, options.directions});
    const std::vector<Vec3> points = wanted_points(options);
    const Renderer renderer = load_smooth_renderer(options.scene, console);
    ProjectRequest request;
    request.frame.camera = find_camera(renderer.scene(), options.scene.camera);
    request.refine = options.refine == "exact";
    if (!request.refine && options.search == "complete")
        throw UsageError("--refine none leaves images as the facets have them: it goes with --search facets");
    request.search =
        !request.refine || options.search == "facets" ? ImageSearch::kFacets : ImageSearch::kComplete;
    request.visibility = !options.no_visibility;
    request.parameters = parameter_pointers(options.parameters);
    request.derivatives = options.derivatives || !request.parameters.empty();
    if (!options.path.empty()) request.path = EventWord(options.path);
    request.max_images = options.max_images;
    request.min_weight = options.min_weight;
    const Stopwatch watch;
    const bool at_infinity = !options.direction.empty() || !options.directions.empty();
    auto images = at_infinity ? renderer.project_directions(points, request, console.progress("project"))
                              : renderer.project(points, request, console.progress("project"));
    const double seconds = watch.seconds();

    const auto open = std::count_if(images.begin(), images.end(),
                                    [](const PointProjection& point) { return !point.complete; });
    if (open > 0)
        console.warn(fmt::format(
            "{} of {} points may have images that are not listed{}", open, points.size(),
            request.search == ImageSearch::kFacets
                ? "; --search complete with --refine exact looks for all"
                : " (near a caustic, on the optic itself, in overridden normals, over "
                  "several optics or more than once over one, through a camera without one eye, or beyond "
                  "--max-images)"));
    Answer answer;
    answer.fields["seconds"] = seconds;
    answer.fields["incomplete"] = open;
    if (!request.parameters.empty()) {
        answer.fields["parameters"] = Json::array();
        for (const SceneNumber& number : find_numbers(renderer.scene(), request.parameters))
            answer.fields["parameters"].push_back({{"pointer", number.pointer}, {"value", number.value}});
    }
    if (console.wants_json()) answer.fields["points"] = points_json(renderer, points, images);
    answer.text =
        options.steps ? point_steps_text(renderer, images) : points_text(renderer, std::move(images));
    console.note_stage(fmt::format("projected {} points", points.size()), watch);
    return answer;
}

}  // namespace

Command project_command() {
    auto options = std::make_shared<ProjectOptions>();
    Command command{.name = "project",
                    .summary = "where world points appear: all images, in pixels",
                    .schema = "project"};
    command.options = joined(
        {scene_argument(options->scene),
         scene_overrides(options->scene),
         {{.names = "--point",
           .target = &options->point,
           .help = "a world point; may be given several times",
           .value = "X,Y,Z"},
          {.names = "--points",
           .target = &options->points,
           .help = "a file of x,y,z per line, or - for standard input; a header line is allowed",
           .value = "FILE.csv",
           .offer = Offer::kFile},
          {.names = "--direction",
           .target = &options->direction,
           .help = "a point at infinity instead: from the scene towards it; may be given several times",
           .value = "X,Y,Z"},
          {.names = "--directions",
           .target = &options->directions,
           .help = "a file of them, as --points",
           .value = "FILE.csv",
           .offer = Offer::kFile},
          {.names = "--path",
           .target = &options->path,
           .help = "only images of these events, R reflected, T transmitted, ? either, or D, seen directly, "
                   "whatever the "
                   "scene's maxDepth",
           .value = "WORD"},
          {.names = "--max-images",
           .target = &options->max_images,
           .help = "of a point, the strongest; 0: all"},
          {.names = "--min-weight",
           .target = &options->min_weight,
           .help = "leaves out images that carry less in every colour",
           .range = {0, 1}},
          {.names = "--steps",
           .target = &options->steps,
           .help = "text: a line for each meeting with an optic, instead of one for each image"},
          {.names = "--search",
           .target = &options->search,
           .help = "complete: every part of the exact surfaces is searched or excluded; facets: "
                   "only near what the facets show, faster, may miss images",
           .choices = {"complete", "facets"}},
          {.names = "--refine",
           .target = &options->refine,
           .help = "exact: on the exact surface; none: as the facets have it (with --search "
                   "facets)",
           .choices = {"exact", "none"}},
          {.names = "--no-visibility",
           .target = &options->no_visibility,
           .help = "do not ask what hides the images"},
          {.names = "--derivatives",
           .target = &options->derivatives,
           .help = "json: how each image moves with its point, in pixels per scene unit"},
          {.names = "--parameters",
           .target = &options->parameters,
           .help = "json: how each image moves with numbers of the scene too, in pixels per unit: JSON "
                   "pointers to numbers or arrays of them, separated by commas",
           .value = "POINTERS"}}});
    command.body = [options](Console& console) { return run(*options, console); };
    return command;
}

}  // namespace trilens
