// Laws of whole pictures through cameras of every kind: engines agree, tiles join, a panorama is six faces of
// a cube, and points are shown where `project` says.
#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <sstream>

#include "cli/command_line.h"
#include "laws/worlds.h"
#include "render/engines/engine.h"
#include "render/frame/camera_rays.h"
#include "render/picture/picture.h"
#include "render/project/project.h"
#include "render/world/world.h"
#include "scene/examples/examples.h"
#include "support/closed_forms.h"
#include "support/test.h"

using namespace trilens;
using namespace trilens_test;

namespace {

std::string cameras_text() {
    std::ifstream in(source_dir() + "/scenes/cameras.json");
    std::stringstream all;
    all << in.rdbuf();
    return all.str();
}

/// The shipped room of cameras on a small film, with other cameras where `cameras` gives some.
std::unique_ptr<World> camera_room(int width, int height, int n, const std::string& cameras = "") {
    std::string text = cameras_text();
    REQUIRE(!text.empty());
    const std::size_t film = text.find("\"film\":"), film_end = text.find('\n', film);
    text.replace(film, film_end - film,
                 "\"film\": { \"width\": " + std::to_string(width) +
                     ", \"height\": " + std::to_string(height) + " },");
    // The lens is given in pixels of the film.
    const std::string pixels = "\"fx\": 420, \"fy\": 420, \"cx\": 320, \"cy\": 240";
    const std::size_t lens = text.find(pixels);
    REQUIRE(lens != std::string::npos);
    const double scale = width / 640.0;
    std::ostringstream scaled;
    scaled << "\"fx\": " << 420 * scale << ", \"fy\": " << 420 * scale << ", \"cx\": " << 320 * scale
           << ", \"cy\": " << 240 * scale;
    text.replace(lens, pixels.size(), scaled.str());
    if (!cameras.empty()) {
        const std::size_t from = text.find("\"cameras\":"), to = text.find("\"materials\":");
        text.replace(from, to - from, "\"cameras\": [" + cameras + "],\n  ");
    }
    return world_from("cameras", text, n);
}

SampleViews camera_views(const World& world, std::size_t camera, const EngineChoice& engine) {
    const Film& film = world.scene.film;
    SampleViews views;
    make_viewer(world, {camera, 0}, engine, ignore)->view({0, 0, film.width, film.height, 1}, views);
    return views;
}

std::array<Id, 4> seen_by_camera(const SampleViews& views, std::size_t s) {
    const SampleView& view = views.samples[s];
    return {view.hit.triangle, view.optic, view.optic == kNone ? kNone : view.facet,
            views.hit(view, Path::kReflect).triangle};
}

std::size_t camera_named(const World& world, const std::string& name) {
    for (std::size_t i = 0; i < world.scene.cameras.size(); ++i)
        if (world.scene.cameras[i].name == name) return i;
    FAIL("no camera " << name);
    return 0;
}

const std::vector<Id>& ids(const Image& image, const std::string& channel) {
    return image.find(channel)->ids();
}

}  // namespace

TEST_CASE("through every camera the projector, the thesis' engine and Embree see the same",
          "[laws][oracle][law]") {
    const auto world = camera_room(120, 90, 5);
    REQUIRE(world->scene.cameras.size() >= 12);
    for (std::size_t c = 0; c < world->scene.cameras.size(); ++c) {
        INFO(world->scene.cameras[c].name);
        const SampleViews exact = camera_views(*world, c, Engine::kExact),
                          traced = camera_views(*world, c, Engine::kFacetsTruth),
                          classic = camera_views(*world, c, ClassicParams());
        std::size_t on_optic = 0, differing = 0, classic_differing = 0, without = 0;
        for (std::size_t s = 0; s < exact.samples.size(); ++s) {
            on_optic += exact.samples[s].optic != kNone;
            differing += seen_by_camera(exact, s) != seen_by_camera(traced, s);
            classic_differing += seen_by_camera(exact, s) != seen_by_camera(classic, s);
            without += exact.samples[s].optic != kNone && exact.ends_of(exact.samples[s]).empty();
        }
        const double all = static_cast<double>(exact.samples.size());
        INFO("of " << all << ", " << on_optic << " of the ball: " << differing << " differ from the traced, "
                   << classic_differing << " from the classic, " << without << " without ray");
        CHECK(static_cast<double>(differing) <= 0.001 * all);
        CHECK(static_cast<double>(classic_differing) <= 0.003 * all);
        if (world->scene.cameras[c].name == "around") continue;  // sees no optic
        CHECK(on_optic > 200);
        CHECK(static_cast<double>(without) <= 0.02 * static_cast<double>(on_optic));
    }
}

