// Blended surfaces along rays: against sums by hand, the same for projector and truth, behind and in front of
// optics, and out of the way of ids.
#include <algorithm>
#include <cmath>
#include <string>

#include "laws/pictures.h"
#include "laws/worlds.h"
#include "render/picture/picture.h"
#include "render/world/blended_surfaces.h"
#include "support/draw.h"
#include "support/lit_world.h"
#include "support/test.h"

using namespace trilens;
using namespace trilens_test;

namespace {

/// Panes of unlit grey between the camera at z = 4 and what stands at z = 0, a wall at z = 10 behind it.
std::string panes(const std::string& optic, const std::string& materials, const std::string& meshes) {
    return R"({"version": 1, "film": {"width": 12, "height": 10},
        "cameras": [{"name": "main", "yfov": 40,
                     "lookAt": {"eye": [0, 0, 4], "at": [0, 0, 0], "up": [0, 1, 0]}}],
        "background": {"color": [0.1, 0.1, 0.1]}, "render": {"fresnel": false},
        "materials": [{"name": "chrome", "metallicFactor": 1}, {"name": "glass", "transmissionFactor": 1},
                      {"name": "wall", "baseColorFactor": [0.2, 0.2, 0.2], "unlit": true},
                      {"name": "veil", "baseColorFactor": [1, 1, 1], "unlit": true, "alphaMode": "blend", "alphaFactor": 0.25},
                      {"name": "smoke", "baseColorFactor": [0.6, 0.6, 0.6], "unlit": true, "alphaMode": "blend", "alphaFactor": 0.5})" +
           materials + R"(],
        "meshes": [{"name": "wall", "role": "object", "material": "wall", "primitive": {"type": "plane",
                     "center": [0, 0, 10], "normal": [0, 0, -1], "tangent": [1, 0, 0], "size": [80, 80]}})" +
           optic + meshes + "]}";
}

std::string pane(const std::string& material, double z) {
    return R"(, {"name": "pane)" + std::to_string(z) + R"(", "role": "object", "material": ")" + material +
           R"(", "primitive": {"type": "plane", "center": [0, 0, )" + std::to_string(z) +
           R"(], "normal": [0, 0, 1], "tangent": [1, 0, 0], "size": [60, 60]}})";
}

const char* const kMirror = R"(, {"name": "mirror", "role": "optic", "material": "chrome", "primitive":
    {"type": "plane", "center": [0, 0, 0], "normal": [0, 0, 1], "tangent": [1, 0, 0], "size": [60, 60]}})";

void check_all(const Image& image, const char* channel, double expected) {
    const std::vector<float>& values = image.find(channel)->floats();
    const auto [least, most] = std::minmax_element(values.begin(), values.end());
    INFO(channel);
    CHECK(double{*least} == Approx(expected).epsilon(1e-6));
    CHECK(double{*most} == Approx(expected).epsilon(1e-6));
}

double over(double alpha, double colour, double behind) {
    return alpha * colour + (1 - alpha) * behind;
}

}  // namespace

TEST_CASE("blended panes lie over what is behind, in their order on the ray, directly and before a mirror",
          "[laws][law]") {
    // Directly: smoke is nearer, then the veil, then the background.
    const auto direct = world_from("panes", panes("", "", pane("veil", 0) + pane("smoke", 1)), 4);
    const double seen = over(0.5, 0.6, over(0.25, 1, 0.1));
    // A mirror at z = 0 before the wall: each pane is passed on the way in, and again on the way out.
    const auto mirrored = world_from("panes", panes(kMirror, "", pane("veil", 1) + pane("smoke", 2)), 4);
    const double out = over(0.25, 1, over(0.5, 0.6, 0.2)), in = over(0.5, 0.6, over(0.25, 1, out));
    for (const Engine engine : {Engine::kExact, Engine::kFacetsTruth, Engine::kLimitTruth})
        for (const int spp : {1, 2}) {
            INFO("engine " << static_cast<int>(engine) << " spp " << spp);
            const Image first = drawn_by(*direct, spp, engine);
            check_all(first, "G", seen);
            check_all(first, "A", 1 - 0.75 * 0.5);
            const Image second = drawn_by(*mirrored, spp, engine);
            check_all(second, "G", in);
            for (const std::uint32_t id : second.find("reflectID.object")->ids()) CHECK(id == 0);
        }
}

