// Line drawings: well formed, exact where the answer is known, and in agreement with the picture of pixels.
#include <algorithm>
#include <cmath>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "camera/linear/linear_cameras.h"
#include "cli/command_line.h"
#include "image/image_io.h"
#include "support/test.h"

using namespace trilens;
using namespace trilens_test;

namespace {

/// An element's start tag: its name and attributes, or the end of a group.
struct Tag {
    std::string name;
    std::vector<std::pair<std::string, std::string>> attributes;

    std::string operator[](const std::string& key) const {
        for (const auto& [name_of, value] : attributes)
            if (name_of == key) return value;
        return "";
    }
};

/// Start tags in order; a REQUIRE fails where tags do not nest or an attribute is not quoted.
std::vector<Tag> parse_tags(const std::string& xml) {
    std::vector<Tag> tags;
    std::vector<std::string> open;
    std::size_t at = xml.find("?>");
    REQUIRE(at != std::string::npos);
    while ((at = xml.find('<', at)) != std::string::npos) {
        const std::size_t end = xml.find('>', at);
        REQUIRE(end != std::string::npos);
        std::string inside = xml.substr(at + 1, end - at - 1);
        at = end;
        REQUIRE(inside.find('<') == std::string::npos);
        if (inside[0] == '/') {
            REQUIRE_FALSE(open.empty());
            REQUIRE(open.back() == inside.substr(1));
            open.pop_back();
            tags.push_back({inside, {}});
            continue;
        }
        const bool closed = inside.back() == '/';
        if (closed) inside.pop_back();
        Tag tag{inside.substr(0, inside.find(' ')), {}};
        for (std::size_t from = inside.find(' '); from != std::string::npos && from + 1 < inside.size();) {
            const std::size_t equals = inside.find("=\"", from), quote = inside.find('"', equals + 2);
            REQUIRE(quote != std::string::npos);
            tag.attributes.emplace_back(inside.substr(from + 1, equals - from - 1),
                                        inside.substr(equals + 2, quote - equals - 2));
            from = quote + 1;
        }
        if (!closed) open.push_back(tag.name);
        tags.push_back(tag);
    }
    REQUIRE(open.empty());
    return tags;
}

struct Arc {
    Vec2 p0{0}, p1{0}, p2{0};
    double w = 1;

    Vec2 at(double u) const {
        const double a = (1 - u) * (1 - u), b = 2 * u * (1 - u) * w, c = u * u;
        return (a * p0 + b * p1 + c * p2) / (a + b + c);
    }
};

std::vector<Arc> parse_arcs(const std::string& conic) {
    std::vector<Arc> arcs;
    std::stringstream all(conic);
    for (std::string one; std::getline(all, one, ';');) {
        std::stringstream numbers(one);
        Arc arc;
        numbers >> arc.p0.x >> arc.p0.y >> arc.p1.x >> arc.p1.y >> arc.p2.x >> arc.p2.y >> arc.w;
        REQUIRE_FALSE(numbers.fail());
        arcs.push_back(arc);
    }
    return arcs;
}

/// The arcs of every path in groups of a class.
std::vector<Arc> arcs_in(const std::vector<Tag>& tags, const std::string& group_class) {
    std::vector<Arc> arcs;
    std::string current;
    for (const Tag& tag : tags) {
        if (tag.name == "g") current = tag["class"];
        if (tag.name != "path" || current != group_class) continue;
        const std::vector<Arc> some = parse_arcs(tag["data-conic"]);
        arcs.insert(arcs.end(), some.begin(), some.end());
    }
    return arcs;
}

const Vec3 kTriangle[3] = {{-0.7, -0.5, 2.5}, {0.8, -0.3, 2.0}, {0.1, 0.9, 3.0}};
const Vec3 kEye(0.4, 0.3, 4);

std::string flat_mirror_scene() {
    return R"({ "version": 1, "film": { "width": 160, "height": 120, "spp": 1 },
  "cameras": [ { "name": "main", "type": "perspective", "yfov": 40, "lookAt": { "eye": [0.4,0.3,4], "at": [0,0,0], "up": [0,1,0] } } ],
  "background": { "color": [0.2,0.3,0.5] },
  "materials": [ { "name": "chrome", "metallicFactor": 1, "roughnessFactor": 0 }, { "name": "red & <blue>", "baseColorFactor": [0.8,0.1,0.1], "unlit": true } ],
  "meshes": [ { "name": "mirror", "role": "optic", "material": "chrome", "resolution": 3,
      "primitive": { "type": "plane", "center": [0,0,0], "normal": [0,0,1], "size": [3,3] } },
    { "name": "\"a\" <triangle> & more", "role": "object", "material": "red & <blue>", "points": [[-0.7,-0.5,2.5],[0.8,-0.3,2.0],[0.1,0.9,3.0]],
      "faceVertexCounts": [3], "faceVertexIndices": [0,1,2] } ] })";
}

