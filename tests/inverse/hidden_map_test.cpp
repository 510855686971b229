// No place of a map lies where the film shows another thing: its ray comes back to the target, whatever
// stands before the optics, for every proxy and kind of camera.
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "ball_worlds.h"
#include "base/util/format.h"
#include "inverse/maps/film_map.h"
#include "inverse/maps/proxy.h"
#include "inverse/maps/target.h"
#include "render/shoot/shoot.h"
#include "support/test.h"

using namespace trilens;
using namespace trilens_test;

namespace {

const std::string kEye = R"("lookAt": {"eye": [0.5, 1.5, 4], "at": [0.1, 0.9, 0]})";
const std::string kPlate = R"({"name": "plate", "role": "object", "material": "red",
    "points": [[0, 0.7, 2], [0.5, 0.7, 2], [0.5, 1.3, 2], [0, 1.3, 2]],
    "faceVertexCounts": [4], "faceVertexIndices": [0, 1, 2, 3]})";
const std::string kFront = R"({"name": "front", "role": "optic", "material": "chrome", "resolution": 8,
    "primitive": {"type": "sphere", "center": [0.3, 1.1, 1.8], "radius": 0.25}})";

/// Radians; at a ball's rim rays turn that far within the tolerance.
constexpr double kMostTurned = 0.05;

struct BeforeBall {
    std::string camera = R"("yfov": 40, )" + kEye;
    std::string mesh = kPlate;  // beside the ball
    std::string material = "chrome";
    int depth = 0;
};

std::shared_ptr<const World> ball_behind(const BeforeBall& scene) {
    return world_of(fmt::format(R"({{"version": 1, "film": {{"width": 60, "height": 45}},
  "cameras": [{{"name": "eye", {}}}], "render": {{"maxDepth": {}}},
  "materials": [{{"name": "chrome", "metallicFactor": 1, "roughnessFactor": 0}},
                {{"name": "glass", "transmissionFactor": 1, "ior": 1.5}}, {{"name": "red", "unlit": true}}],
  "meshes": [{{"name": "ball", "role": "optic", "material": "{}", "resolution": 8,
               "primitive": {{"type": "sphere", "center": [0.2, 1, -0.1], "radius": 0.9}}}}, {}]}})",
                                scene.camera, scene.depth, scene.material, scene.mesh));
}

FilmMapRequest equirect_to(const std::string& proxy) {
    FilmMapRequest request;
    request.target = {TargetKind::kEquirect, 120, 60};
    request.proxy = parse_proxy(proxy);
    request.optic = 0;
    request.center = Vec3(0.2, 1, -0.1);
    return request;
}

struct Returned {
    std::size_t mapped = 0, astray = 0;  // places; those that no ray within the tolerance comes back from
};

/// Follows the rays at the map's places on the film, and the tolerance beside them, over each of the words.
Returned follow_back(const World& world, const FilmMapRequest& request,
                     const std::vector<std::string>& words) {
    const FilmMap map = make_film_map(world, request);
    const Target target(request.target, world.scene);
    const Proxy proxy(request.proxy, world, *request.center);
    const double off = request.tolerance;
    std::vector<Vec2> places;
    std::vector<Vec3> directions;
    for (std::size_t p = 0; p < map.valid.size(); ++p) {
        if (!map.valid[p]) continue;
        for (const Vec2& step : {Vec2(0), Vec2(off, 0), Vec2(-off, 0), Vec2(0, off), Vec2(0, -off)})
            places.push_back(Vec2(map.x[p], map.y[p]) + step);
        directions.push_back(target.place({double(p % 120) + 0.5, double(p / 120) + 0.5})->at);
    }
    std::vector<unsigned char> returns(directions.size(), 0);
    for (const std::string& word : words) {
        const ShotRays shots = shoot_places(world, {0, EventWord(word)}, places);
        for (std::size_t i = 0; i < places.size(); ++i) {
            const ShotRay& shot = shots.rays[i];
            if (!shot.followed() || shots.events_of(shot)[0].optic != 0) continue;
            const Vec3 way = normalize_or_zero(proxy.direction_met({shot.origin, shot.direction}));
            returns[i / 5] |= dot(way, directions[i / 5]) > std::cos(kMostTurned);
        }
    }
    return {directions.size(), static_cast<std::size_t>(std::ranges::count(returns, 0))};
}

}  // namespace

TEST_CASE("what stands before a mirror is in no map, however far its surroundings are taken to be",
          "[inverse][law]") {
    for (const std::string& mesh : {kPlate, kFront}) {
        const auto world = ball_behind({.mesh = mesh});
        const auto bare = ball_behind({.mesh = R"({"name": "plate", "role": "object", "material": "red",
            "points": [[90, 0, 2], [90.1, 0, 2], [90, 0.1, 2]],
            "faceVertexCounts": [3], "faceVertexIndices": [0, 1, 2]})"});
        for (const char* proxy : {"infinity", "sphere:30", "box:-6,-5,-6,6,7,8"}) {
            INFO(proxy << " behind " << (mesh == kPlate ? "a plate" : "a ball"));
            const FilmMapRequest request = equirect_to(proxy);
            const Returned hidden = follow_back(*world, request, {"R"}),
                           whole = follow_back(*bare, request, {"R"});
            // Light that grazes the ball goes straight on: one place at its rim may lie beside it.
            CHECK(whole.astray <= 1);
            CHECK(hidden.astray <= whole.astray);
            CHECK(hidden.mapped > 3000);
            CHECK(hidden.mapped + 1000 < whole.mapped);

            const WarpMeshParams mesh_of{121, 61, 1, WarpGrid::kTarget};
            const std::size_t drawn = make_warp_mesh(*world, request, mesh_of).drawn_count();
            CHECK(drawn > 3000);
            CHECK(drawn + 1000 < make_warp_mesh(*bare, request, mesh_of).drawn_count());
        }
    }
}

TEST_CASE("places of a map through glass are those of light that has left the glass", "[inverse][law]") {
    const auto world = ball_behind({.material = "glass", .depth = 3});
    for (const char* proxy : {"infinity", "sphere:1000"}) {
        FilmMapRequest request = equirect_to(proxy);
        request.path = Path::kRefract;
        const Returned found = follow_back(*world, request, {"TT", "TRT", "TRRT"});
        INFO(proxy << ": " << found.astray << " of " << found.mapped);
        CHECK(found.astray == 0);
        CHECK(found.mapped > 4000);
    }
}

TEST_CASE("maps of cameras without an eye have places of exact rays alone", "[inverse][law]") {
    for (
        const char* camera :
        {R"("type": "pushbroom", "travel": [2, 0.3, 0.4], "yfov": 45, )",
         R"("type": "crossedSlits", "window": [-1.5, 1.5, -1.2, 1.2],
             "slits": [[[0.5, 1.5, 4], [0, 1, 0.1]], [[0.4, 1.3, 2.5], [1, 0.2, 0]]], )",
         R"("type": "planarContext", "yfov": 40, "ground": [[0, -1, 0], [0, 1, 0]], "bend": 5, "angle": 60, )"}) {
        BeforeBall scene;
        scene.camera = camera + kEye;
        INFO(camera);
        const Returned found = follow_back(*ball_behind(scene), equirect_to("infinity"), {"R"});
        INFO(found.astray << " of " << found.mapped);
        CHECK(found.astray == 0);
        CHECK(found.mapped > 3000);
    }
}
