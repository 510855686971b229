// Filtered textures in whole pictures: a ramp, a zone plate and a checkerboard that runs to the horizon, seen
// directly, in a mirror sphere and through a ball of glass, against many samples per pixel.
#include <algorithm>
#include <array>
#include <cmath>

#include "laws/agreement.h"
#include "laws/pictures.h"
#include "laws/worlds.h"
#include "render/engines/engine.h"
#include "render/picture/picture.h"
#include "render/picture/sample_colour.h"
#include "support/test.h"

using namespace trilens;
using namespace trilens_test;

namespace {

enum class Print { kRamp, kZonePlate, kCheckerboard };

/// Rings that are ever finer from the middle of the picture out.
std::shared_ptr<const Texture> zone_plate() {
    constexpr int kTexels = 512;
    auto texture = std::make_shared<Texture>();
    texture->width = texture->height = kTexels;
    for (int y = 0; y < kTexels; ++y)
        for (int x = 0; x < kTexels; ++x) {
            const double u = (x + 0.5) / kTexels - 0.5, v = (y + 0.5) / kTexels - 0.5;
            const double value = 0.5 + 0.5 * std::cos(3.14159265358979 * kTexels * (u * u + v * v));
            for (int c = 0; c < 3; ++c) texture->rgb.push_back(static_cast<float>(value));
        }
    return texture;
}

/// A printed ground of 80 x 80 units, and the optic (or nothing) that stands on it.
std::unique_ptr<World> printed_ground(const std::string& optic, Print print) {
    const std::string pattern =
        print == Print::kRamp
            ? R"({"pattern": "ramp", "wrapS": "clampToEdge", "wrapT": "clampToEdge"})"
            : R"({"pattern": "checker", "count": [8, 8], "transform": {"scale": [10, 10]}})";
    const std::string material = optic == "mirror" ? R"("metallicFactor": 1)" : R"("transmissionFactor": 1)";
    const std::string ball = optic.empty() ? "" : R"(,{"name": "ball", "role": "optic", "material": "ball",
                            "primitive": {"type": "sphere", "center": [0, 1, 0], "radius": 1}})";
    auto world = world_from("printed",
                            R"({"version": 1, "film": {"width": 48, "height": 36},
        "cameras": [{"name": "main", "yfov": 40,
                     "lookAt": {"eye": [0.3, 1.6, 4.5], "at": [0, 0.9, 0], "up": [0, 1, 0]}}],
        "background": {"color": [0.5, 0.5, 0.5]}, "render": {"fresnel": false},
        "materials": [{"name": "ball", )" +
                                material + R"(},
                      {"name": "print", "unlit": true, "baseColorTexture": )" +
                                pattern + R"(}],
        "meshes": [{"name": "ground", "role": "object", "material": "print",
                    "points": [[-40, 0, 40], [40, 0, 40], [40, 0, -40], [-40, 0, -40]], "uvs": [[0, 0], [1, 0], [1, 1], [0, 1]],
                    "faceVertexCounts": [4], "faceVertexIndices": [0, 1, 2, 3]})" +
                                ball + "]}",
                            32);
    if (print == Print::kZonePlate) {
        world->shading.materials[1].base_color_texture = zone_plate();
        prepare_textures(world->shading);
    }
    return world;
}

/// How far pictures may be off the truth of `spp` samples.
void check_prints(const std::vector<std::string>& optics, const std::vector<Print>& prints, int spp) {
    const double most = spp < 64 ? 0.035 : 0.02;  // with few samples most of it is the truth's own noise
    for (const std::string& optic : optics)
        for (const Print print : prints) {
            const auto world = printed_ground(optic, print);
            const Image truth = drawn_by(*world, spp, Engine::kLimitTruth);
            const PictureError fragments = picture_error(drawn_by(*world, 4, Engine::kExact), truth),
                               one = picture_error(drawn_by(*world, 1, Engine::kExact), truth),
                               traced = picture_error(drawn_by(*world, 1, Engine::kLimitTruth), truth);
            INFO("optic '" << optic << "', print " << static_cast<int>(print) << ": 4 x 4 rms "
                           << fragments.rms << " bias " << fragments.bias << ", 1 rms " << one.rms << " bias "
                           << one.bias << ", traced rms " << traced.rms << " bias " << traced.bias);
            CHECK(fragments.rms < most);
            CHECK(std::fabs(fragments.bias) < 0.002);
            CHECK(one.rms < 0.06);
            CHECK(traced.rms < 0.06);
        }
}

}  // namespace

TEST_CASE("printed grounds to the horizon: fragments and single samples are the means over pixels",
          "[laws][law][textures]") {
    check_prints({"mirror"}, {Print::kCheckerboard}, 12);
    check_prints({""}, {Print::kZonePlate, Print::kCheckerboard}, 16);
}

TEST_CASE("printed grounds against 64 x 64 samples, in plane, sphere and lens",
          "[.long][laws][law][textures]") {
    check_prints({"", "mirror", "glass"}, {Print::kRamp, Print::kZonePlate, Print::kCheckerboard}, 64);
}

