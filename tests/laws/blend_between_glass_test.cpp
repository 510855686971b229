// Blended surfaces where two bodies of glass touch, and on mirrors in glass: seen as often as where they are
// a little way from there, by sight and by light.
#include <fmt/format.h>

#include <cmath>
#include <string>

#include "laws/pictures.h"
#include "laws/worlds.h"
#include "support/lit_world.h"
#include "support/test.h"

using namespace trilens;
using namespace trilens_test;

namespace {

constexpr double kLeftOfGlass = 0.5, kLeftOfFlint = 0.8;  // of light, after one unit
constexpr double kBehindGlass = 0.1, kVeilAlpha = 0.25;
constexpr double kBesideBorder[] = {0.1, 1e-3, 1e-5, 1e-7, 1e-8, 3e-9, 1e-10, 0};

std::string eye_on_axis(double z, double towards = -1) {
    return fmt::format(R"("type": "orthographic", "ymag": 0.5,
        "lookAt": {{"eye": [0, 0, {}], "at": [0, 0, {}], "up": [0, 1, 0]}})",
                       z, z + towards);
}

/// Wide enough to fill the film, from one z to the other.
std::string wide_body(const std::string& name, const std::string& material, double low, double high,
                      const std::string& more = "") {
    std::string points;
    for (const int x : {-4, 4})
        for (const int y : {-4, 4})
            for (const double z : {low, high})
                points += fmt::format("{}[{},{},{:.17g}]", points.empty() ? "" : ",", x, y, z);
    return fmt::format(
        R"({{"name": "{}", "role": "optic", "material": "{}"{}, "subdivisionScheme": "bilinear",
        "points": [{}], "faceVertexCounts": [4,4,4,4,4,4],
        "faceVertexIndices": [0,1,3,2,4,6,7,5,0,4,5,1,2,3,7,6,0,2,6,4,1,5,7,3]}})",
        name, material, more, points);
}

std::string wide_veil(double z) {
    return fmt::format(
        R"({{"name": "veil", "role": "object", "material": "veil", "primitive": {{"type": "plane",
        "center": [0, 0, {:.17g}], "normal": [0, 0, 1], "tangent": [1, 0, 0], "size": [60, 60]}}}})",
        z);
}

std::unique_ptr<World> between_glass(const std::string& camera, const std::string& meshes,
                                     int resolution = 3) {
    return world_from("between",
                      R"({"version": 1, "film": {"width": 12, "height": 10},
        "cameras": [{"name": "main", )" +
                          camera + R"(}], "background": {"color": [0.1, 0.1, 0.1]},
        "render": {"fresnel": false, "maxDepth": 8},
        "materials": [
            {"name": "glass", "transmissionFactor": 1, "ior": 1.5,
             "volume": {"attenuationColor": [0.5, 0.5, 0.5], "attenuationDistance": 1}},
            {"name": "flint", "transmissionFactor": 1, "ior": 1.7,
             "volume": {"attenuationColor": [0.8, 0.8, 0.8], "attenuationDistance": 1}},
            {"name": "mirror", "metallicFactor": 1},
            {"name": "veil", "baseColorFactor": [1, 1, 1], "unlit": true, "alphaMode": "blend", "alphaFactor": 0.25}],
        "meshes": [)" + meshes +
                          "]}",
                      resolution);
}

double over_veiled(double behind) {
    return kVeilAlpha + (1 - kVeilAlpha) * behind;
}

/// What is left of light that goes from one z to a lower one, of glass below and flint above `border`.
double left_between(double high, double low, double border) {
    const double in_flint = std::max(high - std::max(low, border), 0.0), in_glass = high - low - in_flint;
    return std::pow(kLeftOfFlint, in_flint) * std::pow(kLeftOfGlass, in_glass);
}

void check_all_green(World& world, double expected) {
    for (const Engine engine : {Engine::kExact, Engine::kFacetsTruth, Engine::kLimitTruth})
        for (const int spp : {1, 2}) {
            INFO("engine " << static_cast<int>(engine) << " spp " << spp);
            const Image image = drawn_by(world, spp, engine);
            for (const float value : image.find("G")->floats())
                if (std::fabs(value / expected - 1) > 1e-6) REQUIRE(double{value} == Approx(expected));
        }
}

/// Of a receiver's footprint: beams that share a side differ at a point of it, where rounding chooses one.
constexpr double kWideFootprint = 0.3;

struct Arriving {
    double at_point = 0, mean = 0;  // of exact paths, in the footprint's middle and over it
    double by_beams = 0;            // over it
    double beams_at_point = 0;
};

/// Over the footprint, by Gauss and Legendre's rule of three points each way.
double mean_exact(const BeamLight& light, const Receiver& receiver) {
    double sum = 0;
    for (const int i : {-1, 0, 1})
        for (const int j : {-1, 0, 1}) {
            const Vec3 off =
                0.5 * std::sqrt(0.6) * (double(i) * receiver.sides[0] + double(j) * receiver.sides[1]);
            Receiver at = receiver;
            at.point += off, at.lifted += off;
            sum += (i == 0 ? 8 : 5) * (j == 0 ? 8 : 5) / 324.0 * light.exact_irradiance(at).y;
        }
    return sum;
}

}  // namespace

