// trilens project: where world points appear.
#include <trilens/project.h>
#include <trilens/stopwatch.h>

#include <algorithm>
#include <utility>

#include "cli/commands.h"
#include "cli/print/projections.h"
#include "cli/scene_options.h"
#include "terminal/format.h"

namespace trilens {
namespace {

struct ProjectOptions {
    SceneOptions scene;
    std::vector<std::string> point;
    std::string points;
    std::string search;  // empty: complete, but for --refine none
    std::string refine = "exact";
    bool no_visibility = false, derivatives = false;
};

std::vector<Vec3> wanted_points(const ProjectOptions& options) {
    if (options.point.empty() == options.points.empty())
        throw UsageError("project needs either --point X,Y,Z or --points FILE.csv");
    if (is_standard_stream(options.points) && is_standard_stream(options.scene.scene))
        throw UsageError("the scene and the points cannot both be standard input");
    if (is_standard_stream(options.points)) return parse_points(standard_input("points are"), kStandardInput);
    if (!options.points.empty()) return read_points(options.points);
    std::vector<Vec3> points;
    for (const std::string& text : options.point) {
        const std::optional<Vec3> point = parse_point(text);
        if (!point) throw UsageError("--point needs X,Y,Z within 1e30, not \"" + text + "\"");
        points.push_back(*point);
    }
    return points;
}

Answer run(const ProjectOptions& options, Console& console) {
    console.files().reads({options.scene.scene, options.points});
    const std::vector<Vec3> points = wanted_points(options);
    const Renderer renderer = load_renderer(options.scene, console);
    ProjectRequest request;
    request.frame.camera = find_camera(renderer.scene(), options.scene.camera);
    request.refine = options.refine == "exact";
    if (!request.refine && options.search == "complete")
        throw UsageError("--refine none leaves images as the facets have them: it goes with --search facets");
    request.search =
        !request.refine || options.search == "facets" ? ImageSearch::kFacets : ImageSearch::kComplete;
    request.visibility = !options.no_visibility;
    request.derivatives = options.derivatives;
    const Stopwatch watch;
    auto images = renderer.project(points, request);
    const double seconds = watch.seconds();

    const auto open = std::count_if(images.begin(), images.end(),
                                    [](const PointProjection& point) { return !point.complete; });
    if (open > 0)
        console.warn(fmt::format("{} of {} points may have images that are not listed{}", open, points.size(),
                                 request.search == ImageSearch::kFacets
                                     ? "; --search complete with --refine exact looks for all"
                                     : " (near a caustic, on the optic itself, in overridden normals, over "
                                       "several optics, or through a camera without one eye)"));
    Answer answer;
    answer.fields["seconds"] = seconds;
    answer.fields["incomplete"] = open;
    if (console.wants_json()) answer.fields["points"] = points_json(renderer, points, images);
    answer.text = points_text(renderer, std::move(images));
    console.note_stage(fmt::format("projected {} points", points.size()), watch);
    return answer;
}

}  // namespace

Command project_command() {
    auto options = std::make_shared<ProjectOptions>();
    Command command{.name = "project",
                    .summary = "where world points appear: all images, in pixels",
                    .schema = "project"};
    command.options =
        joined({scene_argument(options->scene),
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
                  .help = "json: how each image moves with its point, in pixels per scene unit"}}});
    command.body = [options](Console& console) { return run(*options, console); };
    return command;
}

}  // namespace trilens
