// Light over optics at curves and points that have closed forms, in a closed room, and in motion.
#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>
#include <vector>

#include "inverse/maps/caustic_map.h"
#include "render/world/world.h"
#include "study/scenes.h"
#include "support/lit_world.h"
#include "support/test.h"

using namespace trilens;
using namespace trilens_test;

namespace {

/// How much light is near a fold: two points at distances from it, on its bright side, less that beyond.
struct FoldLight {
    double near = 0, far = 0, beyond = 0;
    double ratio() const { return (near - beyond) / (far - beyond); }
};

FoldLight light_at_fold(const BeamLight& light, const Vec3& on_curve, const Vec3& across) {
    const auto light_at = [&](double distance) {
        const Vec3 there = on_curve + distance * across;
        return light.exact_irradiance(on_floor(there.x, there.z)).y;
    };
    const double side = light_at(0.002) > light_at(-0.002) ? 1 : -1;
    return {light_at(side * 0.0005), light_at(side * 0.002), light_at(-side * 0.002)};
}

const std::string kGlassBall = R"({"name": "ball", "role": "optic", "material": "glass", "resolution": 8,
    "primitive": {"type": "sphere", "center": [0, 1, 0], "radius": 0.8}})";

CausticMap floor_map(const World& world, int side) {
    CausticMapRequest request;
    request.target.kind = TargetKind::kObject;
    request.target.object = 0;
    request.target.width = request.target.height = side;
    return make_caustic_map(world, request);
}

/// The sum over all pixels of how much the light changes.
double change(const CausticMap& one, const CausticMap& other) {
    double sum = 0;
    for (std::size_t i = 0; i < one.irradiance.size(); ++i)
        sum += std::fabs(one.irradiance[i].y - other.irradiance[i].y);
    return sum;
}

}  // namespace

TEST_CASE("a lamp on the rim of a mirrored ring draws a cardioid", "[laws][law][caustics]") {
    // The lamp stands on the mirrored wall. Seen from above, light of all heights runs along the same lines:
    // those of a circle's point, reflected in the circle, touch (2 cos b + cos 2b, 2 sin b + sin 2b) / 3.
    // Source: Castillon, De curva cardioide, 1741.
    const LitWorld lit(lit_world(
        R"({"name": "ring", "role": "optic", "material": "mirror", "resolution": 16,
        "primitive": {"type": "cylinder", "center": [0, 0.5, 0], "axis": [0, 1, 0], "radius": 1, "height": 1}})",
        R"({"type": "point", "position": [0.999999, 0.9, 0], "intensity": 1, "caustics": true})"));
    for (const double b : {1.2, 1.7, 2.2}) {
        const Vec3 on_curve((2 * std::cos(b) + std::cos(2 * b)) / 3, 0,
                            (2 * std::sin(b) + std::sin(2 * b)) / 3);
        const Vec3 tangent(-std::sin(b) - std::sin(2 * b), 0, std::cos(b) + std::cos(2 * b));
        const Vec3 across = normalize(Vec3(tangent.z, 0, -tangent.x));
        const FoldLight fold = light_at_fold(lit.light(), on_curve, across);
        CAPTURE(b, fold.near, fold.far, fold.beyond);
        CHECK(fold.ratio() == Approx(2).epsilon(0.1));
    }
}

TEST_CASE("a parabola gathers the light that comes along its axis in its focus", "[laws][law][caustics]") {
    const LitWorld lit(lit_world(
        R"({"name": "dish", "role": "optic", "material": "mirror", "resolution": 16, "primitive": {"type": "paraboloid", "center": [0, 0.5, 0], "axis": [0, 1, 0], "radius": 1, "focalLength": 1}})",
        R"({"type": "directional", "direction": [0, -1, 0], "intensity": 1, "caustics": true})"));
    const Beams& beams = lit.light().beams();
    const Vec3 focus(0, 1.5, 0);
    double farthest = 0;
    std::size_t reflected = 0;
    for (const LightBeam& beam : beams.beams) {
        if (beams.histories[beam.history].steps.size() != 1) continue;
        for (const Id e : beam.end) {
            const BeamEnd& end = beams.ends[e];
            farthest = std::max(farthest, length(cross(focus - end.origin, end.direction)));
            ++reflected;
        }
    }
    CHECK(reflected > 100);
    CHECK(farthest < 1e-6);
}

