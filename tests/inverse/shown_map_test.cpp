// Maps of what a film shows lose nothing: against the ray of every pixel.
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "ball_worlds.h"
#include "base/util/error.h"
#include "base/util/format.h"
#include "inverse/maps/film_map.h"
#include "inverse/maps/target.h"
#include "render/shoot/shoot.h"
#include "support/draw.h"
#include "support/test.h"

using namespace trilens;
using namespace trilens_test;

namespace {

constexpr int kCameras = 5;

/// Two mirror balls and one of glass side by side in a room, a needle before them, and kCameras cameras.
std::string three_balls(Draw& draw) {
    const auto ball = [&](const char* name, const char* material, double x) {
        return fmt::format(R"({{"name": "{}", "role": "optic", "material": "{}", "resolution": 8,
            "primitive": {{"type": "sphere", "center": [{}, {}, {}], "radius": {}}}}})",
                           name, material, x, draw.uniform(-0.3, 0.3), draw.uniform(-0.5, 0.5),
                           draw.uniform(0.35, 0.55));
    };
    const std::string balls = ball("left", "chrome", draw.uniform(-0.9, -0.7)) + ",\n" +
                              ball("right", "chrome", draw.uniform(0.3, 0.5)) + ",\n" +
                              ball("glass", "glass", draw.uniform(1.4, 1.7));
    const auto from = [&](double distance) {
        return fmt::format(R"("lookAt": {{"eye": [{}, {}, {}], "at": [0.3, 0, 0]}})", draw.uniform(-1, 1.5),
                           draw.uniform(-0.8, 0.8), distance);
    };
    const std::string cameras =
        R"({"name": "0", "yfov": 40, )" + from(4) +
        R"(}, {"name": "1", "type": "orthographic", "ymag": 1.4, )" + from(4) +
        R"(}, {"name": "2", "type": "fisheye", "mapping": "equisolid", "fov": 170, )" + from(1.8) +
        R"(}, {"name": "3", "type": "spherical", )" + from(1.8) +
        R"(}, {"name": "4", "type": "opencv", "model": "pinhole", "fx": 90, "fy": 92, "cx": 52, "cy": 35,
               "distortion": [-0.15, 0.05, 0.002, -0.001, 0.01], )" +
        from(3) + "}";
    const double needle = draw.uniform(-0.6, 0.6);
    return R"({"version": 1, "film": {"width": 97, "height": 75}, "cameras": [)" + cameras + R"(],
  "materials": [{"name": "chrome", "metallicFactor": 1, "roughnessFactor": 0},
                {"name": "glass", "transmissionFactor": 1, "ior": 1.5},
                {"name": "red", "unlit": true}],
  "meshes": [)" +
           balls +
           R"(, {"name": "room", "role": "object", "material": "red",
                 "primitive": {"type": "box", "center": [0, 0.5, 0], "size": [12, 8, 14]}},
                {"name": "needle", "role": "object", "material": "red",
                 "primitive": {"type": "box", "center": [)" +
           std::to_string(needle) + R"(, 0, 1.3], "size": [0.02, 1.1, 0.02]}}]})";
}

struct Held {
    std::size_t shown = 0, lost = 0, added = 0;  // pixels
    double worst = 0;                            // that a place is off, pixels of the target
};

/// A view's map against `shoot` at every pixel.
Held hold_against_rays(const World& world, const FilmMapRequest& request) {
    const Film& film = world.scene.film;
    std::vector<Vec2> middles;
    for (int y = 0; y < film.height; ++y)
        for (int x = 0; x < film.width; ++x) middles.emplace_back(x + 0.5, y + 0.5);
    const ShotRays shots = shoot_places(world, {request.frame.camera, request.word}, middles);
    std::optional<FilmMap> map;
    try {
        map = make_film_map(world, request);
    } catch (const InputError&) {
        // Nothing is mapped: then no ray may show the target.
    }
    const Target target(request.target, world.scene);
    Held held;
    for (std::size_t p = 0; p < middles.size(); ++p) {
        const ShotRay& shot = shots.rays[p];
        const bool shown = shot.followed() && shot.event_count > 0, mapped = map && map->valid[p];
        held.shown += shown;
        held.lost += shown && !mapped;
        held.added += mapped && !shown;
        if (!shown || !mapped) continue;
        const std::optional<Vec2> place = target.pixel_of_direction(shot.direction);
        REQUIRE(place);
        held.worst = std::max(held.worst, length(*place - Vec2(map->x[p], map->y[p])));
    }
    return held;
}

}  // namespace

