// Caustics on what is no plane: the light that comes to an object is all in its map, however few pixels that
// has, and in its picture, however few pixels that has.
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "base/util/format.h"
#include "inverse/maps/caustic_map.h"
#include "laws/pictures.h"
#include "support/lit_world.h"
#include "support/test.h"

using namespace trilens;
using namespace trilens_test;

namespace {

/// A square of 4 x 4 over which the height is of (x, z), in `side` x `side` squares of two triangles each.
ObjectMesh relief(int side, const std::function<double(double, double)>& height) {
    ObjectMesh object;
    const auto at = [&](int i) { return 4.0 * i / side - 2; };
    for (int row = 0; row <= side; ++row)
        for (int column = 0; column <= side; ++column)
            object.points.push_back({at(column), height(at(column), at(row)), at(row)});
    const auto triangle = [&](const std::array<Id, 3>& corner) {
        object.triangles.push_back({corner[0], corner[1], corner[2]});
        std::array<Vec2, 3> uv;
        for (std::size_t k = 0; k < 3; ++k) {
            const Vec3& point = object.points[corner[k]];
            uv[k] = {(point.x + 2) / 4, (2 - point.z) / 4};
        }
        object.uvs.push_back(uv);
        object.material.push_back(0);
    };
    for (Id row = 0; row < static_cast<Id>(side); ++row)
        for (Id column = 0; column < static_cast<Id>(side); ++column) {
            const Id a = row * static_cast<Id>(side + 1) + column, c = a + static_cast<Id>(side + 1);
            triangle({a, c, c + 1});
            triangle({a, c + 1, a + 1});
        }
    return object;
}

struct Relief {
    std::string name;
    ObjectMesh object;
};

std::vector<Relief> reliefs() {
    const auto bumps = [](double x, double z) { return 0.09 * std::sin(5 * x + 1) * std::cos(6 * z); };
    return {{"roof", relief(2, [](double x, double) { return x == 0 ? 0.05 : 0; })},
            {"valley", relief(2, [](double x, double) { return x == 0 ? -0.3 : 0; })},
            {"bumps", relief(24, bumps)},
            {"fine bumps", relief(50, bumps)}};
}

std::unique_ptr<World> lit_relief(const ObjectMesh& object) {
    Scene scene = lit_world(R"({"name": "ball", "role": "optic", "material": "glass", "resolution": 8,
        "primitive": {"type": "sphere", "center": [0, 1.1, 0], "radius": 0.8}})",
                            R"({"type": "spot", "position": [0.6, 4, 0.4], "direction": [-0.15, -0.8, -0.1],
        "outerConeAngle": 14, "intensity": 20, "caustics": true})",
                            {-3, 1.8, 1.5})
                      ->scene;
    scene.meshes[0].object = object;
    return make_world(scene, ignore);
}

Vec3 mean_light(const Image& image) {
    Vec3 sum(0);
    for (int k = 0; k < 3; ++k)
        for (const float value : image.find(std::string(1, "RGB"[k]))->floats()) sum[k] += value;
    return sum / static_cast<double>(image.width * image.height);
}

}  // namespace

TEST_CASE("what ends on an object is in its map, whatever its planes and the map's pixels",
          "[laws][law][caustics]") {
    for (const Relief& one : reliefs()) {
        const auto world = lit_relief(one.object);
        for (const auto& [width, height] : {std::pair(1, 1), {2, 3}, {17, 17}})
            for (const bool exact : {false, true}) {
                if (exact && (width != 17 || one.name != "valley")) continue;
                CausticMapRequest request;
                request.target.kind = TargetKind::kObject;
                request.target.object = 0;
                request.target.width = width, request.target.height = height;
                request.exact = exact;
                const CausticMap map = make_caustic_map(*world, request);
                INFO(one.name << ", " << width << " x " << height << (exact ? ", exact: " : ": ")
                              << map.flux_received.y << " of " << map.flux_on_objects.y);
                REQUIRE(map.flux_on_objects.y > 0.1);
                CHECK(map.flux_received.y == Approx(map.flux_on_objects.y).epsilon(2e-3));
            }
    }
}

