// Images over several optics: what Newton's method settles is what exact rays say, where none is asked as
// well.
#include <algorithm>
#include <cmath>
#include <random>
#include <string>

#include "laws/worlds.h"
#include "render/frame/image_chain.h"
#include "render/project/project.h"
#include "scene/load.h"
#include "support/test.h"

using namespace trilens;
using namespace trilens_test;

namespace {

constexpr const char* kFront = R"({ "version": 1, "film": { "width": 48, "height": 36 },
  "cameras": [ { "name": "c", "type": "perspective", "yfov": 40,
                 "lookAt": { "eye": [0.2, 0.3, 4.5], "at": [0, 0, 0] } } ],
  "render": { "maxDepth": 2 },
  "materials": [ { "name": "glass", "transmissionFactor": 1, "ior": 1.52 },
                 { "name": "water", "transmissionFactor": 1, "ior": 1.335 },
                 { "name": "chrome", "metallicFactor": 1, "roughnessFactor": 0 } ],
  "meshes": [ )";

std::string optic_box(const char* name, const char* material, const Vec3& low, const Vec3& high,
                const char* more = "") {
    std::string points;
    for (const double z : {low.z, high.z})
        for (const Vec2& p :
             {Vec2(low.x, low.y), Vec2(high.x, low.y), Vec2(high.x, high.y), Vec2(low.x, high.y)})
            points += (points.empty() ? "[" : ",[") + std::to_string(p.x) + "," + std::to_string(p.y) + "," +
                      std::to_string(z) + "]";
    return std::string(R"({ "name": ")") + name + R"(", "role": "optic", "material": ")" + material +
           R"(", "points": [)" + points +
           R"(], "faceVertexCounts": [4,4,4,4,4,4], "subdivisionScheme": "bilinear", "resolution": 4,
             "faceVertexIndices": [0,3,2,1, 4,5,6,7, 0,1,5,4, 2,3,7,6, 0,4,7,3, 1,2,6,5])" +
           more + "}";
}

std::string optic_ball(const char* name, const char* material, const Vec3& c, double radius) {
    return std::string(R"({ "name": ")") + name + R"(", "role": "optic", "resolution": 8, "material": ")" +
           material + R"(", "primitive": { "type": "sphere", "center": [)" + std::to_string(c.x) + "," +
           std::to_string(c.y) + "," + std::to_string(c.z) + R"(], "radius": )" + std::to_string(radius) +
           "} }";
}

std::shared_ptr<const World> optics_world(const std::string& meshes) {
    return make_world(load_scene_text(kFront + meshes + "] }", SceneSource("test", ""), {}, {}), ignore);
}

/// A flat port; the same tilted, so that rays reflect totally in it; balls of glass and chrome; a chrome box
/// that hides part of what lies behind a window; a smooth body of glass.
std::vector<std::shared_ptr<const World>> worlds_of_several() {
    const std::string port = optic_box("port", "glass", {-2, -2, 3.2}, {2, 2, 3.5});
    return {
        optics_world(port + "," + optic_box("water", "water", {-30, -30, -30}, {30, 30, 3.2})),
        optics_world(optic_box("port", "glass", {-1, -0.8, -0.2}, {1, 0.8, 0.3},
                     R"(, "transform": { "rotate": [0.1, 0.55, 0.1, 0.8] })")),
        optics_world(optic_ball("clear", "glass", {0.7, -0.2, 0.5}, 0.7) + "," +
                     optic_ball("bright", "chrome", {-0.8, 0, -0.6}, 0.8)),
        optics_world(port + "," + optic_box("screen", "chrome", {-0.6, -0.5, 1}, {0.2, 0.4, 1.4})),
        optics_world(optic_box("pebble", "glass", {-1, -0.8, -1}, {1, 0.8, 0.6},
                     R"(, "creaseIndices": [4,5], "creaseLengths": [2], "creaseSharpnesses": [1.5])")),
    };
}

std::vector<Vec3> points_around(std::size_t count, unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> draw(-1, 1);
    std::vector<Vec3> points;
    for (std::size_t i = 0; i < count; ++i)
        points.emplace_back(2.2 * draw(random), 1.6 * draw(random), 4 * draw(random) - 1.5);
    return points;
}

}  // namespace

