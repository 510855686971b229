// Baked light in pictures, against a path tracer of its own, and what cannot be baked.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "base/util/parallel.h"
#include "cli/command_line.h"
#include "intersect/tracer.h"
#include "laws/agreement.h"
#include "laws/worlds.h"
#include "radiosity/bake.h"
#include "render/picture/picture.h"
#include "scene/data/scene_digest.h"
#include "study/scenes.h"
#include "support/draw.h"
#include "support/test.h"

using namespace trilens;
using namespace trilens_test;

namespace {

constexpr double kLampRadiance = 9;
const Vec3 kLampMiddle(0, 1.99, -0.1), kLampAcross(0.3, 0, 0), kLampAlong(0, 0, 0.25);

/// A box with an open front, a block and a lamp; `optics`: meshes before those.
std::string cornell_text(const std::string& optics = "", const std::string& lights = "") {
    const std::string lamp =
        R"({"type": "rectangle", "position": [0, 1.99, -0.1], "direction": [0, -1, 0], "size": [0.6, 0.5],
            "samples": 64, "intensity": 9, "shadows": true})";
    return R"({"version": 1, "film": {"width": 48, "height": 48},
        "cameras": [{"name": "main", "yfov": 38, "lookAt": {"eye": [0, 1, 4.1], "at": [0, 1, 0]}}],
        "materials": [{"name": "chrome", "metallicFactor": 1}, {"name": "glass", "transmissionFactor": 1},
                      {"name": "white", "baseColorFactor": [0.7, 0.7, 0.7]},
                      {"name": "red", "baseColorFactor": [0.6, 0.05, 0.05]}],
        "meshes": [)" +
           optics + R"({"name": "room", "role": "object", "material": "white",
            "points": [[-1,0,-1],[1,0,-1],[1,0,1],[-1,0,1],[-1,2,-1],[1,2,-1],[1,2,1],[-1,2,1]],
            "faceVertexCounts": [4,4,4,4], "faceVertexIndices": [3,2,1,0, 4,5,6,7, 0,1,5,4, 1,2,6,5]},
           {"name": "left", "role": "object", "material": "red",
            "points": [[-1,0,1],[-1,0,-1],[-1,2,-1],[-1,2,1]], "faceVertexCounts": [4], "faceVertexIndices": [0,1,2,3]},
           {"name": "block", "role": "object", "material": "white",
            "points": [[-0.1,0,0.3],[0.6,0,0.3],[0.6,0,-0.3],[-0.1,0,-0.3],[-0.1,0.7,0.3],[0.6,0.7,0.3],[0.6,0.7,-0.3],[-0.1,0.7,-0.3]],
            "faceVertexCounts": [4,4,4,4,4], "faceVertexIndices": [4,5,6,7, 0,1,5,4, 1,2,6,5, 2,3,7,6, 3,0,4,7]}],
        "lights": [)" +
           (lights.empty() ? lamp : lights) + "]}";
}

const char* kBalls =
    R"({"name": "mirror", "role": "optic", "material": "chrome", "resolution": 6,
        "primitive": {"type": "sphere", "center": [-0.45, 1.1, -0.3], "radius": 0.35}},
       {"name": "ball", "role": "optic", "material": "glass", "resolution": 6,
        "primitive": {"type": "sphere", "center": [0.4, 1.3, 0.2], "radius": 0.3}},)";

BakeRequest coarse_request() {
    BakeRequest request;
    request.hemicube_resolution = 32;
    request.patch_size = 0.12;
    request.smallest_size = 0.03;
    return request;
}

/// Irradiance over pi at a point by paths that end at the lamp: a light sample at each place, then on at
/// random, as Lambert's law has it.
class PathTracer {
  public:
    explicit PathTracer(const World& world) : world_(world), tracer_(world.objects) {}

    Vec3 light_at(const Vec3& point, const Vec3& normal, int paths, std::uint64_t seed) const {
        Draw draw(seed);
        Vec3 sum(0);
        for (int i = 0; i < paths; ++i) {
            Vec3 at = point, up = normal, weight(1);
            for (int depth = 0; depth < 40; ++depth) {
                sum += weight * from_lamp(at, up, draw);
                const Hit hit = tracer_.first_hit({at + 1e-6 * up, lambert(up, draw)});
                if (!hit.seen() || is_unlit(hit)) break;
                weight *= world_.shading.materials[world_.shading.material[hit.triangle]].base_color_factor;
                const Vec3 from = at;
                at = position(world_.objects, hit);
                up = normal_against(hit, at - from);
            }
        }
        return sum / double(paths);
    }