TEST_CASE("through every camera the picture comes to the exact surface's and the exact rays'",
          "[laws][law][thorough]") {
    const auto coarse = camera_room(120, 90, 4), fine = camera_room(120, 90, 16);
    for (std::size_t c = 0; c < coarse->scene.cameras.size(); ++c) {
        INFO(coarse->scene.cameras[c].name);
        if (coarse->scene.cameras[c].name == "around") continue;  // sees no optic
        const SampleViews truth = camera_views(*fine, c, Engine::kLimitTruth);
        std::array<double, 2> off{};
        std::array<std::size_t, 2> count{};
        for (const bool is_fine : {false, true}) {
            const World& world = is_fine ? *fine : *coarse;
            const SampleViews views = camera_views(world, c, Engine::kExact);
            std::vector<double> distances;
            std::size_t other_optic = 0, other_ray = 0;
            for (std::size_t s = 0; s < views.samples.size(); ++s) {
                const SampleView &a = views.samples[s], &b = truth.samples[s];
                other_ray += (a.ray.direction == Vec3(0)) != (b.ray.direction == Vec3(0));
                other_optic += a.optic != b.optic;
                const Hit ha = views.hit(a, Path::kReflect), hb = truth.hit(b, Path::kReflect);
                if (ha.seen() && hb.seen() && ha.triangle == hb.triangle)
                    distances.push_back(length(position(world.objects, ha) - position(fine->objects, hb)));
            }
            CHECK(other_ray <= (is_fine ? 150 : 150));
            CHECK(other_optic <= (is_fine ? 80 : 400));
            REQUIRE(distances.size() > 100);
            std::sort(distances.begin(), distances.end());
            off[is_fine] = distances[distances.size() / 2];
            count[is_fine] = distances.size();
        }
        INFO("median " << off[0] << " -> " << off[1] << " of " << count[1]);
        // Four times the facets along an edge: sixteen times nearer where the camera's own mesh is not what
        // is left.
        CHECK(off[1] < off[0] / 6);
    }
}

TEST_CASE("every example is drawn by projection as its facets' rays have it, through each of its cameras",
          "[laws][law][golden]") {
    std::size_t drawn = 0;
    for (const SceneExample& example : scene_examples()) {
        std::string text = example.json;
        const std::size_t film = text.find("\"film\":"), end = text.find('}', film);
        text.replace(film, end + 1 - film, R"("film": { "width": 72, "height": 54 })");
        const auto world = world_from(example.name, text, 4);
        for (std::size_t c = 0; c < world->scene.cameras.size(); ++c) {
            INFO(example.name << ", " << world->scene.cameras[c].name);
            const SampleViews exact = camera_views(*world, c, Engine::kExact),
                              traced = camera_views(*world, c, Engine::kFacetsTruth);
            std::size_t differing = 0, shown = 0;
            for (std::size_t s = 0; s < exact.samples.size(); ++s) {
                differing += seen_by_camera(exact, s) != seen_by_camera(traced, s);
                shown += exact.samples[s].hit.seen() || exact.samples[s].optic != kNone;
            }
            CHECK(differing <= 4);
            CHECK(shown > exact.samples.size() / 3);
            ++drawn;
        }
    }
    CHECK(drawn >= 20);
}