TEST_CASE("what blends is opaque where its alpha is 1, and again as soon as the scene says so", "[laws]") {
    const std::string solid =
        R"(, {"name": "solid", "baseColorFactor": [0.7, 0.7, 0.7], "unlit": true, "alphaMode": "blend"})";
    const auto world = world_from("panes", panes(kMirror, solid, pane("solid", -1) + pane("veil", 2)), 4);
    REQUIRE(world->blended);
    CHECK(world->blended->triangles().size() == 2);
    Scene opaque = world->scene;
    for (Material& material : opaque.materials) material.alpha_factor = 1;
    change_scene(*world, opaque, ignore);
    CHECK(!world->blended);
    check_all(drawn_by(*world, 1, Engine::kExact), "G", 1);
}

TEST_CASE("blended surfaces before and behind a lens: projector and truth show the same", "[laws][law]") {
    const std::string ball =
        R"(, {"name": "ball", "role": "optic", "material": "glass", "resolution": 32, "primitive":
        {"type": "sphere", "center": [0, 0, 0], "radius": 1}})";
    const std::string glossy =
        R"(, {"name": "film", "baseColorFactor": [0.9, 0.4, 0.2], "roughnessFactor": 0.5,
        "alphaMode": "blend", "alphaFactor": 0.4})";
    const std::string lamp =
        R"(], "lights": [{"type": "point", "position": [2, 3, 3], "intensity": 60, "shadows": true})";
    const auto world =
        world_from("panes", panes(ball, glossy, pane("film", -2) + pane("smoke", 2) + lamp), 32);
    const Image exact = drawn_by(*world, 2, Engine::kExact),
                facets = drawn_by(*world, 2, Engine::kFacetsTruth),
                limit = drawn_by(*world, 2, Engine::kLimitTruth);
    CHECK(exact.find("refractID.object")->ids() == facets.find("refractID.object")->ids());
    double worst = 0, mean = 0;
    for (const char* channel : {"R", "G", "B"}) {
        const std::vector<float>&a = exact.find(channel)->floats(), &b = facets.find(channel)->floats(),
              &c = limit.find(channel)->floats();
        for (std::size_t i = 0; i < a.size(); ++i) {
            worst = std::max(worst, std::fabs(double{a[i]} - double{b[i]}));
            mean += std::fabs(double{a[i]} - double{c[i]}) / static_cast<double>(3 * a.size());
        }
    }
    INFO("worst against facets " << worst << ", mean against the limit " << mean);
    CHECK(worst < 1e-5);
    CHECK(mean < 0.01);
}

namespace {

/// A screen that is lit through panes, seen from below them: the camera looks away from the light.
std::string lit_screen(const std::string& light, const std::string& screen, const std::string& panes_over) {
    return R"({"version": 1, "film": {"width": 8, "height": 6},
        "cameras": [{"name": "main", "yfov": 30,
                     "lookAt": {"eye": [0, 0, -0.5], "at": [0, 0, -2], "up": [0, 1, 0]}}],
        "background": {"color": [0.1, 0.1, 0.1]},
        "materials": [{"name": "screen", "baseColorFactor": [0.8, 0.8, 0.8])" +
           screen + R"(},
            {"name": "veil", "alphaMode": "blend", "alphaFactor": 0.25},
            {"name": "smoke", "alphaMode": "blend", "alphaFactor": 0.5},
            {"name": "back", "alphaMode": "blend", "alphaFactor": 0.9, "doubleSided": false},
            {"name": "chrome", "metallicFactor": 1}],
        "meshes": [{"name": "screen", "role": "object", "material": "screen", "primitive": {"type": "plane",
                     "center": [0, 0, -2], "normal": [0, 0, 1], "tangent": [1, 0, 0], "size": [80, 80]}},
                   {"name": "mirror", "role": "optic", "material": "chrome", "primitive": {"type": "plane",
                     "center": [0.3, 0, -1.5], "normal": [1, 0, 0], "tangent": [0, 1, 0], "size": [1, 0.5]}})" +
           panes_over + R"(], "lights": [)" + light + "]}";
}

double mean_green(const Image& image) {
    double sum = 0;
    const std::vector<float>& values = image.find("G")->floats();
    for (const float value : values) sum += double{value};
    return sum / static_cast<double>(values.size());
}

}  // namespace

