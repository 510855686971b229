// Optics that touch where the camera sees them first: which comes first is the same as later on a path.
#include <cmath>

#include "laws/agreement.h"
#include "laws/worlds.h"
#include "render/engines/engine.h"
#include "support/test.h"

using namespace trilens;
using namespace trilens_test;

namespace {

constexpr double kWater = 1.33, kGlass = 1.5;

std::string touching_box(const std::string& name, const std::string& material, const Vec3& low,
                         const Vec3& high) {
    std::string points;
    for (int i = 0; i < 8; ++i) {
        char text[120];
        std::snprintf(text, sizeof text, "%s[%.17g,%.17g,%.17g]", i ? "," : "", i & 1 ? high.x : low.x,
                      i & 2 ? high.y : low.y, i & 4 ? high.z : low.z);
        points += text;
    }
    return R"({"name":")" + name + R"(","role":"optic","material":")" + material +
           R"(","subdivisionScheme":"bilinear","points":[)" + points +
           R"(],"faceVertexCounts":[4,4,4,4,4,4],"faceVertexIndices":[4,5,7,6, 1,0,2,3, 5,1,3,7, 0,4,6,2, 6,7,3,2, 0,1,5,4]})";
}

/// `meshes` in a room, seen from `eye` towards `at`.
std::string touching_room(const std::string& meshes, const std::string& eye, const std::string& at) {
    return R"({"version":1,"film":{"width":96,"height":72},"cameras":[{"name":"main","yfov":70,"lookAt":{"eye":)" +
           eye + R"(,"at":)" + at +
           R"(,"up":[0,1,0]}}],"materials":[{"name":"water","transmissionFactor":1,"ior":1.33},{"name":"glass","transmissionFactor":1,"ior":1.5},
             {"name":"mirror","metallicFactor":1},{"name":"red","unlit":true,"baseColorFactor":[0.8,0.3,0.2]},{"name":"blue","unlit":true,"baseColorFactor":[0.2,0.4,0.8]}],
           "meshes":[)" +
           meshes +
           R"(,{"name":"wall","role":"object","material":"red","points":[[-9,-9,-9],[9,-9,-9],[9,9,-9],[-9,9,-9]],"faceVertexCounts":[4],"faceVertexIndices":[0,1,2,3]},
             {"name":"side","role":"object","material":"blue","points":[[9,-9,-9],[9,-9,9],[9,9,9],[9,9,-9]],"faceVertexCounts":[4],"faceVertexIndices":[0,1,2,3]}],
           "render":{"maxDepth":12,"fresnel":false}})";
}

void check_engines(const World& world) {
    const Agreement a = compare_engines(world);
    INFO(a.first_off_edge);
    CHECK(a.off_edge == 0);
    CHECK(a.optic_pixels > a.pixels / 4);
}

}  // namespace

TEST_CASE("from water through the glass that it fills there is no air between, whichever is named first",
          "[laws][law]") {
    const double third = 1.0 / 3;
    const std::string water = touching_box("water", "water", {-1, -1, -third}, {1, 1, third});
    const std::string pane = touching_box("pane", "glass", {-1, -1, -third - 0.1}, {1, 1, -third});
    for (const std::string& meshes : {water + "," + pane, pane + "," + water}) {
        const auto world =
            world_from("aquarium", touching_room(meshes, "[0.03,0.02,0.11]", "[0.5,0.06,-0.4]"), 4);
        check_engines(*world);
        for (const Engine engine : {Engine::kLimitTruth, Engine::kExact}) {
            SampleViews views;
            make_viewer(*world, {}, engine, ignore)->view({0, 0, 96, 72, 1}, views);
            std::size_t through = 0, turned_back = 0;
            for (const SampleView& view : views.samples) {
                const Vec3 d = normalize_or_zero(view.ray.direction);
                // Where the ray comes to the pane at once, and leaves that by its far side.
                const Vec3 at = view.ray.origin + (-third - view.ray.origin.z) / d.z * d;
                const double in_glass = kWater / kGlass * std::hypot(d.x, d.y);
                const double further = 0.1 * in_glass / std::sqrt(1 - in_glass * in_glass);
                if (!(d.z < 0) || std::max(std::fabs(at.x), std::fabs(at.y)) + further > 0.99) continue;
                const double sine = kWater * std::hypot(d.x, d.y);
                const PathEnd* end = views.find(view, Path::kRefract);
                if (sine > 1.001) {
                    ++turned_back;
                    for (const PathEnd& one : views.ends_of(view))
                        CHECK(one.step_count > 2);  // into the glass, and back from its far side
                }
                if (sine > 0.999) continue;
                REQUIRE(end != nullptr);
                ++through;
                const Vec3 out = normalize_or_zero(end->ray.direction);
                const double within = engine == Engine::kExact ? 0.05 : 1e-9;
                if (engine == Engine::kLimitTruth || sine < 0.9)
                    CHECK(std::hypot(out.x, out.y) == Approx(sine).margin(within));
                CHECK(out.z < 0);
            }
            CHECK(through > 500);
            CHECK(turned_back > 50);
        }
    }
}