TEST_CASE("the examples of cameras and caustics are the shipped scenes", "[laws][law][golden]") {
    for (const auto& [name, file] : {std::pair("cameras", "cameras.json"), {"caustic", "caustics/ring.json"}})
        for (const SceneExample& example : scene_examples())
            if (example.name == std::string(name))
                CHECK(example.json == trilens_test::bytes_of(source_dir() + "/scenes/" + file));
}

TEST_CASE("the tiles of a shifted camera join to the whole picture, every id the same", "[laws][law]") {
    const std::string look_at = R"("lookAt": { "eye": [0.6, 1.8, 4.7], "at": [-0.1, 1, 0] } })";
    const double yfov = 60, tile = 2 * std::atan(0.5 * std::tan(yfov * 3.14159265358979323846 / 360)) * 180 /
                                   3.14159265358979323846;
    std::ostringstream yfov_of_tile;
    yfov_of_tile.precision(17);
    yfov_of_tile << tile;
    const auto whole = camera_room(200, 120, 8, R"({ "name": "whole", "yfov": 60, )" + look_at);
    const Image all = draw_picture(*whole, {}, {}, ignore).image;
    std::size_t compared = 0;
    for (const int row : {0, 1})
        for (const int column : {0, 1}) {
            const std::string shift =
                std::string("[") + (column ? "0.5" : "-0.5") + ", " + (row ? "-0.5" : "0.5") + "]";
            const auto part = camera_room(100, 60, 8,
                                          R"({ "name": "part", "yfov": )" + yfov_of_tile.str() +
                                              R"(, "shift": )" + shift + ", " + look_at);
            const Image one = draw_picture(*part, {}, {}, ignore).image;
            for (const std::string channel :
                 {"optic.object", "optic.facet", "reflectID.object", "reflectID.primitive"})
                for (int y = 0; y < 60; ++y)
                    for (int x = 0; x < 100; ++x) {
                        const std::size_t in_tile = static_cast<std::size_t>(y * 100 + x);
                        const std::size_t in_all =
                            static_cast<std::size_t>((y + 60 * row) * 200 + x + 100 * column);
                        if (ids(one, channel)[in_tile] != ids(all, channel)[in_all])
                            FAIL(channel << " differs at " << x << "," << y << " of tile " << column << row);
                        ++compared;
                    }
        }
    CHECK(compared == 4 * 200 * 120);
}

TEST_CASE("a panorama is what six faces of a cube show", "[laws][law]") {
    const std::string eye = "\"eye\": [-0.4, 1.6, 2.4]";
    std::string cameras = R"({ "name": "all", "type": "spherical", "facets": 128, "lookAt": { )" + eye +
                          R"(, "at": [-0.4, 1.6, 0] } })";
    const std::array<Vec3, 6> ways{Vec3(1, 0, 0),  Vec3(-1, 0, 0), Vec3(0, 1, 0),
                                   Vec3(0, -1, 0), Vec3(0, 0, 1),  Vec3(0, 0, -1)};
    const auto panorama = camera_room(240, 120, 6, cameras);
    std::string faces;
    for (const Vec3& way : ways) {
        std::ostringstream one;
        one << (faces.empty() ? "" : ", ") << R"({ "name": "face)" << faces.size()
            << R"(", "yfov": 90, "lookAt": { )" << eye << ", \"at\": [" << -0.4 + way.x << ", " << 1.6 + way.y
            << ", " << 2.4 + way.z << "], \"up\": " << (way.y == 0 ? "[0, 1, 0]" : "[0, 0, 1]") << " } }";
        faces += one.str();
    }
    const auto cube = camera_room(400, 400, 6, faces);
    std::vector<SampleViews> shown;
    for (std::size_t k = 0; k < 6; ++k) shown.push_back(camera_views(*cube, k, Engine::kExact));
    const SampleViews views = camera_views(*panorama, 0, Engine::kExact);
    std::size_t compared = 0, same = 0;
    for (const SampleView& view : views.samples) {
        // The middle of a cube's pixel may lie on the other side of an edge: take those whose four neighbours
        // agree.
        std::size_t face = 0;
        for (std::size_t k = 1; k < 6; ++k)
            if (dot(ways[k], view.ray.direction) > dot(ways[face], view.ray.direction)) face = k;
        const CameraRays camera = make_camera_rays(cube->scene, face);
        const Vec3 screen = screen_from_world(*camera.linear, view.ray.origin + view.ray.direction);
        const int x = static_cast<int>(screen.x / screen.z - 0.5),
                  y = static_cast<int>(screen.y / screen.z - 0.5);
        if (x < 0 || y < 0 || x >= 399 || y >= 399) continue;
        const std::size_t first = static_cast<std::size_t>(y * 400 + x);
        const auto at = [&](std::size_t s) {
            return std::pair(shown[face].samples[s].hit.triangle, shown[face].samples[s].optic);
        };
        if (at(first) != at(first + 1) || at(first) != at(first + 400) || at(first) != at(first + 401))
            continue;
        ++compared;
        same += at(first) == std::pair(view.hit.triangle, view.optic);
    }
    CHECK(compared > 24000);
    CHECK(static_cast<double>(same) >= 0.9995 * static_cast<double>(compared));
}