TEST_CASE("differentials of facets in closed form are those of their rays, and those of exact paths",
          "[laws][law][textures]") {
    const auto world = printed_ground("mirror", Print::kCheckerboard);
    const std::unique_ptr<Viewer> facets = make_viewer(*world, {}, Engine::kExact, ignore),
                                  limit = make_viewer(*world, {}, Engine::kLimitTruth, ignore);
    const SampleGrid grid{0, 0, 48, 36, 1};
    SampleViews projected, traced;
    facets->view(grid, projected);
    limit->view(grid, traced);
    const RayDifferentials of_facets(*world, *facets, grid), of_paths(*world, *limit, grid);
    std::vector<double> unlike;
    for (std::size_t s = 0; s < grid.size(); ++s) {
        const SampleView &a = projected.samples[s], &b = traced.samples[s];
        if (a.optic != 0 || b.optic != 0 || projected.ends_of(a).empty() || traced.ends_of(b).empty())
            continue;
        const PathEnd &end = projected.ends_of(a)[0], &other = traced.ends_of(b)[0];
        const FacetMap map = facet_map(*facets, a, &end);
        REQUIRE(map.mesh);
        const Vec2 at = grid.position(s);
        const RayDifferential closed = map.differential(at);
        constexpr double kStep = 1e-4;
        for (std::size_t k = 0; k < 2; ++k) {
            const Vec2 step = k == 0 ? Vec2(kStep, 0) : Vec2(0, kStep);
            const Ray ahead = map.at(at + step), back = map.at(at - step);
            CHECK(length((ahead.direction - back.direction) / (2 * kStep) - closed.direction[k]) <
                  1e-6 * (length(closed.direction[k]) + length(end.ray.direction)));
            CHECK(length((ahead.origin - back.origin) / (2 * kStep) - closed.origin[k]) <
                  1e-6 * (length(closed.origin[k]) + 1));
        }
        const auto exact = of_paths.of(traced, s, {{&other.hit, &other.ray}, Vec3(1), &other});
        if (!exact) continue;
        // Turns of the unit direction, per pixel.
        for (std::size_t k = 0; k < 2; ++k) {
            const auto turn = [k](const Ray& ray, const RayDifferential& differential) {
                const Vec3 unit = normalize_or_zero(ray.direction);
                const Vec3 step = differential.direction[k] / length(ray.direction);
                return step - dot(step, unit) * unit;
            };
            const Vec3 one = turn(end.ray, closed), two = turn(other.ray, *exact);
            unlike.push_back(length(one - two) / (length(one) + length(two)));
        }
    }
    REQUIRE(unlike.size() > 400);
    std::sort(unlike.begin(), unlike.end());
    INFO("median " << unlike[unlike.size() / 2] << ", 90 % " << unlike[unlike.size() * 9 / 10]);
    CHECK(unlike[unlike.size() / 2] < 0.02);
    CHECK(unlike[unlike.size() * 9 / 10] < 0.1);
}

TEST_CASE(
    "a sky without a file has its formula's colour in every direction, and lights a floor by its integral",
    "[laws][law][textures]") {
    const std::string sky =
        R"("background": {"zenith": [0.1, 0.2, 0.9], "horizon": [0.7, 0.8, 0.6], "ground": [0.3, 0.2, 0.1]})";
    const Vec3 zenith(0.1, 0.2, 0.9), horizon(0.7, 0.8, 0.6), ground(0.3, 0.2, 0.1);
    const auto channel = [](const Image& image, int c, int at) {
        return double{image.find(std::array{"R", "G", "B"}[static_cast<std::size_t>(c)])
                          ->floats()[static_cast<std::size_t>(at)]};
    };

    constexpr int kWidth = 16, kHeight = 90;  // rows of two degrees, no middle of one at the horizon
    const auto around = world_from("sky",
                                   R"({"version": 1, "film": {"width": 16, "height": 90},
        "cameras": [{"type": "spherical", "lookAt": {"eye": [0, 0, 0], "at": [0, 0, -1]}}], )" +
                                       sky + "}",
                                   1);
    const Image seen = drawn_by(*around, 1, Engine::kLimitTruth);
    for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; x += 5) {
            const double height = std::cos(3.14159265358979 * (y + 0.5) / kHeight);
            const Vec3 formula = height > 0 ? (1 - height) * horizon + height * zenith : ground;
            for (int c = 0; c < 3; ++c) {
                INFO("row " << y << ", channel " << c);
                CHECK(channel(seen, c, y * kWidth + x) ==
                      Approx(formula[c]).margin(y == 44 || y == 45 ? 0.2 : 2e-3));
            }
        }

    // The mean of a sky over a level floor, weighted with the cosine, which is the height itself.
    const auto lit = world_from("floor", R"({"version": 1, "film": {"width": 2, "height": 2},
        "cameras": [{"type": "orthographic", "ymag": 1, "lookAt": {"eye": [0, 5, 0], "at": [0, 0, 0], "up": [0, 0, -1]}}],
        "materials": [{"name": "white"}], "lights": [{"type": "environment", "samples": 256}],
        "meshes": [{"name": "floor", "role": "object", "material": "white", "primitive": {"type": "plane", "size": [4, 4]}}],
        )" + sky + "}",
                                1);
    const Image floor = drawn_by(*lit, 1, Engine::kLimitTruth);
    const Vec3 closed = horizon + 2.0 / 3 * (zenith - horizon);
    for (int c = 0; c < 3; ++c) CHECK(channel(floor, c, 0) == Approx(closed[c]).epsilon(0.01));
}