TEST_CASE("a ball that lies on a slab, and glass on a mirror that is seen beside it", "[laws][law]") {
    const std::string slab = touching_box("slab", "glass", {-1, -0.5, -1}, {1, 0, 1});
    const std::string ball =
        R"({"name":"ball","role":"optic","material":"water","primitive":{"type":"sphere","center":[0,0.4,0],"radius":0.4}})";
    check_engines(*world_from("on_slab", touching_room(slab + "," + ball, "[0.6,0.9,2]", "[0,0.1,0]"), 6));
    const std::string mirror = touching_box("mirror", "mirror", {-1.5, -0.7, -1.5}, {1.5, -0.5, 1.5});
    check_engines(
        *world_from("on_mirror", touching_room(mirror + "," + slab, "[0.6,0.9,2]", "[0,-0.3,0]"), 6));
}

TEST_CASE("a body in a body with one side in common is met there once", "[laws][law]") {
    // Equal media would pass; the one of higher priority is active behind the common side.
    const std::string outer = touching_box("outer", "glass", {-1, -1, -1}, {1, 1, 1});
    std::string inner = touching_box("inner", "water", {-0.5, -0.5, 0}, {0.5, 0.5, 1});
    inner.insert(1, R"("priority":1,)");
    for (const std::string& meshes : {outer + "," + inner, inner + "," + outer}) {
        const auto world = world_from("common_side", touching_room(meshes, "[0.1,0.2,3]", "[0,0,0]"), 2);
        check_engines(*world);
        SampleViews views;
        make_viewer(*world, {}, Engine::kLimitTruth, ignore)->view({0, 0, 96, 72, 1}, views);
        std::size_t seen = 0;
        for (const SampleView& view : views.samples) {
            const Vec3 d = normalize_or_zero(view.ray.direction);
            const Vec3 at = view.ray.origin + (1 - view.ray.origin.z) / d.z * d;
            if (std::max(std::fabs(at.x), std::fabs(at.y)) > 0.3) continue;
            // Out by the far side, parallel to how it came.
            const PathEnd* end = views.find(view, Path::kRefract);
            REQUIRE(end != nullptr);
            ++seen;
            CHECK(length(normalize_or_zero(end->ray.direction) - d) < 1e-9);
            const double slope = std::hypot(d.x, d.y);
            const double in_water = slope / kWater, in_glass = slope / kGlass;
            const Vec3 aside = slope > 0 ? Vec3(d.x, d.y, 0) / slope : Vec3(0);
            const Vec3 expected = at + aside * (in_water / std::sqrt(1 - in_water * in_water) +
                                                in_glass / std::sqrt(1 - in_glass * in_glass));
            CHECK(std::hypot(end->ray.origin.x - expected.x, end->ray.origin.y - expected.y) < 1e-9);
        }
        CHECK(seen > 100);
    }
}
