// Laws of whole pictures: a flat mirror is a second camera, a sphere obeys Alhazen, threads change nothing.
#include <cmath>
#include <filesystem>
#include <fstream>
#include <random>
#include <sstream>

#include "camera/linear/linear_cameras.h"
#include "cli/command_line.h"
#include "intersect/tracer.h"
#include "laws/worlds.h"
#include "render/engines/engine.h"
#include "render/project/project.h"
#include "support/test.h"

using namespace trilens;
using namespace trilens_test;

namespace {

/// The point of the unit sphere round the origin that mirrors `x` to `e`: in their plane, where the angles to
/// both are equal, by bisection between the two directions.
Vec3 alhazen_point(const Vec3& e, const Vec3& x) {
    const Vec3 a = normalize(e), b = normalize(x);
    const auto on_arc = [&](double s) { return normalize((1 - s) * a + s * b); };
    double low = 0, high = 1;
    for (int k = 0; k < 200; ++k) {
        const double middle = 0.5 * (low + high);
        const Vec3 p = on_arc(middle);
        const double to_eye = dot(normalize(e - p), p), to_point = dot(normalize(x - p), p);
        (to_eye > to_point ? low : high) = middle;
    }
    return on_arc(0.5 * (low + high));
}

}  // namespace

TEST_CASE("a flat mirror shows what a second camera behind it sees, at any resolution", "[laws][law]") {
    for (const int n : {1, 2, 7}) {
        const auto world = shipped_world("flat", n, 96, 72);
        const Film& film = world->scene.film;
        const SampleGrid grid{0, 0, film.width, film.height, 1};
        SampleViews views;
        make_viewer(*world, {}, Engine::kExact, ignore)->view(grid, views);

        // The virtual eye, from the mirror's own plane.
        const SurfacePoint plane = world->optics[0].surface->eval(0, Vec2(0.5));
        const Vec3 eye = world->scene.cameras[0].eye;
        const Vec3 virtual_eye = eye - 2 * dot(eye - plane.position, plane.normal) * plane.normal;
        const Tracer tracer(world->objects);
        std::size_t seen = 0, other = 0;
        for (const SampleView& view : views.samples) {
            const PathEnd* reflected = views.find(view, Path::kReflect);
            if (!reflected) continue;
            const Vec3 on_mirror = reflected->ray.origin;
            const Hit hit = tracer.first_hit({virtual_eye, on_mirror - virtual_eye}, 1.0);
            ++seen;
            if (hit.triangle != reflected->hit.triangle) {
                ++other;
                continue;
            }
            if (hit.seen())
                CHECK(length(position(world->objects, hit) - position(world->objects, reflected->hit)) <
                      1e-12);
            // Every corner ray meets in the virtual eye at t = -1.
            CHECK(length(reflected->ray.origin - reflected->ray.direction - virtual_eye) < 1e-13);
        }
        CHECK(seen > 500);
        CHECK(other <= seen / 1000);
    }
}

TEST_CASE("project agrees with Alhazen's problem on the sphere to 1e-9 of the film", "[laws][oracle][law]") {
    const auto world = shipped_world("sphere", 8, 640, 480);
    const CameraDescription& camera = world->scene.cameras[0];
    const LinearCamera linear = make_perspective(
        {{camera.eye, camera.at, camera.up}, std::get<PerspectiveCamera>(camera.kind).yfov, 640, 480});
    std::mt19937 random(11);
    std::uniform_real_distribution<double> uniform(0, 1);
    std::vector<Vec3> points;
    while (points.size() < 300) {
        const double x = 6 * uniform(random) - 3, y = 4 * uniform(random) - 1.2, z = 8 * uniform(random) - 3;
        if (length(Vec3(x, y, z)) > 1.05) points.push_back({x, y, z});
    }
    const auto images = project_points(*world, {}, points);
    std::size_t checked = 0;
    double worst = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
        for (const WorldImage& image : images[i].images) {
            if (image.path != Path::kReflect || !image.refined) continue;
            const Vec3 screen = screen_from_world(linear, alhazen_point(camera.eye, points[i]));
            worst = std::max(worst, length(image.pixel - Vec2(screen.x, screen.y) / screen.z));
            ++checked;
        }
    }
    INFO("worst " << worst << " px over " << checked << " images of " << points.size() << " points");
    CHECK(checked > 200);
    CHECK(worst < 1e-9 * 640);
}

