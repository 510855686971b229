// trilens project: where world points appear.
#include <trilens/project.h>
#include <trilens/stopwatch.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <fstream>

#include "cli/commands.h"
#include "cli/scene_options.h"
#include "terminal/format.h"

namespace trilens {
namespace {

struct ProjectOptions {
    SceneOptions scene;
    std::vector<std::string> point;
    std::string points;
    std::string search = "complete";
    std::string refine = "exact";
    bool no_visibility = false, derivatives = false;
};

/// Three finite numbers separated by commas and blanks, or none.
std::optional<Vec3> parse_point(const std::string& text) {
    Vec3 point(0);
    const char *at = text.data(), *end = at + text.size();
    const auto skip_blanks = [&] {
        while (at < end && (*at == ' ' || *at == '\t' || *at == '\r')) ++at;
    };
    for (int k = 0; k < 3; ++k) {
        skip_blanks();
        if (at < end && *at == '+') ++at;
        const auto [next, error] = std::from_chars(at, end, point[k]);
        if (error != std::errc() || !(std::abs(point[k]) <= kLargestCoordinate)) return std::nullopt;
        at = next;
        skip_blanks();
        if (k < 2 && (at >= end || *at++ != ',')) return std::nullopt;
    }
    return at == end ? std::optional(point) : std::nullopt;
}

/// Whether a line that is no point holds only words.
bool is_header(const std::string& line) {
    std::string field;
    for (const char letter : line + ",") {
        if (letter != ',') {
            if (!std::isspace(static_cast<unsigned char>(letter)) && letter != '"' && letter != '\'')
                field += letter;
            continue;
        }
        double value = 0;
        const auto [end, error] = std::from_chars(field.data(), field.data() + field.size(), value);
        if (!field.empty() && end == field.data() + field.size()) return false;
        field.clear();
    }
    return true;
}

std::vector<Vec3> read_points(const std::string& file) {
    std::ifstream in(file);
    if (!in) throw InputError(file, "", "cannot be read");
    std::vector<Vec3> points;
    std::string line;
    for (std::size_t number = 1; std::getline(in, line); ++number) {
        if (number == 1 && line.rfind("\xef\xbb\xbf", 0) == 0) line.erase(0, 3);  // a byte order mark
        if (line.find_first_not_of(" \t\r") == std::string::npos || line[0] == '#') continue;
        const std::optional<Vec3> point = parse_point(line);
        if (point)
            points.push_back(*point);
        else if (number > 1 || !is_header(line))
            throw InputError(file, "line " + std::to_string(number),
                             "needs x,y,z within 1e30, not \"" + line + "\"");
    }
    if (in.bad()) throw InputError(file, "", "cannot be read");
    if (points.empty()) throw InputError(file, "", "holds no points");
    return points;
}

std::vector<Vec3> wanted_points(const ProjectOptions& options) {
    if (options.point.empty() == options.points.empty())
        throw UsageError("project needs either --point X,Y,Z or --points FILE.csv");
    if (!options.points.empty()) return read_points(options.points);
    std::vector<Vec3> points;
    for (const std::string& text : options.point) {
        const std::optional<Vec3> point = parse_point(text);
        if (!point) throw UsageError("--point needs X,Y,Z within 1e30, not \"" + text + "\"");
        points.push_back(*point);
    }
    return points;
}

std::string optic_name(const Renderer& renderer, const WorldImage& image) {
    return image.optic == kNone ? "" : renderer.scene().meshes[image.object].name;
}

Json id_json(Id id) {
    return id == kNone ? Json(nullptr) : Json(id);
}

Json vector_json(const Vec3& v) {
    return {json_number(v.x), json_number(v.y), json_number(v.z)};
}

Json image_json(const Renderer& renderer, const WorldImage& image) {
    Json steps = Json::array();
    for (const Step& step : image.steps)
        steps.push_back({{"optic", renderer.optics()[step.optic].name}, {"event", event_name(step.event)}});
    Json fields = {{"x", json_number(image.pixel.x)},
                   {"y", json_number(image.pixel.y)},
                   {"t", json_number(image.t)},
                   {"optic", image.optic == kNone ? Json(nullptr) : Json(optic_name(renderer, image))},
                   {"facet", id_json(image.facet)},
                   {"inside", image.inside},
                   {"path", path_name(image.path)},
                   {"length", json_number(image.length)},
                   {"visible", image.visible},
                   {"refined", image.refined},
                   {"steps", steps}};
    if (image.has_derivative)
        fields["derivative"] = {vector_json(image.derivative[0]), vector_json(image.derivative[1])};
    return fields;
}

Json points_json(const Renderer& renderer, std::span<const Vec3> points,
                 std::span<const PointProjection> images) {
    Json list = Json::array();
    for (std::size_t p = 0; p < points.size(); ++p) {
        Json entry{{"point", {points[p].x, points[p].y, points[p].z}},
                   {"complete", images[p].complete},
                   {"images", Json::array()}};
        for (const WorldImage& image : images[p].images)
            entry["images"].push_back(image_json(renderer, image));
        list.push_back(std::move(entry));
    }
    return list;
}

std::string text_line(const Renderer& renderer, std::size_t point, const WorldImage& image) {
    return fmt::format("{},{:.9f},{:.9f},{:.12g},{},{},{},{:d},{:d},{:d}\n", point, image.pixel.x,
                       image.pixel.y, image.t, path_name(image.path), optic_name(renderer, image),
                       image.facet == kNone ? "" : std::to_string(image.facet), image.inside, image.visible,
                       image.refined);
}

Answer run(const ProjectOptions& options, Console& console) {
    console.files().reads({options.scene.scene, options.points});
    const std::vector<Vec3> points = wanted_points(options);
    const Renderer renderer = load_renderer(options.scene, console);
    ProjectRequest request;
    request.frame.camera = find_camera(renderer.scene(), options.scene.camera);
    request.search = options.search == "complete" ? ImageSearch::kComplete : ImageSearch::kFacets;
    request.refine = options.refine == "exact";
    if (!request.refine) request.search = ImageSearch::kFacets;
    request.visibility = !options.no_visibility;
    request.derivatives = options.derivatives;
    const Stopwatch watch;
    const auto images = renderer.project(points, request);
    const double seconds = watch.seconds();

    const auto open = std::count_if(images.begin(), images.end(),
                                    [](const PointProjection& point) { return !point.complete; });
    if (open > 0)
        console.warn(fmt::format("{} of {} points may have images that are not listed{}", open, points.size(),
                                 request.search == ImageSearch::kFacets
                                     ? "; --search complete looks for all"
                                     : " (near a caustic, on the optic itself, or in overridden normals)"));
    Answer answer;
    answer.fields["seconds"] = seconds;
    answer.fields["incomplete"] = open;
    if (console.wants_json()) answer.fields["points"] = points_json(renderer, points, images);
    answer.text = "point,x,y,t,path,optic,facet,inside,visible,refined\n";
    for (std::size_t p = 0; p < points.size(); ++p)
        for (const WorldImage& image : images[p].images) answer.text += text_line(renderer, p, image);
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
                  .help = "a file of x,y,z per line; a header line is allowed",
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
