// Optics before explicit RayMeshes, and cameras among mirrors: an explicit mesh of a perspective's rays shows
// what the perspective shows, engines agree, and the picture comes to the exact surface's.
#include <algorithm>
#include <cmath>
#include <sstream>
#include <string>
#include <tuple>

#include "camera/camera.h"
#include "laws/worlds.h"
#include "measure/displacement/displacement.h"
#include "render/engines/engine.h"
#include "render/picture/picture.h"
#include "render/project/project.h"
#include "support/test.h"

using namespace trilens;
using namespace trilens_test;

namespace {

constexpr int kOpticsWidth = 96, kOpticsHeight = 72;

/// A ball of that material before a coloured wall and a floor, seen by `camera`.
std::string ball_scene(const std::string& camera, const std::string& material, int depth) {
    return R"({ "version": 1, "film": { "width": 96, "height": 72 }, "cameras": [)" + camera + R"(],
      "materials": [ { "name": "mirror", "metallicFactor": 1 }, { "name": "glass", "transmissionFactor": 1, "ior": 1.5 },
                     { "name": "red", "baseColorFactor": [0.8, 0.1, 0.1] }, { "name": "grey", "baseColorFactor": [0.5, 0.5, 0.6] } ],
      "meshes": [ { "name": "ball", "role": "optic", "material": ")" +
           material +
           R"(", "resolution": 24, "primitive": { "type": "sphere", "center": [0, 0, 0], "radius": 1 } },
        { "name": "wall", "role": "object", "material": "red", "points": [[-4,-2,-4],[4,-2,-4],[4,4,-4],[-4,4,-4]], "faceVertexCounts": [4], "faceVertexIndices": [0,1,2,3] },
        { "name": "floor", "role": "object", "material": "grey", "points": [[-4,-1.5,6],[4,-1.5,6],[4,-1.5,-4],[-4,-1.5,-4]], "faceVertexCounts": [4], "faceVertexIndices": [0,1,2,3] },
        { "name": "side", "role": "object", "material": "grey", "points": [[4,-2,6],[4,4,6],[4,4,-4],[4,-2,-4]], "faceVertexCounts": [4], "faceVertexIndices": [0,1,2,3] } ],
      "lights": [ { "type": "ambient", "color": [1, 1, 1] } ], "render": { "maxDepth": )" +
           std::to_string(depth) + " } }";
}

const std::string kPerspective =
    R"({ "name": "p", "yfov": 45, "lookAt": { "eye": [0.5, 0.6, 4], "at": [0, 0, 0] } })";

/// The same rays as an explicit mesh of n x n squares.
std::string as_ray_mesh(int n) {
    CameraDescription from;
    from.eye = {0.5, 0.6, 4};
    from.at = {0, 0, 0};
    from.kind = PerspectiveCamera{.yfov = 45};
    const Camera camera = make_camera(from, {kOpticsWidth, kOpticsHeight});
    std::ostringstream points, directions, screen, triangles;
    for (std::ostringstream* text : {&points, &directions, &screen}) text->precision(17);
    for (int j = 0; j <= n; ++j)
        for (int i = 0; i <= n; ++i) {
            const char* comma = i + j > 0 ? "," : "";
            const Ray ray = *exact_ray(
                camera, {i * kOpticsWidth / static_cast<double>(n), j * kOpticsHeight / static_cast<double>(n)});
            points << comma << "[" << ray.origin.x << "," << ray.origin.y << "," << ray.origin.z << "]";
            directions << comma << "[" << ray.direction.x << "," << ray.direction.y << "," << ray.direction.z
                       << "]";
            screen << comma << "[" << i / static_cast<double>(n) << "," << j / static_cast<double>(n) << "]";
        }
    for (int j = 0; j < n; ++j)
        for (int i = 0; i < n; ++i) {
            const int a = j * (n + 1) + i, c = a + n + 1;
            triangles << (i + j > 0 ? "," : "") << "[" << a << "," << a + 1 << "," << c << "],[" << a + 1
                      << "," << c + 1 << "," << c << "]";
        }
    return R"({ "name": "m", "type": "rayMesh", "points": [)" + points.str() + R"(], "directions": [)" +
           directions.str() + R"(], "screen": [)" + screen.str() + R"(], "triangles": [)" + triangles.str() +
           "] }";
}

SampleViews look(const World& world, Engine engine, GridKind grid = GridKind::kScreen) {
    SampleViews views;
    FrameParams frame;
    frame.grid = grid;
    make_viewer(world, frame, engine, ignore)->view({0, 0, kOpticsWidth, kOpticsHeight, 1}, views);
    return views;
}

/// How many samples see something else, and the median distance of what both see by that path.
struct LayerDifference {
    std::size_t optic = 0, seen = 0, compared = 0;
    double median = 0, largest = 0;
};

LayerDifference compare_views(const World& world, const SampleViews& a, const SampleViews& b, Path path) {
    LayerDifference difference;
    std::vector<double> off;
    for (std::size_t s = 0; s < a.samples.size(); ++s) {
        difference.optic += a.samples[s].optic != b.samples[s].optic;
        const Hit one = a.hit(a.samples[s], path), other = b.hit(b.samples[s], path);
        if (a.samples[s].optic == kNone || a.samples[s].optic != b.samples[s].optic) continue;
        ++difference.compared;
        if (one.triangle != other.triangle)
            ++difference.seen;
        else if (one.seen())
            off.push_back(length(position(world.objects, one) - position(world.objects, other)));
    }
    std::sort(off.begin(), off.end());
    if (!off.empty()) difference.median = off[off.size() / 2], difference.largest = off.back();
    return difference;
}

}  // namespace