TEST_CASE("a fold moves over the floor without flicker", "[laws][law][caustics]") {
    // The sun's nephroid in a ring, fold and cusp, drifts over pixels as the sun moves.
    constexpr int kPositions = 12;
    std::vector<CausticMap> maps;
    for (int i = 0; i < kPositions; ++i) {
        const double angle = 0.004 * i;
        maps.push_back(
            floor_map(*lit_world(
                          R"({"name": "ring", "role": "optic", "material": "mirror", "resolution": 16,
            "primitive": {"type": "cylinder", "center": [0, 0.5, 0], "axis": [0, 1, 0], "radius": 1, "height": 1}})",
                          R"({"type": "directional", "intensity": 1, "direction": [)" +
                              std::to_string(-0.8 * std::cos(angle)) + ", -0.6, " +
                              std::to_string(0.8 * std::sin(angle)) + "]}"),
                      96));
    }
    // A ring looks the same from all sides: nothing but what falls beside the floor may change.
    std::vector<double> flux;
    for (const CausticMap& map : maps) flux.push_back(map.flux_received.y / map.flux_in.y);
    const auto [least, most] = std::minmax_element(flux.begin(), flux.end());
    CAPTURE(*least, *most);
    CHECK(*most - *least < 2e-3 * *most);
    // What changes is in proportion to the step; a pop would be as large at half of it.
    double single = 0, twice = 0;
    for (std::size_t i = 0; i + 2 < maps.size(); ++i)
        single += change(maps[i], maps[i + 1]), twice += change(maps[i], maps[i + 2]);
    CAPTURE(single, twice);
    CHECK(single > 0);
    CHECK(twice > 1.5 * single);
    // No pixel jumps from its neighbours in time by more than a fold's whole light.
    double brightest = 0;
    for (const Vec3& light : maps[0].irradiance) brightest = std::max(brightest, light.y);
    for (std::size_t i = 1; i < maps.size(); ++i)
        for (std::size_t p = 0; p < maps[i].irradiance.size(); ++p)
            if (std::fabs(maps[i].irradiance[p].y - maps[i - 1].irradiance[p].y) > 0.75 * brightest) {
                CAPTURE(i, p, maps[i].irradiance[p].y, maps[i - 1].irradiance[p].y, brightest);
                CHECK(false);
            }
}

TEST_CASE("all light that comes through a ball falls on the walls of the room around it",
          "[laws][law][caustics]") {
    const std::string lamp = R"({"type": "point", "position": [0, 4, 3], "intensity": 10})";
    const std::string text =
        R"({"version": 1, "film": {"width": 8, "height": 8},
        "cameras": [{"lookAt": {"eye": [0, 4, 3], "at": [0, 1, 0]}}],
        "materials": [{"name": "white"}, {"name": "glass", "transmissionFactor": 1, "ior": 1.5}],
        "meshes": [{"name": "room", "role": "object", "material": "white",
            "points": [[-6,0,-6],[6,0,-6],[6,0,6],[-6,0,6],[-6,6,-6],[6,6,-6],[6,6,6],[-6,6,6]],
            "faceVertexCounts": [4,4,4,4,4,4],
            "faceVertexIndices": [0,3,2,1, 4,5,6,7, 0,1,5,4, 2,3,7,6, 1,2,6,5, 0,4,7,3]}, )" +
        kGlassBall + R"(], "lights": [)" + lamp + R"(], "render": {"maxDepth": 4}})";
    const auto world = make_world(parse_scene(text), ignore);
    // Each wall from inside: origin, and sides whose cross product comes into the room.
    const Vec3 walls[6][3] = {{{-6, 0, 6}, {12, 0, 0}, {0, 0, -12}}, {{-6, 6, -6}, {12, 0, 0}, {0, 0, 12}},
                              {{-6, 0, -6}, {12, 0, 0}, {0, 6, 0}},  {{6, 0, 6}, {-12, 0, 0}, {0, 6, 0}},
                              {{6, 0, -6}, {0, 0, 12}, {0, 6, 0}},   {{-6, 0, 6}, {0, 0, -12}, {0, 6, 0}}};
    double received = 0;
    CausticMap map;
    for (const auto& wall : walls) {
        CausticMapRequest request;
        request.target.kind = TargetKind::kPlane;
        request.target.origin = wall[0], request.target.u = wall[1], request.target.v = wall[2];
        request.target.width = request.target.height = 32;
        map = make_caustic_map(*world, request);
        received += map.flux_received.y;
    }
    // The ball is a cone of the lamp's directions; Fresnel's shares add up to 1, but for paths that carry
    // less than a 200th, which are not followed, and what goes on after maxDepth.
    const double cone = 2 * 3.14159265358979 * (1 - std::sqrt(1 - 0.8 * 0.8 / 18.0));
    CAPTURE(received, map.flux_on_objects.y, 10 * cone);
    CHECK(received == Approx(map.flux_on_objects.y).epsilon(1e-3));
    CHECK(map.flux_away.y == Approx(0).margin(1e-9));
    CHECK(received == Approx(10 * cone).epsilon(5e-3));
    CHECK(received < 10 * cone * 1.0005);
}

TEST_CASE("beams stay while only the camera moves, and light is as if they were new",
          "[laws][law][caustics]") {
    const auto scene_with = [](double eye, double lamp) {
        return lit_world(kGlassBall,
                         R"({"type": "point", "position": [0, )" + std::to_string(lamp) +
                             R"(, 3], "intensity": 10, "caustics": true})",
                         {eye, 4, 3})
            ->scene;
    };
    const auto world = make_world(scene_with(0, 4), ignore);
    const auto light_at = [](const World& of) {
        std::vector<double> light;
        for (double x = -0.6; x < 0.6; x += 0.1)
            light.push_back(irradiance(caustic_lights(of, false).by_light[0], on_floor(x, -1)).y);
        return light;
    };
    const auto* before = &caustic_lights(*world, false);
    change_scene(*world, scene_with(1, 4), ignore);
    CHECK(&caustic_lights(*world, false) == before);
    CHECK(light_at(*world) == light_at(*make_world(scene_with(1, 4), ignore)));
    change_scene(*world, scene_with(1, 4.5), ignore);
    CHECK(light_at(*world) == light_at(*make_world(scene_with(1, 4.5), ignore)));
    const auto light = light_at(*world);
    CHECK(std::accumulate(light.begin(), light.end(), 0.0) > 0);
    CHECK(light != light_at(*make_world(scene_with(1, 4), ignore)));
}