  private:
    bool is_unlit(const Hit& hit) const {
        return world_.shading.materials[world_.shading.material[hit.triangle]].unlit;
    }
    Vec3 normal_against(const Hit& hit, const Vec3& way) const {
        const IdTriple& c = world_.objects.triangles[hit.triangle];
        const auto& p = world_.objects.points;
        const Vec3 normal = normalize(cross(p[c[1]] - p[c[0]], p[c[2]] - p[c[0]]));
        return dot(normal, way) > 0 ? -normal : normal;
    }
    static Vec3 lambert(const Vec3& up, Draw& draw) {
        for (;;) {  // a point of the unit sphere about the normal's end
            const Vec3 way = up + draw.unit() * 0.9999999;
            if (dot(way, way) > 1e-12) return normalize(way);
        }
    }
    double from_lamp(const Vec3& at, const Vec3& up, Draw& draw) const {
        const double a = draw.uniform(-1, 1), b = draw.uniform(-1, 1);
        const Vec3 end = kLampMiddle + a * kLampAcross + b * kLampAlong - Vec3(0, 1e-6, 0);
        const Vec3 start = at + 1e-6 * up, way = end - start;
        const double facing = dot(way, up), under = way.y;
        if (facing <= 0 || under <= 0 || tracer_.occluded({start, way}, 0, 1)) return 0;
        const double distance2 = dot(way, way);
        return kLampRadiance * 0.3 * facing * under / (distance2 * distance2) / std::numbers::pi;
    }

    const World& world_;
    Tracer tracer_;
};

Picture picture_by(const World& world, Engine engine) {
    PictureRequest request;
    request.engine = engine;
    return draw_picture(world, request, {}, ignore);
}

}  // namespace

TEST_CASE("a bake names its stages, its share never falls and ends at 1", "[radiosity][law]") {
    const auto world = world_from("cornell", cornell_text(kBalls), 6);
    std::vector<double> shares;
    std::vector<std::string> stages;
    Progress progress;
    progress.report = [&](double share) { shares.push_back(share); };
    progress.stage = [&](const std::string& name, double until) {
        CHECK(until == 1);
        if (stages.empty() || stages.back() != name) stages.push_back(name);
    };
    BakeRequest request = coarse_request();
    request.hemicube_resolution = 16;
    request.patch_size = 0.2;
    request.smallest_size = 0.1;
    bake_light(*world, request, progress);
    CHECK(stages ==
          std::vector<std::string>{"shadows", "light on patches", "exchange", "light at corners", "check"});
    CHECK(std::is_sorted(shares.begin(), shares.end()));
    CHECK(shares.front() < 0.2);
    CHECK(shares.back() == 1);
    CHECK(shares[shares.size() - 2] < 1);
}

TEST_CASE("baked light is that of a path tracer", "[radiosity][law][thorough]") {
    const auto world = world_from("cornell", cornell_text(), 4);
    const Bake bake = bake_light(*world, {});
    const PathTracer truth(*world);
    double off = 0, sum = 0;
    std::size_t count = 0;
    std::vector<double> shares;
    for (const Mesh& mesh : bake.scene.meshes) {
        const ObjectMesh& object = mesh.object;
        if (object.baked.empty()) continue;
        for (std::size_t t = 0; t < object.triangles.size(); t += object.triangles.size() / 11 + 1) {
            const auto& [a, b, c] = object.triangles[t];
            const Vec3 u = object.points[b] - object.points[a], v = object.points[c] - object.points[a];
            const Vec3 middle = object.points[a] + (u + v) / 3.0;
            const auto& light = object.baked[t].front;
            const Vec3 baked = (light[0] + light[1] + light[2]) / 3.0;
            const Vec3 traced = truth.light_at(middle, normalize(cross(u, v)), 3000, 100 + t);
            INFO(mesh.name << " " << t << ": baked " << baked.x << ", traced " << traced.x);
            CHECK(std::fabs(baked.x - traced.x) < 0.05);  // at the edges of shadows
            off += std::fabs(baked.x - traced.x), sum += traced.x;
            if (traced.x > 0) shares.push_back(std::fabs(baked.x - traced.x) / traced.x);
            ++count;
        }
    }
    INFO("off by " << off / sum << " of the light at " << count << " places");
    CHECK(count >= 30);
    CHECK(sum > 0.15 * double(count));
    CHECK(off < 0.04 * sum);  // most of it at patches that reach under the block
    std::sort(shares.begin(), shares.end());
    CHECK(shares[shares.size() / 2] < 0.015);
}

