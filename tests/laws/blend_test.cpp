// Blended surfaces along rays: against sums by hand, the same for projector and truth, behind and in front of
// optics, and out of the way of ids.
#include <algorithm>
#include <cmath>
#include <string>

#include "laws/pictures.h"
#include "laws/worlds.h"
#include "render/picture/picture.h"
#include "render/world/blended_surfaces.h"
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