TEST_CASE("a perspective's rays as an explicit mesh show optics as the perspective does", "[laws][law]") {
    for (const std::string material : {"mirror", "glass"})
        for (const int depth : {0, 8}) {
            INFO(material << " " << depth);
            const auto plain = world_from("plain", ball_scene(kPerspective, material, depth), 24),
                       mesh = world_from("mesh", ball_scene(as_ray_mesh(6), material, depth), 24);
            const Path path = material == "mirror" ? Path::kReflect : Path::kRefract;
            const SampleViews explicit_mesh = look(*mesh, Engine::kExact),
                              truth = look(*plain, Engine::kLimitTruth);
            // The truth of both cameras is the same to rounding.
            const LayerDifference truths =
                compare_views(*plain, look(*mesh, Engine::kLimitTruth), truth, path);
            CHECK(truths.compared > 1000);
            CHECK(truths.optic == 0);
            CHECK(truths.seen == 0);
            CHECK(truths.largest < 1e-9);
            const LayerDifference off = compare_views(*plain, explicit_mesh, truth, path);
            INFO("optic " << off.optic << ", seen " << off.seen << " of " << off.compared << ", median "
                          << off.median);
            CHECK(off.optic < 60);
            CHECK(off.seen < 60);
            // As near as the perspective's own facets on the film, which lie over the ball's bounds alone.
            const LayerDifference own = compare_views(*plain, look(*plain, Engine::kExact), truth, path);
            INFO("the perspective's own: seen " << own.seen << ", median " << own.median);
            CHECK(off.median < 2 * own.median);
            // The projector and rays through the same facets.
            const LayerDifference traced =
                compare_views(*plain, explicit_mesh, look(*mesh, Engine::kFacetsTruth), path);
            CHECK(traced.optic == 0);
            CHECK(traced.seen <= 2);
        }
}

TEST_CASE("through an explicit mesh the picture comes to the exact one as facets get smaller",
          "[laws][law]") {
    std::array<double, 2> median{};
    for (const bool fine : {false, true}) {
        const auto world = world_from("mesh", ball_scene(as_ray_mesh(6), "mirror", 8), fine ? 32 : 8);
        const LayerDifference off = compare_views(*world, look(*world, Engine::kExact),
                                                  look(*world, Engine::kLimitTruth), Path::kReflect);
        median[fine] = off.median;
    }
    INFO(median[0] << " -> " << median[1]);
    CHECK(median[1] < median[0] / 8);
}

