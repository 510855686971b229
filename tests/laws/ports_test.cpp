// Points behind ports, plates and shells are seen where exact rays say, once, and Newton's method in all
// parameters has them there too.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "json/json.h"
#include "laws/worlds.h"
#include "render/project/project.h"
#include "render/shoot/shoot.h"
#include "scene/imports/housing.h"
#include "scene/load.h"
#include "support/draw.h"
#include "support/test.h"

using namespace trilens;
using namespace trilens_test;

namespace {

std::string numbers_text(const std::vector<double>& numbers) {
    std::string text;
    for (const double number : numbers) text += fmt::format("{}{:.17g}", text.empty() ? "" : " ", number);
    return text;
}

std::unique_ptr<World> housing_world(const std::string& line) {
    const Json json = scene_of_housing("1 " + line + "\n", "cameras.txt");
    return make_world(load_scene_text(json.dump(), SceneSource("cameras.txt"), {}, {}), {});
}

std::unique_ptr<World> flat_port_world(Draw& draw) {
    Vec3 normal(draw.uniform(-0.3, 0.3), draw.uniform(-0.3, 0.3), 1);
    normal = normalize(normal);
    return housing_world(
        "SIMPLE_PINHOLE 320 240 " + numbers_text({draw.uniform(150, 400), 160, 120}) + " FLATPORT " +
        numbers_text({normal.x, normal.y, normal.z, draw.log_uniform(0.005, 0.2),
                      draw.log_uniform(0.002, 0.05), 1, draw.uniform(1.4, 1.6), draw.uniform(1.3, 1.36)}));
}

std::unique_ptr<World> dome_port_world(Draw& draw) {
    const double radius = draw.log_uniform(0.02, 0.3), off = draw.uniform(0, 0.2);
    return housing_world(
        "SIMPLE_PINHOLE 320 240 " + numbers_text({draw.uniform(150, 400), 160, 120}) + " DOMEPORT " +
        numbers_text({radius * off * draw.uniform(-1, 1), radius * off * draw.uniform(-1, 1),
                      radius * off * draw.uniform(-1, 1), radius, radius * draw.log_uniform(0.01, 0.3), 1,
                      draw.uniform(1.4, 1.6), draw.uniform(1.3, 1.36)}));
}

/// Points on the last rays of places of the film, and what the places are.
struct SeenPoints {
    std::vector<Vec2> pixels;
    std::vector<Vec3> points;
    std::vector<std::vector<PathEvent>> events;
};

SeenPoints seen_through(const World& world, Draw& draw, std::size_t count, double nearest) {
    std::vector<Vec2> pixels;
    for (std::size_t i = 0; i < count; ++i)
        pixels.emplace_back(draw.uniform(0.2, world.scene.film.width - 0.2),
                            draw.uniform(0.2, world.scene.film.height - 0.2));
    ShootRequest request;
    request.path = EventWord("TT");
    const ShotRays shot = shoot_places(world, request, pixels);
    SeenPoints seen;
    for (std::size_t i = 0; i < count; ++i) {
        const ShotRay& ray = shot.rays[i];
        if (!ray.followed() || ray.cut) continue;
        seen.pixels.push_back(pixels[i]);
        seen.points.push_back(ray.origin + draw.log_uniform(nearest, 10) * ray.direction);
        const auto events = shot.events_of(ray);
        seen.events.emplace_back(events.begin(), events.end());
    }
    return seen;
}

/// What exact rays, Newton's method from the images, and differences say of the images of points.
void check_seen(const World& world, const SeenPoints& seen, bool is_one) {
    ProjectRequest request;
    request.path = EventWord("TT");
    request.visibility = false;
    const std::vector<PointProjection> found = project_points(world, request, seen.points);
    std::vector<ImageStart> starts;
    std::vector<const WorldImage*> images;
    for (std::size_t i = 0; i < found.size(); ++i) {
        CAPTURE(i, seen.pixels[i].x, seen.pixels[i].y);
        const auto nearest = std::min_element(
            found[i].images.begin(), found[i].images.end(), [&](const WorldImage& a, const WorldImage& b) {
                return length(a.pixel - seen.pixels[i]) < length(b.pixel - seen.pixels[i]);
            });
        REQUIRE(nearest != found[i].images.end());
        if (is_one) CHECK(found[i].images.size() == 1);
        CHECK(length(nearest->pixel - seen.pixels[i]) < 1e-8);
        CHECK(nearest->inside);
        REQUIRE(nearest->events.size() == seen.events[i].size());
        for (std::size_t k = 0; k < nearest->events.size(); ++k) {
            const PathEvent &mine = nearest->events[k], &exact = seen.events[i][k];
            CHECK(mine.optic == exact.optic);
            CHECK(mine.event == exact.event);
            CHECK(mine.front == exact.front);
            CHECK(mine.face == exact.face);
            CHECK(length(mine.uv - exact.uv) < 1e-8);
            CHECK(length(mine.point - exact.point) < 1e-9);
            CHECK(length(mine.normal - exact.normal) < 1e-9);
        }
        for (const WorldImage& image : found[i].images) {
            starts.push_back({i, image.events});
            images.push_back(&image);
        }
    }
    request.derivatives = true;
    const auto refined = refine_images(world, request, seen.points, starts);
    std::size_t agreed = 0;
    for (std::size_t i = 0; i < images.size(); ++i) {
        if (!refined[i]) continue;  // planes that touch have no way between them that could be derived
        ++agreed;
        const WorldImage &mine = *images[i], &newton = *refined[i];
        CHECK(length(mine.pixel - newton.pixel) < 1e-9);
        CHECK(mine.weight.y == Approx(newton.weight.y).epsilon(1e-9));
        CHECK(mine.length == Approx(newton.length).epsilon(1e-11));
        CHECK(mine.has_derivative);
        for (std::size_t axis = 0; axis < 2; ++axis)
            CHECK(length(mine.derivative[axis] - newton.derivative[axis]) <
                  1e-7 * length(newton.derivative[axis]));
    }
    CHECK(2 * agreed > images.size());
}

}  // namespace

