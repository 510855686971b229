// Images through cameras of every kind, with and without one eye: each is what the camera's exact ray shows,
// what rays show is found, known images are followed, and they move with the scene as differences say.
#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <vector>

#include "laws/worlds.h"
#include "render/frame/camera_rays.h"
#include "render/picture/picture.h"
#include "render/project/project.h"
#include "render/shoot/shoot.h"
#include "render/world/world.h"
#include "scene/parameters.h"
#include "support/draw.h"
#include "support/test.h"

using namespace trilens;
using namespace trilens_test;

namespace {

const std::string kFilmLook = R"("lookAt": { "eye": [0.5, 1.5, 4], "at": [0.1, 0.9, 0], "up": [0.1, 1, 0] })";

/// By kind: a camera that looks at the ball.
const std::map<std::string, std::string>& film_cameras() {
    static const std::map<std::string, std::string> kCameras{
        {"perspective", R"("yfov": 45, )" + kFilmLook},
        {"orthographic", R"("ymag": 1.5, )" + kFilmLook},
        {"fisheye", R"("fov": 70, )" + kFilmLook},
        {"cylindrical", R"("hfov": 80, "yfov": 60, )" + kFilmLook},
        {"distortion", R"("detail": [0.25, 0.3, 0.7, 0.8], "yfov": 20, "contextFov": 120, )" + kFilmLook},
        {"pushbroom", R"("travel": [2, 0.3, 0.4], "yfov": 45, )" + kFilmLook},
        {"crossedSlits",
         R"("slits": [[[0.3, 1.2, 4], [0, 1, 0.1]], [[0.2, 1.4, 7], [1, 0, 0]]], "window": [-1.5, 1.5, -1.1, 1.1], )" +
             kFilmLook},
        {"generalLinear", R"("rays": [
           { "screen": [0, 0], "point": [-1, 2, 4], "direction": [-0.1, 0.1, -1] },
           { "screen": [1, 0], "point": [1, 2, 4.2], "direction": [0.3, 0.2, -1] },
           { "screen": [0, 1], "point": [-1, 0, 4], "direction": [0.1, 0.3, -1.2] }], )" +
                              kFilmLook},
        {"planarContext",
         R"("yfov": 40, "ground": [[0, -1, 0], [0, 1, 0]], "bend": 5, "angle": 60, )" + kFilmLook},
        {"multiPerspective", R"("blend": 0.1, "views": [
           { "window": [0, 0, 0.5, 1], "yfov": 40, "lookAt": { "eye": [0.5, 1.5, 4], "at": [0.1, 0.9, 0] } },
           { "window": [0.5, 0, 1, 1], "yfov": 50, "lookAt": { "eye": [2, 1.5, 4], "at": [0.1, 1, 0] } }])"},
        {"inwardSphere", R"("center": [0.5, 1.2, 0.4], "radius": 3, )" + kFilmLook},
        {"rayMesh", R"("points": [[-1, 2, 4], [1, 2.2, 4], [-1, 0, 4], [1, 0, 4.3]],
           "directions": [[0.1, -0.2, -1], [-0.3, -0.2, -2], [0.2, 0.1, -1], [-0.1, 0.2, -1.5]],
           "screen": [[0, 0], [1, 0], [0, 1], [1, 1]], "triangles": [[0, 2, 1], [1, 2, 3]])"}};
    return kCameras;
}

/// Cameras whose rays start in no one eye and are not parallel.
const std::vector<std::string>& eyeless_cameras() {
    static const std::vector<std::string> kEyeless{"pushbroom",     "crossedSlits",     "generalLinear",
                                                   "planarContext", "multiPerspective", "inwardSphere",
                                                   "rayMesh"};
    return kEyeless;
}