TEST_CASE("a camera inside a room of mirrors: engines agree and rays end where the exact surfaces send them",
          "[laws][oracle][law]") {
    // Five mirrors and an open front; a card stands in the room.
    const auto wall = [](const std::string& name, const std::string& points) {
        return R"({ "name": ")" + name +
               R"(", "role": "optic", "material": "mirror", "resolution": 4, "subdivisionScheme": "bilinear", "points": )" +
               points + R"(, "faceVertexCounts": [4], "faceVertexIndices": [0,1,2,3] })";
    };
    const std::string cameras[] = {
        R"({ "name": "fish", "type": "fisheye", "fov": 190, "facets": 64, "lookAt": { "eye": [0.3, 0.2, 0.9], "at": [0, 0, -1] } })",
        R"({ "name": "all", "type": "spherical", "facets": 64, "lookAt": { "eye": [0.3, 0.2, 0.4], "at": [0, 0, -1] } })",
        R"({ "name": "plain", "yfov": 70, "lookAt": { "eye": [0.3, 0.2, 0.9], "at": [0, 0, -1] } })"};
    for (const std::string& camera : cameras) {
        INFO(camera);
        const auto world =
            world_from("room",
                       R"({ "version": 1, "film": { "width": 96, "height": 72 }, "cameras": [)" + camera +
                           R"(],
          "materials": [ { "name": "mirror", "metallicFactor": 1 }, { "name": "red", "baseColorFactor": [0.8, 0.1, 0.1] } ],
          "meshes": [ )" + wall("back", "[[-2,-2,-2],[2,-2,-2],[2,2,-2],[-2,2,-2]]") +
                           ", " + wall("left", "[[-2,-2,2],[-2,-2,-2],[-2,2,-2],[-2,2,2]]") + ", " +
                           wall("right", "[[2,-2,-2],[2,-2,2],[2,2,2],[2,2,-2]]") + ", " +
                           wall("floor", "[[-2,-2,2],[2,-2,2],[2,-2,-2],[-2,-2,-2]]") + ", " +
                           wall("ceiling", "[[-2,2,-2],[2,2,-2],[2,2,2],[-2,2,2]]") + R"(,
            { "name": "card", "role": "object", "material": "red", "points": [[-0.8,-0.5,-0.6],[0.4,-0.7,-0.9],[0.5,0.6,-0.8],[-0.6,0.7,-0.5]], "faceVertexCounts": [4], "faceVertexIndices": [0,1,2,3] } ],
          "lights": [ { "type": "ambient", "color": [1, 1, 1] } ], "render": { "maxDepth": 3 } })",
                       4);
        const SampleViews exact = look(*world, Engine::kExact, GridKind::kSurface),
                          facets = look(*world, Engine::kFacetsTruth, GridKind::kSurface),
                          limit = look(*world, Engine::kLimitTruth, GridKind::kSurface);
        const LayerDifference traced = compare_views(*world, exact, facets, Path::kReflect),
                              off = compare_views(*world, exact, limit, Path::kReflect);
        INFO("facets " << traced.seen << ", limit " << off.seen << " of " << off.compared << ", median "
                       << off.median << ", optic " << off.optic);
        CHECK(off.compared > 2000);
        CHECK(traced.optic == 0);
        CHECK(static_cast<double>(traced.seen) <= 0.002 * static_cast<double>(traced.compared));
        CHECK(static_cast<double>(off.optic) <= 0.02 * kOpticsWidth * kOpticsHeight);
        CHECK(static_cast<double>(off.seen) <= 0.03 * static_cast<double>(off.compared));
        CHECK(off.median < 0.02);
    }
}

TEST_CASE("an error that is asked for is kept before every camera, and most is projected",
          "[laws][law][golden][thorough]") {
    const auto summary = [](const World& world, std::size_t camera, std::optional<double> max_error) {
        PictureRequest request;
        request.frame.camera = camera;
        request.frame.max_error = max_error;
        const Picture drawn = draw_picture(world, request, {}, ignore);
        request.engine = Engine::kLimitTruth;
        const Picture truth = draw_picture(world, request, {}, ignore);
        const auto found = measure_displacement(truth.image, drawn.image, "reflect");
        REQUIRE(found);
        REQUIRE(found->summary);
        return std::tuple(*found->summary, found->pixels, drawn.statistics);
    };
    const auto world = shipped_world("cameras", 8, 320, 240);
    std::size_t asked = 0;
    for (std::size_t c = 0; c < world->scene.cameras.size(); ++c) {
        const std::string& name = world->scene.cameras[c].name;
        // The ball stands behind "around".
        if (name == "around") continue;
        const auto [kept, pixels, adaptive] = summary(*world, c, 0.25);
        if (pixels < 500) continue;
        const Summary loose = std::get<0>(summary(*world, c, 0.0));
        INFO(name << ": " << kept.p99 << " px, was " << loose.p99 << "; " << adaptive.traced_pixels << " of "
                  << adaptive.optic_pixels << " traced");
        ++asked;
        CHECK(kept.p99 <= 0.25);
        CHECK(kept.p99 < 0.9 * loose.p99);
        // Outlines are decided by the surface; in "several" the film folds where views fade into each other
        // too.
        CHECK(adaptive.traced_pixels < adaptive.optic_pixels / 3);
    }
    CHECK(asked >= 8);
}

TEST_CASE("glass before a camera that is not linear is as near to the truth as before a perspective",
          "[laws][law]") {
    const auto mean_of = [](const std::string& camera) {
        const auto world = world_from("fisheye_glass", ball_scene(camera, "glass", 8), 12);
        PictureRequest request;
        request.frame.max_error = 0;
        const Picture drawn = draw_picture(*world, request, {}, ignore);
        request.engine = Engine::kLimitTruth;
        const auto found =
            measure_displacement(draw_picture(*world, request, {}, ignore).image, drawn.image, "refract");
        REQUIRE(found);
        REQUIRE(found->summary);
        // In parts of the ball's size on the film.
        return found->summary->mean / std::sqrt(static_cast<double>(drawn.statistics.optic_pixels));
    };
    const double perspective = mean_of(kPerspective);
    const std::string look = R"("lookAt": { "eye": [0.5, 0.6, 4], "at": [0, 0, 0] } })";
    CHECK(mean_of(R"({ "name": "f", "type": "fisheye", "fov": 60, )" + look) < 2 * perspective);
    CHECK(mean_of(R"({ "name": "c", "type": "cylindrical", "hfov": 60, "yfov": 45, )" + look) <
          2 * perspective);
}
