// Blended surfaces inside bodies of glass: against sums by hand, dimmed by what the glass absorbs before
// them, once where they lie on its surface, and the same for projector and truth.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "laws/pictures.h"
#include "laws/worlds.h"
#include "render/picture/picture.h"
#include "support/lit_world.h"
#include "support/test.h"

using namespace trilens;
using namespace trilens_test;

namespace {

constexpr double kLeftOfGreen = 0.5;  // of light, after one unit of glass
const char* const kEyeBeforeBlock = R"("type": "orthographic", "ymag": 0.5,
    "lookAt": {"eye": [0, 0, 4], "at": [0, 0, 0], "up": [0, 1, 0]})";
const char* const kEyeInBlock = R"("type": "orthographic", "ymag": 0.5,
    "lookAt": {"eye": [0, 0, 0.4], "at": [0, 0, -1], "up": [0, 1, 0]})";

/// A block between z = -0.5 and z = 0.5, wide enough to fill the film.
std::string wide_block(const std::string& material) {
    return R"({"name": "block", "role": "optic", "material": ")" + material +
           R"(", "subdivisionScheme": "bilinear", "points": [[-4,-4,-0.5],[-4,-4,0.5],[-4,4,-0.5],[-4,4,0.5],
        [4,-4,-0.5],[4,-4,0.5],[4,4,-0.5],[4,4,0.5]], "faceVertexCounts": [4,4,4,4,4,4],
        "faceVertexIndices": [0,1,3,2,4,6,7,5,0,4,5,1,2,3,7,6,0,2,6,4,1,5,7,3]})";
}

std::string veiled_glass(const std::string& camera, const std::string& meshes) {
    return R"({"version": 1, "film": {"width": 12, "height": 10}, "cameras": [{"name": "main", )" + camera +
           R"(}], "background": {"color": [0.1, 0.1, 0.1]}, "render": {"fresnel": false, "maxDepth": 6},
        "materials": [
            {"name": "glass", "transmissionFactor": 1, "ior": 1.5, "volume": {"attenuationColor": [0.9, 0.5, 0.7], "attenuationDistance": 1}},
            {"name": "frosted", "transmissionFactor": 1, "ior": 1.5, "roughnessFactor": 0.2},
            {"name": "thin", "baseColorFactor": [0.9, 0.4, 0.2], "roughnessFactor": 0.5, "alphaMode": "blend", "alphaFactor": 0.4},
            {"name": "veil", "baseColorFactor": [1, 1, 1], "unlit": true, "alphaMode": "blend", "alphaFactor": 0.25},
            {"name": "smoke", "baseColorFactor": [0.6, 0.6, 0.6], "unlit": true, "alphaMode": "blend", "alphaFactor": 0.5},
            {"name": "checks", "baseColorTexture": {"pattern": "checker", "count": [9, 9]}, "unlit": true, "alphaMode": "blend", "alphaFactor": 0.7},
            {"name": "solid", "baseColorFactor": [0.3, 0.5, 0.4], "unlit": true}],
        "meshes": [)" +
           meshes + "]}";
}

/// Upright at this z, of a size of its own.
std::string upright_sheet(const std::string& material, double z, double size = 60) {
    const std::string wide = std::to_string(size);
    return R"(, {"name": "sheet)" + std::to_string(z) + R"(", "role": "object", "material": ")" + material +
           R"(", "primitive": {"type": "plane", "center": [0, 0, )" + std::to_string(z) +
           R"(], "normal": [0, 0, 1], "tangent": [1, 0, 0], "size": [)" + wide + ", " + wide + "]}}";
}

double laid_over(double alpha, double colour, double behind) {
    return alpha * colour + (1 - alpha) * behind;
}

/// What glass leaves of light on this way.
double left_in_block(double way) {
    return std::pow(kLeftOfGreen, way);
}

void check_block(World& world, double expected) {
    for (const Engine engine : {Engine::kExact, Engine::kFacetsTruth, Engine::kLimitTruth})
        for (const int spp : {1, 2}) {
            INFO("engine " << static_cast<int>(engine) << " spp " << spp);
            const Image image = drawn_by(world, spp, engine);
            const std::vector<float>& values = image.find("G")->floats();
            const auto [least, most] = std::minmax_element(values.begin(), values.end());
            CHECK(double{*least} == Approx(expected).epsilon(1e-6));
            CHECK(double{*most} == Approx(expected).epsilon(1e-6));
        }
}