TEST_CASE("a map has the light of its object's front, however the texture coordinates are turned over",
          "[laws][law][caustics]") {
    const ObjectMesh plain = reliefs()[0].object;
    ObjectMesh mirrored = plain, half = plain;
    for (std::size_t t = 0; t < plain.uvs.size(); ++t) {
        const bool is_left = plain.points[plain.triangles[t][0]].x + plain.points[plain.triangles[t][1]].x +
                                 plain.points[plain.triangles[t][2]].x <
                             0;
        for (std::size_t k = 0; k < 3; ++k) {
            mirrored.uvs[t][k].x = 1 - plain.uvs[t][k].x;
            if (is_left) half.uvs[t][k].x = 0.5 - plain.uvs[t][k].x;
        }
    }
    const auto map_of = [&](const ObjectMesh& object, bool back) {
        CausticMapRequest request;
        request.target.kind = TargetKind::kObject;
        request.target.object = 0;
        request.target.width = 16, request.target.height = 8;
        request.back = back;
        return make_caustic_map(*lit_relief(object), request);
    };
    const CausticMap of_plain = map_of(plain, false), of_mirrored = map_of(mirrored, false),
                     of_half = map_of(half, false);
    REQUIRE(of_plain.flux_received.y > 1);
    for (std::size_t y = 0; y < 8; ++y)
        for (std::size_t x = 0; x < 16; ++x) {
            const double light = of_plain.irradiance[16 * y + x].y;
            CHECK(of_mirrored.irradiance[16 * y + 15 - x].y ==
                  Approx(light).margin(1e-6 * of_plain.flux_received.y));
            CHECK(of_half.irradiance[16 * y + (x < 8 ? 7 - x : x)].y ==
                  Approx(light).margin(1e-6 * of_plain.flux_received.y));
        }
    for (const ObjectMesh& one : {plain, mirrored, half}) CHECK(map_of(one, true).flux_received.y == 0);
}

TEST_CASE("what ends on an object smaller than a beam is what its map receives", "[laws][law][caustics]") {
    for (const double half : {0.001, 0.006, 0.03, 0.12}) {
        ObjectMesh card = relief(1, [](double, double) { return 0; });
        for (Vec3& point : card.points) point = 0.5 * half * point + Vec3(-0.2, 0, -0.14);
        const auto world = lit_relief(card);
        CausticMapRequest request;
        request.target.kind = TargetKind::kObject;
        request.target.object = 0;
        request.target.width = request.target.height = 5;
        const CausticMap map = make_caustic_map(*world, request);
        INFO(half << ": " << map.flux_received.y << " of " << map.flux_on_objects.y);
        REQUIRE(map.flux_received.y > 0);
        CHECK(map.flux_on_objects.y == Approx(map.flux_received.y).epsilon(0.02));
        CHECK(map.flux_on_objects.y + map.flux_away.y == Approx(map.flux_in.y).epsilon(0.01));
    }
}

TEST_CASE("light through a ball on a relief is as bright in a picture of few pixels as in one of many",
          "[laws][law][caustics]") {
    for (const Relief& one : reliefs()) {
        const auto mean = [&](int width, Engine engine) {
            Scene scene = lit_relief(one.object)->scene;
            scene.film = {width, width * 3 / 4, 1};
            return mean_light(drawn_by(*make_world(scene, ignore), 1, engine)).y;
        };
        const double many = mean(120, Engine::kExact), few = mean(40, Engine::kExact),
                     traced = mean(40, Engine::kLimitTruth);
        INFO(one.name << ": " << many << ", of few pixels " << few << ", traced " << traced);
        REQUIRE(many > 0);
        CHECK(few == Approx(many).epsilon(0.07));
        CHECK(traced == Approx(many).epsilon(0.07));
    }
}