double distance_to_segment(const Vec2& p, const Vec2& a, const Vec2& b) {
    const double u = std::clamp(dot(p - a, b - a) / dot(b - a, b - a), 0.0, 1.0);
    return length(p - a - u * (b - a));
}

}  // namespace

TEST_CASE("the outline in a flat mirror is that of a second camera behind it", "[cli][vector][oracle]") {
    const std::string folder = scratch_dir("vector_flat");
    const std::string scene = write_file(folder, "scene.json", flat_mirror_scene());
    REQUIRE(run_trilens("render " + scene + " --wire -o " + folder + "/out.svg").exit_code == 0);
    const std::string svg = bytes_of(folder + "/out.svg");
    CHECK(svg.find("Wire drawing") != std::string::npos);
    const std::vector<Arc> arcs = arcs_in(parse_tags(svg), "reflect");

    PerspectiveParams params;
    params.look_at = {kEye, Vec3(0), Vec3(0, 1, 0)};
    params.width = 160, params.height = 120;
    const LinearCamera camera = make_perspective(params);
    Vec2 corner[3];
    for (std::size_t k = 0; k < 3; ++k) {
        const Vec3 mirrored = screen_from_world(camera, kTriangle[k] * Vec3(1, 1, -1));
        corner[k] = {mirrored.x / mirrored.z, mirrored.y / mirrored.z};
    }

    // Every arc lies on an edge, and together they cover the edges: nothing hides behind the film's border
    // here.
    double covered = 0, whole = 0;
    for (std::size_t e = 0; e < 3; ++e) whole += length(corner[(e + 1) % 3] - corner[e]);
    for (const Arc& arc : arcs) {
        double nearest = 1e9;
        for (std::size_t e = 0; e < 3; ++e) {
            double farthest = 0;
            for (const Vec2& p : {arc.p0, arc.p1, arc.p2, arc.at(0.3)})
                farthest = std::max(farthest, distance_to_segment(p, corner[e], corner[(e + 1) % 3]));
            nearest = std::min(nearest, farthest);
        }
        CHECK(nearest < 1e-6);
        covered += length(arc.p2 - arc.p0);
    }
    CHECK(covered == Approx(whole).margin(1.5));
}

TEST_CASE("outlines in a sphere lie where the picture's ids change", "[cli][vector]") {
    const std::string folder = scratch_dir("vector_sphere");
    const std::string scene = source_dir() + "/scenes/sphere.json";
    REQUIRE(run_trilens("render " + scene + " --size 320x240 -o " + folder + "/out.svg").exit_code == 0);
    REQUIRE(run_trilens("render " + scene + " --size 320x240 -o " + folder + "/out.exr").exit_code == 0);
    const std::vector<Tag> tags = parse_tags(bytes_of(folder + "/out.svg"));
    const Image image = read_exr(folder + "/out.exr");
    const std::vector<Id>&object = image.find("reflectID.object")->ids(),
          &primitive = image.find("reflectID.primitive")->ids();

    const auto id = [&](int x, int y) {
        const std::size_t p = static_cast<std::size_t>(y) * 320 + static_cast<std::size_t>(x);
        return std::pair(object[p], primitive[p]);
    };
    const auto changes_near = [&](const Vec2& p) {
        const int x = std::clamp(static_cast<int>(p.x), 1, 318),
                  y = std::clamp(static_cast<int>(p.y), 1, 238);
        for (int dy = -1; dy <= 1; ++dy)
            for (int dx = -1; dx <= 1; ++dx)
                if (id(x + dx, y + dy) != id(x, y)) return true;
        return false;
    };
    std::size_t points = 0, on_change = 0;
    for (const Arc& arc : arcs_in(tags, "reflect"))
        for (int i = 0; i < 8; ++i, ++points) on_change += changes_near(arc.at((i + 0.5) / 8));
    REQUIRE(points > 500);
    CHECK(static_cast<double>(on_change) > 0.95 * static_cast<double>(points));
}

TEST_CASE("a path's Bezier curves stay within the tolerance of its exact conics", "[cli][vector]") {
    const std::string folder = scratch_dir("vector_paths");
    const std::string scene = source_dir() + "/scenes/thesis/fig_4_1_2223.json";
    REQUIRE(run_trilens("render " + scene + " -o " + folder + "/out.svg").exit_code == 0);
    std::size_t cubics = 0;
    for (const Tag& tag : parse_tags(bytes_of(folder + "/out.svg"))) {
        if (tag.name != "path") continue;
        std::vector<Vec2> exact;
        for (const Arc& arc : parse_arcs(tag["data-conic"]))
            for (int i = 0; i <= 400; ++i) exact.push_back(arc.at(i / 400.0));

        // The path's commands, each with its points.
        std::stringstream path(tag["d"]);
        Vec2 at(0);
        for (char command; path >> command;) {
            Vec2 p[3];
            const int count = command == 'C' ? 3 : 1;
            for (int k = 0; k < count; ++k) path >> p[k].x >> p[k].y;
            REQUIRE_FALSE(path.fail());
            cubics += command == 'C';
            for (int i = 1; command == 'C' && i < 10; ++i) {
                const double u = i / 10.0, v = 1 - u;
                const Vec2 q =
                    v * v * v * at + 3 * v * v * u * p[0] + 3 * v * u * u * p[1] + u * u * u * p[2];
                double nearest = 1e9;
                for (std::size_t e = 1; e < exact.size(); ++e)
                    if (exact[e] != exact[e - 1])
                        nearest = std::min(nearest, distance_to_segment(q, exact[e - 1], exact[e]));
                CHECK(nearest < 0.0105);
            }
            at = p[count - 1];
        }
    }
    CHECK(cubics > 8);
}