TEST_CASE("behind flat and dome ports each point is seen once, where its exact ray and Newton's method say",
          "[laws][project][law]") {
    Draw draw(21);
    for (int round = 0; round < 12; ++round) {
        CAPTURE(round);
        const auto flat = flat_port_world(draw);
        check_seen(*flat, seen_through(*flat, draw, 60, 1e-4), true);
        const auto dome = dome_port_world(draw);
        check_seen(*dome, seen_through(*dome, draw, 60, 1e-3), true);
    }
}

TEST_CASE("no point before a port, in its glass or behind the camera is seen through it", "[laws][project]") {
    Draw draw(22);
    ProjectRequest request;
    request.path = EventWord("TT");
    for (const bool is_dome : {false, true}) {
        const auto world = is_dome ? dome_port_world(draw) : flat_port_world(draw);
        const SeenPoints seen = seen_through(*world, draw, 60, 1e-3);
        std::vector<Vec3> hidden;
        for (const std::vector<PathEvent>& events : seen.events) {
            const Vec3 &first = events.front().point, &last = events.back().point;
            hidden.push_back(draw.uniform(0.05, 0.95) * first);  // before it: the eye is at 0
            hidden.push_back(first + draw.uniform(0.05, 0.95) * (last - first));  // in the glass
            if (!is_dome) hidden.push_back(-draw.log_uniform(1e-3, 10) * last);
        }
        for (const PointProjection& found : project_points(*world, request, hidden))
            CHECK(found.images.empty());
    }
}

TEST_CASE("through a window of a few rims a point is seen wherever exact rays show it",
          "[laws][project][law]") {
    // A slab whose sides are seen too, before a tank that it touches or not.
    const auto box = [](const std::string& name, const std::string& material, const Vec3& low,
                        const Vec3& high) {
        std::string points;
        for (int i = 0; i < 8; ++i)
            points += fmt::format("{}[{:.17g},{:.17g},{:.17g}]", i ? "," : "", i & 1 ? high.x : low.x,
                                  i & 2 ? high.y : low.y, i & 4 ? high.z : low.z);
        return R"({"name":")" + name + R"(","role":"optic","material":")" + material +
               R"(","subdivisionScheme":"bilinear","resolution":4,"points":[)" + points +
               R"(],"faceVertexCounts":[4,4,4,4,4,4],"faceVertexIndices":[4,5,7,6, 1,0,2,3, 5,1,3,7, 0,4,6,2, 6,7,3,2, 0,1,5,4]})";
    };
    Draw draw(23);
    std::size_t seen_points = 0;
    for (const double gap : {0.0, 0.05}) {
        const std::string json =
            R"({"version":1,"film":{"width":160,"height":120},"cameras":[{"name":"main","yfov":60,"lookAt":{"eye":[0.1,0.2,1.6],"at":[0,0,0],"up":[0,1,0]}}],
                "materials":[{"name":"glass","transmissionFactor":1,"ior":1.5},{"name":"water","transmissionFactor":1,"ior":1.33}],"meshes":[)" +
            box("slab", "glass", {-0.5, -0.4, 0.8}, {0.5, 0.4, 1}) + "," +
            box("tank", "water", {-4, -4, -4}, {4, 4, 0.8 - gap}) + R"(],"render":{"maxDepth":2}})";
        const auto world = world_from("window", json, 4);
        const SeenPoints seen = seen_through(*world, draw, 600, 1e-2);
        seen_points += seen.points.size();
        check_seen(*world, seen, false);
    }
    CHECK(seen_points > 100);
}