TEST_CASE("a blended pane where two glasses touch is seen once, as beside it, whichever is named first",
          "[laws][law]") {
    const std::string glass = wide_body("glass", "glass", -0.5, 0),
                      flint = wide_body("flint", "flint", 0, 0.5);
    for (const std::string& bodies : {glass + "," + flint, flint + "," + glass})
        for (const double side : {1.0, -1.0})
            for (const double inset : kBesideBorder)
                for (const double eye : {4.0, 0.4}) {
                    const double z = side * inset, from = std::min(eye, 0.5);
                    INFO("pane at " << z << ", eye at " << eye);
                    const auto world = between_glass(eye_on_axis(eye), bodies + "," + wide_veil(z));
                    check_all_green(*world, left_between(from, z, 0) *
                                                over_veiled(left_between(z, -0.5, 0) * kBehindGlass));
                }
}

TEST_CASE(
    "a blended pane on a side that two bodies have in common, and on one that bends nothing, is seen once",
    "[laws][law]") {
    const std::string outer = wide_body("outer", "glass", -0.5, 0.5),
                      inner = wide_body("inner", "flint", 0, 0.5, R"(, "priority": 1)"),
                      hidden = wide_body("hidden", "flint", 0, 0.3, R"(, "priority": -1)");
    for (const std::string& bodies : {outer + "," + inner, inner + "," + outer})
        for (const double z : {0.5, 0.0, -0.5, 0.5 - 1e-7, 0.5 + 1e-7, 1e-9, -1e-9}) {
            INFO("pane at " << z << " of the common side's bodies");
            check_all_green(*between_glass(eye_on_axis(4), bodies + "," + wide_veil(z)),
                            left_between(0.5, std::clamp(z, -0.5, 0.5), 0) *
                                over_veiled(left_between(std::clamp(z, -0.5, 0.5), -0.5, 0) * kBehindGlass));
        }
    for (const double z : {0.3, 0.0, 1e-9, 0.3 - 1e-9}) {
        INFO("pane at " << z << ", where nothing bends");
        check_all_green(
            *between_glass(eye_on_axis(4), outer + "," + hidden + "," + wide_veil(z)),
            std::pow(kLeftOfGlass, 0.5 - z) * over_veiled(std::pow(kLeftOfGlass, z + 0.5) * kBehindGlass));
    }
}

TEST_CASE("a blended pane on a mirror is seen before it and in it, in glass as in air", "[laws][law]") {
    for (const bool in_glass : {false, true})
        for (const double mirror : {-0.2, -0.5})
            for (const double inset : kBesideBorder)
                for (const double eye : {4.0, 0.4}) {
                    INFO("in glass " << in_glass << ", mirror at " << mirror << ", pane before it by "
                                     << inset << ", eye at " << eye);
                    const std::string glass = in_glass ? wide_body("glass", "glass", -0.5, 0.5) + "," : "";
                    const auto world =
                        between_glass(eye_on_axis(eye), glass + wide_body("back", "mirror", -0.7, mirror) +
                                                            "," + wide_veil(mirror + inset));
                    const auto left = [&](double way) { return in_glass ? std::pow(kLeftOfGlass, way) : 1; };
                    const double to_veil = std::min(eye, 0.5) - mirror - inset;
                    const double out = over_veiled(left(0.5 - mirror - inset) * kBehindGlass);
                    check_all_green(*world, left(to_veil) * over_veiled(left(2 * inset) * out));
                }
}