/// A mirror ball in a box before one camera; or a glass ball.
std::unique_ptr<World> ball_before(const std::string& kind, const std::string& radius = "0.9",
                                   const std::string& material = R"("metallicFactor": 1)") {
    return world_from(kind,
                      R"({ "version": 1, "film": { "width": 61, "height": 47 }, "render": { "maxDepth": 0 },
      "cameras": [{ "name": "c", "type": ")" +
                          kind + "\", " + film_cameras().at(kind) + R"( }],
      "materials": [{ "name": "optic", )" +
                          material + R"( }, { "name": "red", "baseColorFactor": [0.7, 0.1, 0.1] }],
      "meshes": [{ "name": "ball", "role": "optic", "material": "optic",
                   "primitive": { "type": "sphere", "center": [0.2, 1, -0.1], "radius": )" +
                          radius + R"( } },
        { "name": "box", "role": "object", "material": "red",
          "points": [[-6,-5,-6],[6,-5,-6],[6,7,-6],[-6,7,-6],[-6,-5,8],[6,-5,8],[6,7,8],[-6,7,8]],
          "faceVertexCounts": [4,4,4,4,4,4],
          "faceVertexIndices": [0,1,2,3, 5,4,7,6, 4,0,3,7, 1,5,6,2, 4,5,1,0, 3,2,6,7] }],
      "lights": [{ "type": "ambient", "color": [1, 1, 1] }] })",
                      16);
}

/// How far the last ray of a film place passes from a point ahead of it; infinite where it has another path.
double passes_at(const World& world, const std::string& word, const Vec2& pixel, const Vec3& point) {
    ShootRequest request;
    request.path = EventWord(word);
    const ShotRay ray = shoot_places(world, request, {&pixel, 1}).rays[0];
    const double along = dot(point - ray.origin, ray.direction);
    if (!ray.followed() || !(along > 0)) return INFINITY;
    return length(point - ray.origin - along * ray.direction);
}

/// Places well inside the film over the ball, and what they show.
struct ShownOverBall {
    std::vector<Vec2> pixels;
    std::vector<Vec3> points;
};

ShownOverBall shown_over_ball(const World& world, const std::string& word, std::size_t tries) {
    Draw draw(tries);
    std::vector<Vec2> pixels;
    for (std::size_t i = 0; i < tries; ++i) {
        const double x = draw.uniform(2, 59);
        pixels.emplace_back(x, draw.uniform(2, 45));
    }
    ShootRequest request;
    request.path = EventWord(word);
    const ShotRays shot = shoot_places(world, request, pixels);
    ShownOverBall shown;
    for (std::size_t i = 0; i < tries; ++i) {
        if (shot.rays[i].state != ShotState::kSeen) continue;
        shown.pixels.push_back(pixels[i]);
        shown.points.push_back(shot.rays[i].position);
    }
    return shown;
}

ProjectRequest reflected_in_ball() {
    ProjectRequest request;
    request.path = EventWord("R");
    return request;
}

const WorldImage* image_at(const PointProjection& found, const Vec2& pixel, double within) {
    for (const WorldImage& image : found.images)
        if (length(image.pixel - pixel) < within) return &image;
    return nullptr;
}

}  // namespace

TEST_CASE("the exact ray of every visible image comes to its point, whatever the camera", "[laws][law]") {
    for (const auto& [kind, text] : film_cameras())
        for (const ImageSearch search : {ImageSearch::kComplete, ImageSearch::kFacets}) {
            CAPTURE(kind, static_cast<int>(search));
            const auto world = ball_before(kind);
            Draw draw(5);
            std::vector<Vec3> points;
            for (int i = 0; i < 200; ++i) {
                const double x = draw.uniform(-3, 3), y = draw.uniform(-1, 3);
                points.emplace_back(x, y, draw.uniform(-3, 6));
            }
            ProjectRequest request = reflected_in_ball();
            request.search = search;
            const std::vector<PointProjection> found = project_points(*world, request, points);
            std::size_t visible = 0;
            for (std::size_t i = 0; i < points.size(); ++i)
                for (const WorldImage& image : found[i].images) {
                    if (!image.visible) continue;
                    ++visible;
                    CAPTURE(i, image.pixel.x, image.pixel.y, image.refined);
                    CHECK(passes_at(*world, "R", image.pixel, points[i]) < 1e-6);
                }
            CHECK(visible > 20);
        }
}

TEST_CASE("what a ray shows over a ball is projected to that ray's place, or not called complete",
          "[laws][law]") {
    for (const auto& [kind, text] : film_cameras()) {
        CAPTURE(kind);
        const auto world = ball_before(kind);
        const ShownOverBall shown = shown_over_ball(*world, "R", 400);
        REQUIRE(shown.points.size() > 10);
        const std::vector<PointProjection> found = project_points(*world, reflected_in_ball(), shown.points);
        std::size_t missed = 0;
        for (std::size_t i = 0; i < found.size(); ++i) {
            if (!image_at(found[i], shown.pixels[i], 1e-6)) ++missed;
        }
        CHECK(missed <= (kind == "inwardSphere" ? shown.points.size() / 50 : 0));  // by its fold
        const bool has_eye =
            std::find(eyeless_cameras().begin(), eyeless_cameras().end(), kind) == eyeless_cameras().end();
        CHECK(std::all_of(found.begin(), found.end(),
                          [&](const PointProjection& one) { return one.complete == has_eye; }));
    }
}

TEST_CASE("a direction is seen where the last ray goes its way, through cameras without one eye",
          "[laws][law]") {
    for (const std::string& kind : eyeless_cameras()) {
        CAPTURE(kind);
        const auto world = ball_before(kind);
        Draw draw(11);
        std::vector<Vec3> directions;
        for (int i = 0; i < 40; ++i) directions.push_back(normalize(draw.unit()));
        const std::vector<PointProjection> found =
            project_directions(*world, reflected_in_ball(), directions);
        std::size_t inside = 0;
        for (std::size_t i = 0; i < directions.size(); ++i)
            for (const WorldImage& image : found[i].images) {
                if (!image.inside) continue;
                ++inside;
                ShootRequest request;
                request.path = EventWord("R");
                const ShotRay ray = shoot_places(*world, request, {&image.pixel, 1}).rays[0];
                CHECK(image.refined);
                CHECK(length(ray.direction - directions[i]) < 1e-7);
            }
        CHECK(inside > 3);
    }
}

TEST_CASE("known images stay in an unchanged scene and follow a changed one, whatever the camera",
          "[laws][law]") {
    for (const auto& [kind, text] : film_cameras()) {
        CAPTURE(kind);
        const auto world = ball_before(kind), grown = ball_before(kind, "0.901");
        const ShownOverBall shown = shown_over_ball(*world, "R", 120);
        std::vector<ImageStart> starts;
        std::vector<const WorldImage*> images;
        const std::vector<PointProjection> found = project_points(*world, reflected_in_ball(), shown.points),
                                           after = project_points(*grown, reflected_in_ball(), shown.points);
        for (std::size_t i = 0; i < found.size(); ++i)
            for (const WorldImage& image : found[i].images) {
                if (!image.inside) continue;
                starts.push_back({i, image.events, image.pixel});
                images.push_back(&image);
            }
        const auto still = refine_images(*world, reflected_in_ball(), shown.points, starts),
                   moved = refine_images(*grown, reflected_in_ball(), shown.points, starts);
        std::size_t followed = 0;
        for (std::size_t k = 0; k < starts.size(); ++k) {
            CAPTURE(k, images[k]->pixel.x, images[k]->pixel.y);
            REQUIRE(still[k]);
            CHECK(length(still[k]->pixel - images[k]->pixel) < 1e-9);
            CHECK(length(still[k]->weight - images[k]->weight) < 1e-9);
            CHECK(still[k]->length == Approx(images[k]->length).epsilon(1e-9));
            CHECK(still[k]->visible == images[k]->visible);
            if (moved[k] && image_at(after[starts[k].point], moved[k]->pixel, 1e-7)) ++followed;
        }
        CHECK(starts.size() > 10);
        CHECK(followed + 3 >= starts.size());  // one may grow beyond the film's edge, or come to graze
    }
}

TEST_CASE("images through cameras without one eye move with the scene as differences say", "[laws][law]") {
    struct Case {
        std::string word, material;
    };
    for (const std::string& kind : eyeless_cameras())
        for (const Case& one :
             {Case{"R", R"("metallicFactor": 1)"}, Case{"TT", R"("transmissionFactor": 1, "ior": 1.4)"}}) {
            CAPTURE(kind, one.word);
            const auto world = ball_before(kind, "0.9", one.material);
            const ShownOverBall shown = shown_over_ball(*world, one.word, 60);
            ProjectRequest request;
            request.path = EventWord(one.word);
            request.visibility = false;
            request.parameters = {"/meshes/ball/primitive/radius", "/meshes/ball/primitive/center/0",
                                  "/materials/optic/ior"};
            if (one.word == "R") request.parameters.pop_back();
            const bool has_eye = kind == "pushbroom" || kind == "planarContext";
            if (has_eye) request.parameters.push_back("/cameras/0/lookAt/eye/1");
            const std::vector<PointProjection> found = project_points(*world, request, shown.points);
            std::vector<ImageStart> starts;
            std::vector<const WorldImage*> images;
            for (std::size_t i = 0; i < found.size(); ++i)
                for (const WorldImage& image : found[i].images) {
                    if (!image.inside) continue;
                    starts.push_back({i, image.events, image.pixel});
                    images.push_back(&image);
                }
            std::size_t compared = 0;
            for (std::size_t p = 0; p < request.parameters.size(); ++p) {
                CAPTURE(request.parameters[p]);
                const double h = 1e-5;
                SceneNumber number = find_numbers(world->scene, {&request.parameters[p], 1})[0];
                const double value = number.value;
                std::array<std::vector<std::optional<WorldImage>>, 2> moved;
                for (const int side : {0, 1}) {
                    number.value = value + (2 * side - 1) * h;
                    ProjectRequest plain = request;
                    plain.parameters.clear();
                    const auto stepped = make_world(scene_with(world->scene, number), {});
                    moved[static_cast<std::size_t>(side)] =
                        refine_images(*stepped, plain, shown.points, starts);
                }
                for (std::size_t k = 0; k < starts.size(); ++k) {
                    REQUIRE(images[k]->by_parameter.size() == request.parameters.size());
                    if (!moved[0][k] || !moved[1][k]) continue;
                    const Vec2 differences = (moved[1][k]->pixel - moved[0][k]->pixel) / (2 * h);
                    if (length(differences) > 1e3) continue;  // about to graze: bends within the step
                    ++compared;
                    CAPTURE(images[k]->pixel.x, images[k]->pixel.y, images[k]->by_parameter[p].x,
                            images[k]->by_parameter[p].y, differences.x, differences.y);
                    CHECK(length(images[k]->by_parameter[p] - differences) <
                          2e-3 * (1 + length(differences)));
                }
            }
            CHECK(compared > 15);
        }
}

TEST_CASE("Z of a mesh of rays is in scene units, whatever the length of its directions", "[laws][law]") {
    const auto world = ball_before("rayMesh");
    for (const Engine engine : {Engine::kExact, Engine::kLimitTruth}) {
        PictureRequest request;
        request.engine.engine = engine;
        request.layers.layers = {"Z"};
        const Image picture = draw_picture(*world, request, {}, ignore).image;
        const std::vector<float>& depth = picture.find("Z")->floats();
        std::vector<Vec2> pixels;
        for (int y = 0; y < 47; ++y)
            for (int x = 0; x < 61; ++x) pixels.emplace_back(x + 0.5, y + 0.5);
        const ShotRays shot = shoot_places(*world, {}, pixels);
        const CameraRays camera = make_camera_rays(world->scene, 0);
        std::size_t far = 0;
        for (std::size_t p = 0; p < pixels.size(); ++p) {
            const ShotRay& ray = shot.rays[p];
            const Vec3 first = ray.event_count > 0 ? shot.events_of(ray)[0].point : ray.position;
            if (std::fabs(depth[p] - length(first - exact_ray(camera, pixels[p])->origin)) > 0.1) ++far;
        }
        CHECK(far < pixels.size() / 50);  // at the ball's rim, of facets
    }
}