TEST_CASE("images over several optics lie where exact rays pass through their points", "[laws][law]") {
    std::size_t compared = 0, longest = 0;
    const std::vector<Vec3> points = points_around(40, 3);
    for (const auto& world : worlds_of_several()) {
        ProjectRequest request;
        const Frame frame = make_frame(*world, request.frame, {});
        const std::vector<PointProjection> found = project_points(*world, request, points);
        std::size_t in_world = 0;
        for (std::size_t p = 0; p < points.size(); ++p)
            for (const WorldImage& image : found[p].images) {
                if (image.steps.size() < 2 || image.events.empty()) continue;
                HistoryQuery query = history_query(*world, frame, image.steps, points[p]);
                const std::optional<HistoryImage> exact = history_image_at(query, image.pixel);
                CAPTURE(p, image.steps.size(), image.pixel.x, image.pixel.y);
                REQUIRE(exact);
                REQUIRE(exact->events.size() == image.events.size());
                for (std::size_t i = 0; i < image.events.size(); ++i) {
                    CHECK(exact->events[i].face == image.events[i].face);
                    CHECK(exact->events[i].front == image.events[i].front);
                    CHECK(length(exact->events[i].point - image.events[i].point) < 1e-9);
                }
                CHECK(length(exact->weight - image.weight) < 1e-9);
                CHECK(exact->distance == Approx(image.length).epsilon(1e-9));
                // What the ray misses the point by, in pixels.
                const double steep = std::hypot(length(image.derivative[0]), length(image.derivative[1]));
                CHECK(exact->residual * steep < 1e-8);
                longest = std::max(longest, image.steps.size());
                ++in_world;
            }
        CHECK(in_world > 2);
        compared += in_world;
    }
    INFO(compared << " images, of " << longest << " events at most");
    CHECK(compared > 200);
    CHECK(longest >= 3);
}

TEST_CASE("a point alone has the images that it has among others, whatever was asked before", "[laws][law]") {
    const std::vector<Vec3> points = points_around(16, 5);
    for (const auto& world : worlds_of_several()) {
        const std::vector<PointProjection> among = project_points(*world, {}, points);
        for (std::size_t p = 0; p < points.size(); p += 3) {
            const PointProjection alone = project_points(*world, {}, {&points[p], 1})[0];
            REQUIRE(alone.images.size() == among[p].images.size());
            for (std::size_t i = 0; i < alone.images.size(); ++i) {
                CHECK(alone.images[i].pixel == among[p].images[i].pixel);
                CHECK(alone.images[i].weight == among[p].images[i].weight);
            }
        }
    }
}

namespace {

/// Of the film places whose exact rays see something after these events, with no optic after them: how many
/// there are, and how many of what they see is not projected back to them.
std::pair<std::size_t, std::size_t> seen_and_missed(const World& world, const EventWord& word) {
    std::vector<Vec2> pixels;
    for (int y = 0; y < world.scene.film.height; ++y)
        for (int x = 0; x < world.scene.film.width; ++x) pixels.emplace_back(x + 0.37, y + 0.61);
    ShootRequest shoot;
    shoot.path = word;
    const ShotRays shot = shoot_places(world, shoot, pixels);
    std::vector<Vec3> points;
    std::vector<Vec2> places;
    for (std::size_t i = 0; i < shot.rays.size(); i += 3) {
        if (shot.rays[i].state != ShotState::kSeen || shot.rays[i].cut) continue;
        points.push_back(shot.rays[i].position);
        places.push_back(pixels[i]);
    }
    ProjectRequest request;
    request.path = word;
    request.visibility = false;
    const std::vector<PointProjection> found = project_points(world, request, points);
    std::size_t missed = 0;
    for (std::size_t i = 0; i < found.size(); ++i)
        missed += std::none_of(found[i].images.begin(), found[i].images.end(), [&](const WorldImage& image) {
            return length(image.pixel - places[i]) < 1e-4;
        });
    return {points.size(), missed};
}

}  // namespace

TEST_CASE("what exact rays see over two reflections in a torus is projected back to them", "[laws][law]") {
    const auto [seen, missed] = seen_and_missed(*shipped_world("torus", 12, 120, 90), EventWord("RR"));
    INFO(missed << " of " << seen << " missed");
    CHECK(seen > 50);
    CHECK(missed * 40 <= seen);
}

TEST_CASE("a spout before the body of a teapot shows the floor over two reflections", "[laws][law]") {
    const std::unique_ptr<World> world = shipped_world("patches/teapot", 8, 160, 120);
    const Vec3 point(-2.25151595372, 0, -2.03585214571);  // what the exact ray of this place sees
    ProjectRequest request;
    request.path = EventWord("RR");
    const PointProjection found = project_points(*world, request, {&point, 1})[0];
    CHECK(std::any_of(found.images.begin(), found.images.end(), [](const WorldImage& image) {
        return length(image.pixel - Vec2(36.5, 46.5)) < 1e-4 && image.visible;
    }));
    CHECK_FALSE(found.complete);
}

TEST_CASE("a path of no event is what is seen directly", "[laws][law]") {
    const auto world = worlds_of_several()[2];
    const std::vector<Vec3> points = points_around(20, 7);
    ProjectRequest all, direct;
    direct.path = EventWord("D");
    const std::vector<PointProjection> every = project_points(*world, all, points);
    const std::vector<PointProjection> seen = project_points(*world, direct, points);
    std::size_t compared = 0;
    for (std::size_t p = 0; p < points.size(); ++p) {
        std::vector<Vec2> expected, had;
        for (const WorldImage& image : every[p].images)
            if (image.path == Path::kDirect) expected.push_back(image.pixel);
        for (const WorldImage& image : seen[p].images) had.push_back(image.pixel);
        CHECK(had == expected);
        CHECK(seen[p].complete);
        compared += expected.size();
    }
    CHECK(compared > 10);
    CHECK_THROWS_AS(EventWord("DR"), UsageError);
}