TEST_CASE("light comes through what blends where two glasses touch once, and twice on a mirror in glass",
          "[laws][law][caustics][thorough]") {
    const auto slab = [](const std::string& name, const std::string& material, const Vec3& low,
                         const Vec3& high) {
        std::string points;
        for (const double x : {low.x, high.x})
            for (const double y : {low.y, high.y})
                for (const double z : {low.z, high.z})
                    points += fmt::format("{}[{},{},{}]", points.empty() ? "" : ",", x, y, z);
        return fmt::format(R"({{"name": "{}", "role": "optic", "material": "{}", "resolution": 4,
            "subdivisionScheme": "bilinear", "points": [{}], "faceVertexCounts": [4,4,4,4,4,4],
            "faceVertexIndices": [0,1,3,2,4,6,7,5,0,4,5,1,2,3,7,6,0,2,6,4,1,5,7,3]}})",
                           name, material, points);
    };
    const auto smoke = [](const Vec3& at, const Vec3& normal, const Vec3& tangent) {
        return fmt::format(R"(, {{"name": "smoke", "role": "object", "material": "smoke", "primitive":
            {{"type": "plane", "center": [{:.17g}, {:.17g}, 0], "normal": [{}, {}, 0],
              "tangent": [{}, {}, 0], "size": [60, 60]}}}})",
                           at.x, at.y, normal.x, normal.y, tangent.x, tangent.y);
    };
    Receiver there = on_floor(0.1, -1);
    const Receiver middle = there;
    there.sides = {Vec3(kWideFootprint, 0, 0), Vec3(0, 0, -kWideFootprint)};
    const auto arrives = [&](const std::string& meshes) {
        const LitWorld lit(lit_world(meshes, kLamp));
        const BeamLight& light = lit.light();
        return Arriving{light.exact_irradiance(there).y, mean_exact(light, there), light.irradiance(there).y,
                        light.irradiance(middle).y};
    };
    // One above the other over the floor, and reaching down below it: then the light ends inside.
    for (const double low : {1.0, -0.5}) {
        const std::string slabs = slab("lower", "glass", {-2, low, -3}, {2, 1.5, 1}) + "," +
                                  slab("upper", "glass", {-2, 1.5, -3}, {2, 2, 1});
        const Arriving free = arrives(slabs);
        CHECK(free.at_point > 0.05);
        INFO("slabs from " << low);
        const Arriving smoked = arrives(slabs + smoke({0, 1.5, 0}, {0, 1, 0}, {1, 0, 0}));
        // But for what goes back and forth between the faces, a few thousandths, which crosses it oftener.
        CHECK(smoked.at_point == Approx(0.5 * free.at_point).epsilon(0.003));
        CHECK(smoked.by_beams == Approx(0.5 * free.mean).epsilon(0.005));
        CHECK(smoked.beams_at_point == Approx(0.5 * free.at_point).epsilon(0.04));
    }
    // A mirror upright beside the floor, which sends the light of a lamp at (-4, 4, 3); and glass that
    // touches it.
    const std::string mirror = slab("back", "mirror", {-2.2, 0.2, -4}, {-2, 3, 4});
    const double away = 4.1 * 4.1 + 4 * 4 + 4 * 4;
    const Arriving mirrored = arrives(mirror);
    CHECK(mirrored.at_point == Approx(10 * 4 / (away * std::sqrt(away))).epsilon(1e-6));
    CHECK(mirrored.by_beams == Approx(mirrored.mean).epsilon(0.005));
    const std::string backed = mirror + "," + slab("front", "glass", {-2, 0.2, -4}, {-1.8, 3, 4});
    const Arriving free = arrives(backed),
                   before = arrives(backed + smoke({-1.9, 0, 0}, {1, 0, 0}, {0, 1, 0}));
    CHECK(free.at_point > 0.02);
    CHECK(before.at_point < 0.35 * free.at_point);
    for (const double inset : {1e-7, 0.0}) {
        INFO("smoke before the mirror by " << inset);
        const Arriving smoked = arrives(backed + smoke({-2 + inset, 0, 0}, {1, 0, 0}, {0, 1, 0}));
        CHECK(smoked.at_point == Approx(before.at_point).epsilon(0.003));
        CHECK(smoked.by_beams == Approx(before.mean).epsilon(0.005));
        CHECK(smoked.beams_at_point == Approx(before.at_point).epsilon(0.04));
    }
}