TEST_CASE("what blends dims the light of every kind of lamp by its alpha, drawn and traced", "[laws][law]") {
    const std::string over = pane("veil", 0) + pane("smoke", 1);
    // Seen from its front alone, which is turned from the light: no light stops at it.
    const std::string turned =
        R"(, {"name": "turned", "role": "object", "material": "back", "primitive": {"type": "plane",
           "center": [0, 0, 0.5], "normal": [0, 0, -1], "tangent": [1, 0, 0], "size": [60, 60]}})";
    for (
        const char* kind :
        {R"("type": "directional", "direction": [0.2, 0.1, -1])", R"("type": "point", "position": [1, 0, 9])",
         R"("type": "directional", "direction": [0, 0, -1], "angle": 4, "samples": 9)",
         R"("type": "rectangle", "position": [0, 0, 9], "direction": [0, 0, -1], "size": [1, 1], "samples": 9)",
         R"("type": "sphere", "position": [0, 0, 9], "radius": 0.5, "samples": 9)"})
        for (const char* screen : {"", R"(, "roughnessFactor": 0.6)"}) {
            const std::string lamp = "{" + std::string(kind) + R"(, "intensity": 300, "shadows": true})";
            // Blended surfaces are shaded sample by sample: there is one behind the screen in both.
            const std::string behind = pane("veil", -5);
            const auto free = world_from("screen", lit_screen(lamp, screen, behind), 4);
            const auto dimmed = world_from("screen", lit_screen(lamp, screen, behind + over + turned), 4);
            for (const Engine engine : {Engine::kExact, Engine::kFacetsTruth, Engine::kLimitTruth})
                for (const int spp : {1, 2}) {
                    INFO(kind << screen << " engine " << static_cast<int>(engine) << " spp " << spp);
                    const double lit = mean_green(drawn_by(*free, spp, engine));
                    CHECK(lit > 0.01);
                    CHECK(mean_green(drawn_by(*dimmed, spp, engine)) ==
                          Approx(0.75 * 0.5 * lit).epsilon(1e-6));
                }
        }
}