TEST_CASE("the same file for one thread and for two", "[laws][law]") {
    const std::string folder = scratch_dir("threads");
    for (const std::string scene : {"piece", "water"}) {
        for (const std::string command : {"render", "trace", "trace --surface facets"}) {
            std::string first;
            for (const std::string threads : {"1", "2"}) {
                const CommandRun run = run_trilens(command + " " + source_dir() + "/scenes/" + scene +
                                                   ".json --size 160x120 --spp 2 -t " + threads + " -o " +
                                                   folder + "/out.exr -q");
                REQUIRE(run.exit_code == 0);
                if (first.empty()) first = bytes_of(folder + "/out.exr");
                INFO(scene << " " << command);
                CHECK(first == bytes_of(folder + "/out.exr"));
            }
        }
    }
}

TEST_CASE("an image drawn again from its own header is the same image", "[laws][law]") {
    const std::string folder = scratch_dir("again");
    const std::string scene = write_file(folder, "scene.json", small_scene());
    REQUIRE(
        run_trilens("render " + scene + " -n 6 --set /film/spp=2 -o " + folder + "/first.exr").exit_code ==
        0);
    REQUIRE(run_trilens("render " + folder + "/first.exr -o " + folder + "/again.exr").exit_code == 0);
    const CommandRun compared = run_trilens("compare " + folder + "/first.exr " + folder +
                                            "/again.exr --fail 0 --hardfail 0 --failpercent 0");
    INFO(compared.out);
    CHECK(compared.exit_code == 0);
    CHECK(compared.out.find("PASS") != std::string::npos);
}

TEST_CASE("degenerate but legal scenes render, with a word where the user would want one",
          "[laws][bad-input][law]") {
    const std::string folder = scratch_dir("degenerate");
    struct Case {
        std::string what, replace, by, says;
    };
    const std::vector<Case> cases{
        {"empty scene",
         small_scene().substr(small_scene().find("\"meshes\": ["),
                              small_scene().find("\"lights\"") - small_scene().find("\"meshes\": [")),
         "\"meshes\": [], ", "no optic"},
        {"behind the camera", R"("center": [0,0,0])", R"("center": [0,0,9])", "no pixel sees an optic"},
        {"camera inside", R"("radius": 1)", R"("radius": 4.4)", ""},
        {"tiny", R"("radius": 1)", R"("radius": 1e-4)", ""},
        {"no area", "[4,4,5]", "[-4,-4,5]", ""},
    };
    for (const Case& c : cases) {
        INFO(c.what);
        const std::string scene = write_file(folder, "scene.json", replaced(small_scene(), c.replace, c.by));
        for (const std::string command : {"render ", "trace "}) {
            const CommandRun run = run_trilens(command + scene + " -o " + folder + "/out.exr");
            INFO(run.err);
            CHECK(run.exit_code == 0);
            CHECK(std::filesystem::exists(folder + "/out.exr"));
            if (!c.says.empty()) CHECK(run.err.find(c.says) != std::string::npos);
            std::filesystem::remove(folder + "/out.exr");
        }
    }
}

TEST_CASE("more reflections in one sphere are never proven absent for an eye inside of it", "[laws][law]") {
    const auto projected = [](double distance) {
        const auto world =
            world_from("sphere",
                       R"({"version": 1, "film": {"width": 40, "height": 30},
            "cameras": [{"yfov": 60, "lookAt": {"eye": [0, 0.2, )" +
                           std::to_string(distance) +
                           R"(], "at": [0, 0, 0]}}], "materials": [{"name": "mirror", "metallicFactor": 1}],
            "meshes": [{"role": "optic", "material": "mirror", "primitive": {"type": "sphere", "radius": 2}}]})",
                       8);
        ProjectRequest request;
        request.path = EventWord("RR");
        return project_points(*world, request,
                              std::vector<Vec3>{{0.3, -0.2, 0.4}, {-0.5, 0.1, 0.2}, {3, 0, 3}});
    };
    // From outside no ray meets the sphere twice.
    for (const PointProjection& point : projected(5)) CHECK((point.complete && point.images.empty()));
    for (const PointProjection& point : projected(1.2)) CHECK(!point.complete);
}