TEST_CASE("what project names, the exact rays see, through every camera", "[laws][law]") {
    const auto world = camera_room(160, 120, 8);
    const std::vector<Vec3> points{
        {-1.55, 0.9, 1.2}, {1.65, 0.8, 0.5}, {-2.9, 2, 1}, {0.4, 3.9, 1}, {2.9, 1, 3}};
    std::size_t reflected = 0, refined = 0;
    for (std::size_t c = 0; c < world->scene.cameras.size(); ++c) {
        INFO(world->scene.cameras[c].name);
        const CameraRays camera = make_camera_rays(world->scene, c);
        ProjectRequest request;
        request.frame.camera = c;
        const auto found = project_points(*world, request, points);
        for (std::size_t p = 0; p < points.size(); ++p)
            for (const WorldImage& image : found[p].images) {
                if (!image.inside) continue;
                std::optional<Ray> ray = exact_ray(camera, image.pixel);
                REQUIRE(ray);
                if (image.path == Path::kReflect) {
                    ++reflected;
                    const auto hit = limit_tracer(*world, image.optic).first_hit(*ray);
                    if (!image.refined && !hit) continue;
                    REQUIRE(hit);
                    ray = mirrored_ray(*ray, *hit);
                }
                const Vec3 way = normalize(ray->direction), off = points[p] - ray->origin;
                const double miss = length(off - dot(off, way) * way);
                refined += image.refined;
                CHECK(dot(off, way) > 0);
                // Images that only the facets have are off by what the facets are.
                CHECK(miss < (image.refined ? 1e-5 : 0.5) * (1 + length(off)));
            }
    }
    CHECK(reflected > 30);
    CHECK(refined > 30);
}