/// The mean difference of two pictures' colours, and the largest.
std::pair<double, double> colours_apart(const Image& a, const Image& b) {
    double worst = 0, mean = 0;
    for (const char* channel : {"R", "G", "B"}) {
        const std::vector<float>&x = a.find(channel)->floats(), &y = b.find(channel)->floats();
        for (std::size_t i = 0; i < x.size(); ++i) {
            const double off = std::fabs(double{x[i]} - double{y[i]});
            worst = std::max(worst, off), mean += off / static_cast<double>(3 * x.size());
        }
    }
    return {mean, worst};
}

}  // namespace

TEST_CASE("a blended pane in glass is dimmed by the glass before it, in its order with those outside",
          "[laws][law]") {
    const std::string panes = upright_sheet("smoke", 2) + upright_sheet("veil", 0.25) +
                              upright_sheet("smoke", -0.25) + upright_sheet("veil", -2);
    const auto world = world_from("block", veiled_glass(kEyeBeforeBlock, wide_block("glass") + panes), 3);
    const double behind = laid_over(0.25, 1, 0.1);
    // Backward from the block's far side: what glass leaves, then a pane.
    const double at_smoke = left_in_block(0.25) * behind,
                 at_veil = left_in_block(0.5) * laid_over(0.5, 0.6, at_smoke);
    const double seen = left_in_block(0.25) * laid_over(0.25, 1, at_veil);
    check_block(*world, laid_over(0.5, 0.6, seen));
}

TEST_CASE("a blended pane on a face of glass counts once, and as outside", "[laws][law]") {
    for (const double z : {0.5, -0.5}) {
        const auto world = world_from(
            "block", veiled_glass(kEyeBeforeBlock, wide_block("glass") + upright_sheet("veil", z)), 3);
        INFO("pane at " << z);
        check_block(*world, z > 0 ? laid_over(0.25, 1, left_in_block(1) * 0.1)
                                  : left_in_block(1) * laid_over(0.25, 1, 0.1));
    }
    const auto inside =
        world_from("block", veiled_glass(kEyeInBlock, wide_block("glass") + upright_sheet("veil", -0.5)), 3);
    check_block(*inside, left_in_block(0.9) * laid_over(0.25, 1, 0.1));
}

TEST_CASE("a blended pane close to a face of glass counts once, whatever lies far away", "[laws][law]") {
    for (const double inset : {0.1, 1e-3, 1e-5, 1e-7, 3e-9, 1e-10, -1e-10, -3e-9, -1e-7, -1e-3})
        for (const double side : {1.0, -1.0})
            for (const double far : {0.0, 1e5, 2e6}) {
                const double z = side * (0.5 - inset);
                std::string pane = upright_sheet("veil", 0, 60);
                pane.replace(pane.find("[0, 0, 0.000000]"), 16, fmt::format("[0, 0, {:.17g}]", z));
                if (far > 0)
                    pane +=
                        fmt::format(R"(, {{"name": "far", "role": "object", "material": "smoke", "primitive":
                        {{"type": "plane", "center": [{}, 0, 0], "normal": [0, 0, 1], "tangent": [1, 0, 0],
                          "size": [1, 1]}}}})",
                                    far);
                const auto world =
                    world_from("block", veiled_glass(kEyeBeforeBlock, wide_block("glass") + pane), 3);
                INFO("inset " << inset << ", side " << side << ", far " << far);
                const double way = std::clamp(side > 0 ? inset : 1 - inset, 0.0, 1.0);
                check_block(*world, left_in_block(way) * laid_over(0.25, 1, left_in_block(1 - way) * 0.1));
            }
}

TEST_CASE("a camera that stands in glass sees the blended panes there", "[laws][law]") {
    const auto world = world_from("block",
                                  veiled_glass(kEyeInBlock, wide_block("glass") + upright_sheet("veil", 0.1) +
                                                                upright_sheet("smoke", -0.6)),
                                  3);
    const double at_veil = left_in_block(0.6) * laid_over(0.5, 0.6, 0.1);
    check_block(*world, left_in_block(0.3) * laid_over(0.25, 1, at_veil));
    // Before an opaque object, with no optic on the way.
    const auto closed =
        world_from("block",
                   veiled_glass(kEyeInBlock, wide_block("glass") + upright_sheet("veil", 0.1) +
                                                 upright_sheet("solid", -0.2)),
                   3);
    check_block(*closed, left_in_block(0.3) * laid_over(0.25, 1, left_in_block(0.3) * 0.5));
}