TEST_CASE("a drawing's names are escaped, and options that make no sense are refused",
          "[cli][vector][bad-input]") {
    const std::string folder = scratch_dir("vector_options");
    const std::string scene = write_file(folder, "scene.json", flat_mirror_scene());
    REQUIRE(run_trilens("render " + scene + " --format svg -o " + folder + "/lines.xml").exit_code == 0);
    const std::string svg = bytes_of(folder + "/lines.xml");
    CHECK_FALSE(parse_tags(svg).empty());
    CHECK(svg.find("&quot;a&quot; &lt;triangle&gt; &amp; more") != std::string::npos);
    CHECK(svg.find("Hidden edges are removed") != std::string::npos);
    CHECK(run_trilens("render " + scene + " --wire -o " + folder + "/out.png").exit_code == 2);
    CHECK(run_trilens("render " + scene + " --engine classic -o " + folder + "/out.svg").exit_code == 2);
    CHECK(run_trilens("trace " + scene + " -o " + folder + "/out.svg").exit_code == 2);
    CHECK(run_trilens("render " + scene + " --crop 0,0,9,9 -o " + folder + "/out.svg").exit_code == 2);
}

TEST_CASE("surfaces that blend and volumes are named where lines leave them out", "[cli][vector]") {
    const std::string folder = scratch_dir("vector_veils");
    const std::string veiled =
        replaced(flat_mirror_scene(), R"("meshes": [)",
                 R"("volumes": [ { "name": "smoke", "grid": { "size": [2,2,2], "scalars": [0,1,0,1,0,1,0,1] },
            "transferFunction": { "map": "grey", "extinction": 1 } } ],
  "meshes": [ { "name": "veil", "role": "object", "material": "pale", "points": [[0,0,1],[1,0,1],[0,1,1]],
                "faceVertexCounts": [3], "faceVertexIndices": [0,1,2] },)");
    const std::string materials = R"("materials": [)";
    const auto draws = [&](const std::string& mode) {
        const std::string scene = write_file(
            folder, "scene.json",
            replaced(veiled, materials,
                     materials + R"( { "name": "pale", "unlit": true, "alphaFactor": 0.5, "alphaMode": ")" +
                         mode + R"(" },)"));
        const CommandRun run = run_trilens("render " + scene + " -o " + folder + "/lines.svg");
        CHECK(run.exit_code == 0);
        return run.err;
    };
    CHECK(draws("blend").find("have no lines: veil, smoke") != std::string::npos);
    CHECK(draws("opaque").find("have no lines: smoke") != std::string::npos);
}

TEST_CASE("edges that stand a hair inside a floor are no dashed lines", "[cli][vector]") {
    // The pyramid of the example stands on the floor, two thousandths below the tiles on it.
    const std::string folder = scratch_dir("vector_base");
    write_file(folder, "ball.json", run_trilens("scene example mirror-sphere").out);
    REQUIRE(run_trilens("render " + folder + "/ball.json -o " + folder + "/ball.svg").exit_code == 0);
    const std::vector<Arc> arcs = arcs_in(parse_tags(bytes_of(folder + "/ball.svg")), "direct");

    PerspectiveParams params;
    params.look_at = {Vec3(0.6, 1.8, 4.7), Vec3(-0.1, 1, 0), Vec3(0, 1, 0)};
    params.yfov_degrees = 42;
    params.width = 640, params.height = 480;
    const LinearCamera camera = make_perspective(params);
    const auto pixel = [&](double x, double z) {
        const Vec3 p = screen_from_world(camera, Vec3(x, 0, z));
        return Vec2(p.x / p.z, p.y / p.z);
    };
    const Vec2 left = pixel(-1.95, 1.6), front = pixel(-1.15, 1.6), back = pixel(-1.15, 0.8);
    for (const Vec2& end : {left, back}) {
        // Whatever of the edge is on the film.
        const double on_film = end.x < 0 ? front.x / (front.x - end.x) : 1;
        const double whole = length(end - front) * on_film;
        REQUIRE(whole > 50);
        double covered = 0;
        for (const Arc& arc : arcs)
            if (distance_to_segment(arc.p0, front, end) < 0.01 &&
                distance_to_segment(arc.p2, front, end) < 0.01)
                covered += length(arc.p2 - arc.p0);
        CHECK(covered > whole - 4);
        CHECK(covered < whole + 1);
    }
}