TEST_CASE("what a picture shows in a mirror, project finds there, through every camera", "[laws][law]") {
    const auto world = camera_room(160, 120, 10);
    REQUIRE(world->scene.render.max_depth > 0);
    std::size_t asked = 0;
    for (std::size_t c = 0; c < world->scene.cameras.size(); ++c) {
        const SampleViews shown = camera_views(*world, c, Engine::kExact);
        // Well inside what the mirror shows: every 47th sample whose neighbours see the same triangle in it.
        std::vector<Vec3> points;
        std::vector<Vec2> pixels;
        const auto seen_at = [&](std::size_t s) {
            const PathEnd* end = shown.find(shown.samples[s], Path::kReflect);
            return end && end->step_count == 1 ? end->hit.triangle : kNone;
        };
        for (std::size_t s = 161; s + 161 < shown.samples.size(); s += 47) {
            const Id triangle = seen_at(s);
            if (triangle == kNone || seen_at(s - 161) != triangle || seen_at(s - 159) != triangle ||
                seen_at(s + 159) != triangle || seen_at(s + 161) != triangle)
                continue;
            const Vec2 pixel(static_cast<double>(s % 160) + 0.5, static_cast<double>(s / 160) + 0.5);
            // Where several views blend, the optic's grid lies on the film more than once, and is drawn once.
            const bool blends = world->scene.cameras[c].name == "several" &&
                                std::fabs(std::fabs(pixel.x - 80) - 0.2 * 160) <= 0.05 * 160;
            if (blends) continue;
            points.push_back(position(world->objects, shown.find(shown.samples[s], Path::kReflect)->hit));
            pixels.push_back(pixel);
        }
        asked += points.size();
        for (const bool refine : {true, false}) {
            ProjectRequest request;
            request.frame.camera = c;
            request.refine = refine;
            if (!refine) request.search = ImageSearch::kFacets;
            const auto found = project_points(*world, request, points);
            for (std::size_t p = 0; p < points.size(); ++p) {
                INFO(world->scene.cameras[c].name << " refine " << refine << " pixel " << pixels[p].x << " "
                                                  << pixels[p].y);
                const auto& images = found[p].images;
                CHECK(std::any_of(images.begin(), images.end(), [&](const WorldImage& image) {
                    return image.path == Path::kReflect && image.visible &&
                           length(image.pixel - pixels[p]) < 3;
                }));
            }
        }
    }
    CHECK(asked > 250);
}

TEST_CASE("beyond a fisheye's circle there is nothing: no ray, alpha 0, black", "[laws][law]") {
    const auto world = camera_room(160, 120, 6);
    const std::size_t fisheye = camera_named(*world, "fisheye");
    for (const Engine engine : {Engine::kExact, Engine::kLimitTruth}) {
        PictureRequest request;
        request.frame.camera = fisheye;
        request.engine = engine;
        const Image image = draw_picture(*world, request, {}, ignore).image;
        std::size_t outside = 0;
        for (int y = 0; y < 120; ++y)
            for (int x = 0; x < 160; ++x) {
                const double distance = std::hypot(x + 0.5 - 80, y + 0.5 - 60);
                const std::size_t p = static_cast<std::size_t>(y * 160 + x);
                const float alpha = image.find("A")->floats()[p];
                if (distance > 60.01) {
                    ++outside;
                    CHECK(alpha == 0);
                    CHECK(image.find("R")->floats()[p] == 0);
                    CHECK(image.find("Z")->floats()[p] == 1e30f);
                }
                if (distance < 59) CHECK(alpha == 1);
            }
        CHECK(outside > 1000);
    }
}

TEST_CASE("clipping planes: nothing nearer than near, nothing farther than far, Z counts from the eye",
          "[laws][law]") {
    const std::string look_at = R"("lookAt": { "eye": [0.6, 1.8, 4.7], "at": [-0.1, 1, 0] } })";
    const auto open = camera_room(160, 120, 8, R"({ "name": "open", "yfov": 60, )" + look_at);
    const auto clipped =
        camera_room(160, 120, 8, R"({ "name": "clipped", "yfov": 60, "near": 4.2, "far": 6, )" + look_at);
    for (const Engine engine : {Engine::kExact, Engine::kFacetsTruth, Engine::kLimitTruth}) {
        const SampleViews all = camera_views(*open, 0, engine), some = camera_views(*clipped, 0, engine);
        std::size_t same = 0, gone = 0, uncovered = 0;
        for (std::size_t s = 0; s < all.samples.size(); ++s) {
            const SampleView &a = all.samples[s], &b = some.samples[s];
            const bool sees = b.hit.seen() || b.optic != kNone;
            if (sees) {
                CHECK(b.depth >= 4.2);
                CHECK(b.depth <= 6);
            }
            if (a.depth > 4.2 + 1e-9 && a.depth < 6 - 1e-9) {
                CHECK(b.depth == Approx(a.depth));
                CHECK(a.optic == b.optic);
                ++same;
            }
            gone += a.depth > 6 && !sees;
            uncovered += a.depth < 4.2 && sees;
        }
        CHECK(same > 1000);
        CHECK(gone > 1000);
        CHECK(uncovered > 100);
    }
}