TEST_CASE("baked light is projected as it is traced, ids equal, in a mirror and through glass",
          "[radiosity][law]") {
    const auto world = world_from("cornell", cornell_text(kBalls), 6);
    const Bake bake = bake_light(*world, coarse_request());
    const auto lit = make_world(bake.scene, ignore);
    const Agreement agreement = compare_engines(*lit);
    CHECK(agreement.optic_pixels > 150);
    CHECK(agreement.off_edge == 0);
    const Picture drawn = picture_by(*lit, Engine::kExact), traced = picture_by(*lit, Engine::kFacetsTruth);
    double off = 0, sum = 0;
    for (const char* channel : {"R", "G", "B"}) {
        const auto &a = drawn.image.find(channel)->floats(), &b = traced.image.find(channel)->floats();
        for (std::size_t i = 0; i < a.size(); ++i) off += std::fabs(a[i] - b[i]), sum += b[i];
    }
    CHECK(sum / (3.0 * 48 * 48) > 0.05);
    CHECK(off < 1e-3 * sum);
    CHECK(bake.report.warnings.size() >= 2);  // of mirror and glass
}

TEST_CASE("a baked scene's file is the scene that was baked", "[radiosity][law]") {
    const auto world = world_from("cornell", cornell_text(kBalls), 6);
    const Bake bake = bake_light(*world, coarse_request());
    CHECK(bake.report.elements > bake.report.patches);
    CHECK(bake.report.patches > bake.report.triangles);
    const Scene again = parse_scene(bake.scene.resolved);
    CHECK(scene_digest(again) == scene_digest(bake.scene));
    CHECK(again.lights[0].baked);
    CHECK(scene_digest(bake.scene) != scene_digest(world->scene));
}

TEST_CASE("baked power is what came in, and the same bytes for any number of threads", "[radiosity][law][thorough]") {
    const auto world = world_from("cornell", cornell_text(kBalls), 6);
    set_thread_count(1);
    const Bake one = bake_light(*world, coarse_request());
    set_thread_count(3);
    const Bake three = bake_light(*world, coarse_request());
    set_thread_count(0);
    CHECK(one.scene.resolved == three.scene.resolved);
    const RadiosityBalance& power = one.report.balance;
    const Vec3 missing =
        power.emitted + power.from_lights - power.absorbed - power.blocked - power.escaped - power.unshot;
    CHECK(length(missing) < 1e-9);
    CHECK(power.blocked.x > 0);
    CHECK(power.escaped.x > 0);
    CHECK(one.report.check.mean < 0.03);
}

TEST_CASE("lights that are kept and what comes after are together what is baked whole", "[radiosity][law]") {
    const auto world = world_from("cornell", cornell_text(), 4);
    BakeRequest request = coarse_request();
    request.contrast = 1e6;  // the same elements in both
    const Bake whole = bake_light(*world, request);
    request.keeps_lights = true;
    const Bake after = bake_light(*world, request);
    CHECK_FALSE(after.scene.lights[0].baked);
    std::size_t brighter = 0, corners = 0;
    for (std::size_t m = 0; m < whole.scene.meshes.size(); ++m) {
        const auto &all = whole.scene.meshes[m].object.baked, &part = after.scene.meshes[m].object.baked;
        REQUIRE(all.size() == part.size());
        for (std::size_t t = 0; t < all.size(); ++t)
            for (std::size_t k = 0; k < 3; ++k) {
                CHECK(all[t].front[k].x >= part[t].front[k].x);
                brighter += all[t].front[k].x > 1.05 * part[t].front[k].x;
                ++corners;
            }
    }
    CHECK(brighter > corners / 4);
}

TEST_CASE("a lamp that is an object does not stand in its own light", "[shade][law]") {
    std::string text = cornell_text();
    const auto shown = world_from("cornell", text, 4);
    const std::size_t at = text.find("\"samples\": 64");
    const auto hidden = world_from("cornell", text.insert(at, "\"visible\": false, "), 4);
    const Picture a = picture_by(*shown, Engine::kExact), b = picture_by(*hidden, Engine::kExact);
    const auto &with = a.image.find("R")->floats(), &without = b.image.find("R")->floats();
    std::size_t darker = 0;
    for (std::size_t i = 0; i < with.size(); ++i) darker += with[i] < 0.98f * without[i];
    CHECK(darker == 0);
}