TEST_CASE("a view's map has exactly the pixels whose rays show the target, and their places",
          "[inverse][law]") {
    Draw draw(29);
    std::size_t none = 0, shown = 0, few = 0;
    for (int scene = 0; scene < 4; ++scene) {
        const auto world = world_of(three_balls(draw));
        for (const char* word : {"R", "RR", "RRR", "RTT", "TT", ""})
            for (std::size_t camera = 0; camera < kCameras; ++camera) {
                FilmMapRequest request;
                request.target = {TargetKind::kEquirect, 512, 256};
                if (scene % 2) request.target = {TargetKind::kCubemap, 768, 128};
                request.proxy.kind = ProxyKind::kInfinity;
                request.way = MapWay::kView;
                request.frame.camera = camera;
                if (*word) request.word = EventWord(word);
                const Held held = hold_against_rays(*world, request);
                INFO("scene " << scene << " word " << word << " camera " << camera << ": " << held.shown
                              << " pixels");
                CHECK(held.lost == 0);
                CHECK(held.added == 0);
                CHECK(held.worst < 1e-4);
                none += held.shown == 0;
                few += held.shown > 0 && held.shown < 60;
                shown += held.shown;
            }
    }
    // Some words are seen nowhere, others in regions smaller than a cell of the lattice.
    CHECK(none > 0);
    CHECK(few > 10);
    CHECK(shown > 40000);
}

TEST_CASE("a view's derivatives are those of its rays, in regions that are small, too", "[inverse][law]") {
    Draw draw(30);
    const auto world = world_of(three_balls(draw));
    for (const char* word : {"R", "RR", "RTT"}) {
        FilmMapRequest request;
        request.target = {TargetKind::kEquirect, 512, 256};
        request.proxy.kind = ProxyKind::kInfinity;
        request.way = MapWay::kView;
        request.word = EventWord(word);
        const FilmMap map = make_film_map(*world, request);
        const Target target(request.target, world->scene);
        std::size_t held = 0, wrong = 0;
        for (std::size_t p = 0; p < map.valid.size(); ++p) {
            if (!map.valid[p] || (map.jacobian[0][p] == 0 && map.jacobian[2][p] == 0)) continue;
            const Vec2 middle(double(p % 97) + 0.5, double(p / 97) + 0.5);
            const std::vector<Vec2> beside{middle - Vec2(1e-3, 0), middle + Vec2(1e-3, 0)};
            const ShotRays shots = shoot_places(*world, {request.frame.camera, request.word}, beside);
            if (!shots.rays[0].followed() || !shots.rays[1].followed()) continue;
            const auto before = target.pixel_of_direction(shots.rays[0].direction),
                       behind = target.pixel_of_direction(shots.rays[1].direction);
            const Vec2 slope = (*behind - *before) / 2e-3;
            if (std::fabs(behind->x - before->x) > 256) continue;  // across the seam
            ++held;
            wrong +=
                length(slope - Vec2(map.jacobian[0][p], map.jacobian[2][p])) > 0.02 * (1 + length(slope));
        }
        INFO(word << ": " << wrong << " of " << held);
        CHECK(held > 20);
        CHECK(double(wrong) < 0.02 * double(held));
    }
}