TEST_CASE("blended surfaces in a ball of glass: projector and truth show the same", "[laws][law]") {
    const std::string ball =
        R"({"name": "ball", "role": "optic", "material": "glass", "primitive": {"type": "sphere", "center": [0, 0, 0], "radius": 1}})";
    const std::string inside =
        upright_sheet("thin", 0.3, 1) + upright_sheet("checks", -0.1, 0.8) +
        R"(, {"name": "bubble", "role": "object", "material": "veil", "primitive": {"type": "sphere", "center": [0.3, 0.2, -0.4], "radius": 0.3, "segments": 12}},
            {"name": "core", "role": "object", "material": "solid", "primitive": {"type": "sphere", "center": [-0.3, -0.2, -0.3], "radius": 0.25, "segments": 12}})";
    const std::string lamp =
        R"(], "lights": [{"type": "point", "position": [2, 3, 3], "intensity": 60, "shadows": true})";
    const std::string camera =
        R"("yfov": 32, "lookAt": {"eye": [0, 0, 4], "at": [0, 0, 0], "up": [0, 1, 0]})";
    const auto world =
        world_from("ball", veiled_glass(camera, ball + inside + upright_sheet("solid", -3, 3) + lamp), 48);
    const Image exact = drawn_by(*world, 2, Engine::kExact),
                facets = drawn_by(*world, 2, Engine::kFacetsTruth),
                limit = drawn_by(*world, 2, Engine::kLimitTruth);
    CHECK(exact.find("refractID.object")->ids() == facets.find("refractID.object")->ids());
    const auto [off_facets, worst] = colours_apart(exact, facets);
    const double off_limit = colours_apart(exact, limit).first;
    INFO("worst against facets " << worst << ", mean against the limit " << off_limit);
    CHECK(worst < 1e-5);
    CHECK(off_limit < 0.004);
    // Without what blends in it, the ball looks otherwise.
    const auto empty =
        world_from("ball", veiled_glass(camera, ball + upright_sheet("solid", -3, 3) + lamp), 48);
    CHECK(colours_apart(exact, drawn_by(*empty, 2, Engine::kExact)).first > 0.02);
}

TEST_CASE("rough glass shows what blends in it, drawn and traced", "[laws][law]") {
    const auto world = world_from(
        "block", veiled_glass(kEyeBeforeBlock, wide_block("frosted") + upright_sheet("smoke", 0.1, 0.6)), 8);
    const auto [mean, worst] =
        colours_apart(drawn_by(*world, 2, Engine::kExact), drawn_by(*world, 2, Engine::kLimitTruth));
    INFO("mean " << mean << ", worst " << worst);
    CHECK(mean < 0.01);
    const auto empty = world_from("block", veiled_glass(kEyeBeforeBlock, wide_block("frosted")), 8);
    CHECK(colours_apart(drawn_by(*world, 2, Engine::kExact), drawn_by(*empty, 2, Engine::kExact)).first >
          0.05);
}

TEST_CASE("what blends in glass dims light that comes through it", "[laws][law][caustics][thorough]") {
    const auto pane_of_glass = [](double low, double high) {
        std::string points;
        for (const char* const x : {"-2", "2"})
            for (const double y : {low, high})
                for (const char* const z : {"-3", "1"})
                    points += (points.empty() ? "[" : ",[") + std::string(x) + "," + std::to_string(y) + "," +
                              z + "]";
        return R"({"name": "pane", "role": "optic", "material": "glass", "resolution": 4, "subdivisionScheme": "bilinear", "points": [)" +
               points +
               R"(], "faceVertexCounts": [4,4,4,4,4,4], "faceVertexIndices": [0,1,3,2,4,6,7,5,0,4,5,1,2,3,7,6,0,2,6,4,1,5,7,3]})";
    };
    const auto smoke_at = [](double y) {
        return R"(, {"name": "smoke", "role": "object", "material": "smoke", "primitive": {"type": "plane", "center": [0, )" +
               fmt::format("{:.17g}", y) +
               R"(, 0], "normal": [0, 1, 0], "tangent": [1, 0, 0], "size": [60, 60]}})";
    };
    const Receiver there = on_floor(0.1, -1);
    // Glass over the floor, and glass that reaches down below it: then the light ends inside.
    for (const double low : {1.0, -0.5}) {
        const LitWorld free(lit_world(pane_of_glass(low, 2), kLamp));
        const double exact = free.light().exact_irradiance(there).y;
        CHECK(exact > 0.05);
        for (const double y : {1.5, 2.0, low, 2.5, 2 - 1e-7, 2 + 1e-7, low + 1e-7}) {
            if (y < 0) continue;
            INFO("glass from " << low << ", smoke at " << y);
            const LitWorld dimmed(lit_world(pane_of_glass(low, 2) + smoke_at(y), kLamp));
            // What is reflected twice inside, a five hundredth, comes through it three times.
            CHECK(dimmed.light().exact_irradiance(there).y == Approx(0.5 * exact).epsilon(0.003));
            CHECK(dimmed.light().irradiance(there).y == Approx(0.5 * exact).epsilon(0.04));
        }
    }
}