TEST_CASE("colours at a mesh's points colour what it reflects, not the light that is baked",
          "[radiosity][law]") {
    const auto baked_floor = [](const std::string& colors) {
        const auto world = world_from(
            "floor",
            R"({"version": 1, "cameras": [{"name": "c", "yfov": 40, "lookAt": {"eye": [0, 2, 4], "at": [0, 0, 0]}}],
                "materials": [{"name": "white", "baseColorFactor": [0.7, 0.7, 0.7]}],
                "meshes": [{"name": "floor", "role": "object", "material": "white", "points": [[-1,0,1],[1,0,1],[1,0,-1],[-1,0,-1]],
                            "faceVertexCounts": [4], "faceVertexIndices": [0,1,2,3])" +
                colors + R"(}],
                "lights": [{"type": "point", "position": [0.3, 1, 0.2], "intensity": 2, "shadows": true}]})",
            1);
        return bake_light(*world, coarse_request()).scene.meshes[0].object.baked;
    };
    const std::vector<BakedLight> plain = baked_floor(""),
                                  colored =
                                      baked_floor(R"(, "colors": [[1,0,0],[0,1,0],[0.2,0.2,0.2],[0,0,1]])");
    REQUIRE(plain.size() > 2);
    REQUIRE(colored.size() == plain.size());
    CHECK(plain[0].front[0].x > 0.05);
    double most = 0;
    for (std::size_t t = 0; t < plain.size(); ++t)
        for (std::size_t k = 0; k < 3; ++k)
            most = std::max(most, length(plain[t].front[k] - colored[t].front[k]));
    CHECK(most == 0);
}

TEST_CASE("what cannot be baked is refused in words", "[radiosity][cli][bad-input]") {
    const std::string folder = scratch_dir("bake_bad");
    const std::string room = write_file(folder, "room.json", cornell_text());
    const std::string dark =
        write_file(folder, "dark.json", replaced(cornell_text(), "\"intensity\": 9", "\"intensity\": 0"));
    const std::string unlit = write_file(
        folder, "unlit.json",
        replaced(replaced(cornell_text(), "\"name\": \"white\"", "\"name\": \"white\", \"unlit\": true"),
                 "\"name\": \"red\"", "\"name\": \"red\", \"unlit\": true"));
    const std::string nan =
        write_file(folder, "nan.json", replaced(cornell_text(), "[-1,0,-1]", "[-1,1e999,-1]"));
    const std::string out = " -o " + folder + "/baked.json ";
    struct Refused {
        std::string arguments;
        int exit_code;
        std::string says;
    };
    for (const Refused& bad :
         std::vector<Refused>{{"bake " + dark + out, 3, "nothing shines"},
                              {"bake " + unlit + out, 3, "there is no object whose light could be baked"},
                              {"bake " + nan + out, 3, "nan.json"},
                              {"bake " + room + out + "--patch-size 0.005 --smallest-size 0.004", 3,
                               "50000 elements are the most"},
                              {"bake " + room + out + "--max-elements 30", 3, "30 elements are the most"},
                              {"bake " + room + out + "--hemicube 63", 2, "even"},
                              {"bake " + room + out + "--smallest-size 0.5", 2, "smallest"},
                              {"bake " + room + out + "--plot plot.png", 2, ".svg"},
                              {"bake " + room + out + "--solver jacobi", 2, "jacobi"},
                              {"bake " + room + " -o " + folder + "/baked.txt ", 2, "ends in .json"}}) {
        const CommandRun run = run_trilens(bad.arguments + " --progress none");
        INFO(bad.arguments << "\n" << run.err);
        CHECK(run.exit_code == bad.exit_code);
        CHECK(run.err.find(bad.says) != std::string::npos);
        CHECK(bytes_of(folder + "/baked.json").empty());
    }
    const std::string quick = " --patch-size 0.3 --contrast 10 --hemicube 16 -q --progress none";
    REQUIRE(run_trilens("bake " + room + out + quick).exit_code == 0);
    const CommandRun twice =
        run_trilens("bake " + folder + "/baked.json -o " + folder + "/twice.json" + quick);
    CHECK(twice.exit_code == 3);
    CHECK(twice.err.find("/bakedLight: is light that is baked already") != std::string::npos);
    const std::string other =
        write_file(folder, "other.json",
                   replaced(bytes_of(folder + "/baked.json"), "\"triangles\": 8", "\"triangles\": 9"));
    const CommandRun wrong = run_trilens("render " + other + " -o " + folder + "/o.png");
    CHECK(wrong.exit_code == 3);
    CHECK(wrong.err.find("was baked for a mesh of 9 triangles, but this one has 8") != std::string::npos);
    const std::string baked = bytes_of(folder + "/baked.json"), point = "[-1,0,-1]";
    const std::string moved = write_file(folder, "moved.json", replaced(baked, point, "[-1.01,0,-1]"));
    const CommandRun elsewhere = run_trilens("render " + moved + " -o " + folder + "/o.png");
    CHECK(elsewhere.exit_code == 3);
    CHECK(elsewhere.err.find("/bakedLight/corners: the light was baked for a mesh whose") !=
          std::string::npos);
}