TEST_CASE("light through what blends is the product over all that it crosses, by their sides",
          "[laws][oracle]") {
    Draw draw(8);
    std::string materials, meshes;
    struct Sheet {
        std::array<Vec3, 3> corner;
        double alpha;
        bool both;
    };
    std::vector<Sheet> sheets;
    const auto text = [](const Vec3& v) {
        return "[" + std::to_string(v.x) + "," + std::to_string(v.y) + "," + std::to_string(v.z) + "]";
    };
    for (int i = 0; i < 24; ++i) {
        Sheet sheet{{}, 0.1 + 0.03 * i, i % 2 == 0};
        for (Vec3& corner : sheet.corner)
            for (int k = 0; k < 3; ++k) corner[k] = std::round(1000 * draw.uniform(-2, 2)) / 1000;
        const std::string name = "sheet" + std::to_string(i);
        materials += R"(, {"name": ")" + name + R"(", "alphaMode": "blend", "alphaFactor": )" +
                     std::to_string(sheet.alpha) + (sheet.both ? "" : R"(, "doubleSided": false)") + "}";
        meshes += R"(, {"name": ")" + name + R"(", "role": "object", "material": ")" + name +
                  R"(", "points": [)" + text(sheet.corner[0]) + "," + text(sheet.corner[1]) + "," +
                  text(sheet.corner[2]) + R"(], "faceVertexCounts": [3], "faceVertexIndices": [0, 1, 2]})";
        sheets.push_back(sheet);
    }
    const auto world = world_from("sheets", panes("", materials, meshes), 4);
    REQUIRE(world->blended);
    int crossed = 0;
    for (int trial = 0; trial < 500; ++trial) {
        const Vec3 from = 3.0 * draw.unit(), to = 3.0 * draw.unit();
        double share = 1;
        for (const Sheet& sheet : sheets) {
            // Both ends on different sides of the plane, and the line on one side of all edges.
            const auto& [a, b, c] = sheet.corner;
            const double at_from = triple(b - a, c - a, from - a), at_to = triple(b - a, c - a, to - a);
            if (at_from * at_to >= 0) continue;
            const double u = triple(to - from, a - from, b - from), v = triple(to - from, b - from, c - from),
                         w = triple(to - from, c - from, a - from);
            if (!((u > 0 && v > 0 && w > 0) || (u < 0 && v < 0 && w < 0))) continue;
            ++crossed;
            if (sheet.both || at_to > 0) share *= 1 - sheet.alpha;  // the light, at `to`, is before its front
        }
        CHECK(world->blended->veil({from, to - from}).through == Approx(share).epsilon(1e-12));
    }
    CHECK(crossed > 200);
}

TEST_CASE("what blends dims light over optics, before them and behind, up to its very edge",
          "[laws][law][caustics]") {
    // A mirror in the plane z = -2: the lamp's image is at z = -7. Half of the light goes through a veil on
    // its way there, all of it through smoke over the floor.
    const std::string mirror = R"({"name": "mirror", "role": "optic", "material": "mirror", "resolution": 4,
        "points": [[-2,0.2,-2],[2,0.2,-2],[2,3,-2],[-2,3,-2]], "faceVertexCounts": [4], "faceVertexIndices": [0,1,2,3],
        "subdivisionScheme": "bilinear"})";
    const std::string panes_over =
        R"(, {"name": "half", "role": "object", "material": "veil", "points": [[0.05,0.1,0],[9,0.1,0],[9,9,0],[0.05,9,0]],
             "faceVertexCounts": [4], "faceVertexIndices": [0,1,2,3]},
            {"name": "all", "role": "object", "material": "smoke", "points": [[-6,0.1,3],[6,0.1,3],[6,0.1,-3],[-6,0.1,-3]],
             "faceVertexCounts": [4], "faceVertexIndices": [0,1,2,3]})";
    const LitWorld lit(lit_world(mirror + panes_over, kLamp));
    Draw draw(12);
    int veiled = 0, free = 0;
    for (int i = 0; i < 200; ++i) {
        const Receiver there = on_floor(draw.uniform(-0.4, 0.4), draw.uniform(-1.4, -0.6));
        const Vec3 way = Vec3(0, 4, -7) - there.point;
        const double on_mirror = there.point.x + (-2 - there.point.z) / way.z * way.x;
        const double beside = 0.6 * on_mirror - 0.05;  // of the veil's edge, where its light passes there
        const double expected = 0.5 * (beside > 0 ? 0.75 : 1) * 10 * way.y / std::pow(length(way), 3);
        ++(beside > 0 ? veiled : free);
        CAPTURE(there.point.x, there.point.z, beside);
        CHECK(lit.light().exact_irradiance(there).y == Approx(expected).epsilon(1e-7));
        if (std::fabs(beside) > 0.001)
            CHECK(lit.light().irradiance(there).y == Approx(expected).epsilon(0.02));
    }
    CHECK(veiled > 50);
    CHECK(free > 50);
}

TEST_CASE("a pane far beyond the scene dims parallel light over optics, too", "[laws][law][caustics]") {
    const std::string mirror = R"({"name": "mirror", "role": "optic", "material": "mirror", "resolution": 4,
        "points": [[-2,0.2,-2],[2,0.2,-2],[2,3,-2],[-2,3,-2]], "faceVertexCounts": [4], "faceVertexIndices": [0,1,2,3],
        "subdivisionScheme": "bilinear"})";
    const auto pane_at = [](double y) {
        return R"(, {"name": "pane", "role": "object", "material": "smoke", "primitive": {"type": "plane",
            "center": [0, )" +
               std::to_string(y) +
               R"(, 0], "normal": [0, 1, 0], "tangent": [1, 0, 0], "size": [4000, 4000]}})";
    };
    const std::string sun =
        R"({"type": "directional", "direction": [0, -1, -1], "intensity": 3, "caustics": true})";
    const LitWorld free(lit_world(mirror, sun));
    const Receiver there = on_floor(0.2, -1);
    const double light = free.light().irradiance(there).y;
    CHECK(light == Approx(3 * std::sqrt(0.5)).epsilon(0.01));
    for (const double y : {4.0, 20.0, 300.0}) {
        const LitWorld dimmed(lit_world(mirror + pane_at(y), sun));
        CHECK(dimmed.light().irradiance(there).y == Approx(0.5 * light).epsilon(1e-6));
        CHECK(dimmed.light().exact_irradiance(there).y == Approx(0.5 * light).epsilon(0.01));
    }
}

TEST_CASE("what blends is lit over optics as what is opaque", "[laws][law][caustics]") {
    // A floor that hides all but a millionth, and the opaque one, in a mirror's light; a veil far below makes
    // both be shaded sample by sample.
    const auto lit = [](const std::string& floor, bool caustics) {
        return world_from("lit",
                          R"({"version": 1, "film": {"width": 24, "height": 18},
            "cameras": [{"name": "main", "yfov": 30,
                         "lookAt": {"eye": [0, 3, 1.5], "at": [0, 0, -1], "up": [0, 1, 0]}}],
            "materials": [{"name": "opaque", "baseColorFactor": [0.8, 0.8, 0.8]}, {"name": "mirror", "metallicFactor": 1},
                {"name": "blend", "baseColorFactor": [0.8, 0.8, 0.8], "alphaMode": "blend", "alphaFactor": 0.999999},
                {"name": "veil", "alphaMode": "blend", "alphaFactor": 0.25}],
            "meshes": [{"name": "floor", "role": "object", "material": ")" +
                              floor + R"(", "primitive": {"type": "plane",
                         "center": [0, 0, 0], "normal": [0, 1, 0], "tangent": [1, 0, 0], "size": [20, 20]}},
                {"name": "below", "role": "object", "material": "veil", "primitive": {"type": "plane",
                         "center": [0, -9, 0], "normal": [0, 1, 0], "tangent": [1, 0, 0], "size": [20, 20]}},
                {"name": "mirror", "role": "optic", "material": "mirror", "resolution": 4,
                 "points": [[-2,0.2,-2],[2,0.2,-2],[2,3,-2],[-2,3,-2]], "faceVertexCounts": [4],
                 "faceVertexIndices": [0,1,2,3], "subdivisionScheme": "bilinear"}],
            "lights": [{"type": "point", "position": [0, 4, 3], "intensity": 10, "shadows": true, "caustics": )" +
                              (caustics ? "true" : "false") + "}]}",
                          4);
    };
    for (const Engine engine : {Engine::kExact, Engine::kLimitTruth}) {
        const double dark = mean_green(drawn_by(*lit("opaque", false), 2, engine)),
                     opaque = mean_green(drawn_by(*lit("opaque", true), 2, engine)),
                     blended = mean_green(drawn_by(*lit("blend", true), 2, engine));
        CHECK(opaque > 1.05 * dark);
        CHECK(blended == Approx(opaque).epsilon(0.01));
    }
}
