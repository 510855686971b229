// Caustics against their closed forms: nephroid, cardioid, slits; and the OBJ that has them.
#include <algorithm>
#include <cmath>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "cli/command_line.h"
#include "support/test.h"
#include "trilens/trilens.h"

using namespace trilens;
using namespace trilens_test;

namespace {

std::string cup() {
    return source_dir() + "/tests/laws/cup.json";
}

LineDrawing drawn(const Scene& scene, const std::string& camera, int resolution) {
    return Renderer(scene).draw_lines({find_camera(scene, camera), resolution},
                                      {.folds = true, .caustics = true});
}

/// Distance from a curve F(u, v) = 0, to first order, by central differences.
template <class Implicit>
double off_curve(Implicit f, double u, double v) {
    const double h = 1e-6;
    const double gu = (f(u + h, v) - f(u - h, v)) / (2 * h), gv = (f(u, v + h) - f(u, v - h)) / (2 * h);
    return std::fabs(f(u, v)) / std::max(std::hypot(gu, gv), 1e-6);
}

/// Caustic of parallel rays along z in a circle of radius 1: the epicycloid of two cusps, half as wide
/// between them (Huygens 1678).
double off_nephroid(const Vec3& p) {
    return off_curve([](double x, double z) { return std::pow(x * x + z * z - 0.25, 3) - 27.0 / 64 * x * x; },
                     p.x, p.z);
}

/// Caustic of rays from a point of the circle of radius 1 (at u = 1): the epicycloid of one cusp, at u =
/// -1/3.
double off_cardioid(double u, double v) {
    return off_curve(
        [](double u_at, double v_at) {
            const double a = 1.0 / 3, x = -(u_at + a), q = x * x + v_at * v_at;
            return q * q + 4 * a * x * q - 4 * a * a * v_at * v_at;
        },
        u, v);
}

double mean(const std::vector<double>& values) {
    double sum = 0;
    for (const double value : values) sum += value;
    return sum / static_cast<double>(values.size());
}

Scene inside_ball() {
    Scene scene;
    scene.film = {60, 60, 1};
    CameraDescription camera;
    camera.name = "main";
    camera.eye = {0, 0, 1};
    camera.at = {0, 0, 0};
    camera.kind = PerspectiveCamera{.yfov = 70, .near_depth = 0.3};
    scene.cameras.push_back(camera);
    Material chrome;
    chrome.metallic_factor = 1;
    scene.materials = {chrome};
    Mesh ball;
    ball.name = "ball", ball.role = Role::kOptic, ball.material = 0;
    ball.primitive = Primitive{};
    scene.meshes = {ball};
    scene.render.max_depth = 0;
    return scene;
}

struct ObjCounts {
    std::size_t points = 0, faces = 0, lines = 0;
    std::vector<std::string> objects;
};
ObjCounts counts_of(const std::string& obj) {
    ObjCounts counts;
    std::stringstream in(obj);
    for (std::string line; std::getline(in, line);) {
        counts.points += line.rfind("v ", 0) == 0;
        counts.faces += line.rfind("f ", 0) == 0;
        counts.lines += line.rfind("l ", 0) == 0;
        if (line.rfind("o ", 0) == 0) counts.objects.push_back(line.substr(2));
    }
    return counts;
}

}  // namespace

TEST_CASE("parallel rays in a ring have a nephroid, its sheet and the curve on the table", "[laws][law]") {
    const Scene scene = load_scene(SceneRequest{cup(), {}, 0});
    std::vector<double> errors;
    for (const int n : {6, 12, 24}) {
        const LineDrawing drawing = drawn(scene, "source", n);
        REQUIRE(drawing.caustics.size() == 1);
        const LineDrawing::Caustic& caustic = drawing.caustics[0];
        CHECK(caustic.path == "reflect");
        CHECK(caustic.optic == 0);
        CHECK_FALSE(caustic.sheet.is_virtual);
        std::vector<double> off;
        for (const Vec3& point : caustic.sheet.points) off.push_back(off_nephroid(point));
        REQUIRE(off.size() > 40);
        errors.push_back(mean(off));
        CHECK(*std::max_element(off.begin(), off.end()) < 0.5 / (n * n));
    }
    INFO(errors[0] << " " << errors[1] << " " << errors[2]);
    CHECK(std::log2(errors[0] / errors[1]) > 1.8);
    CHECK(std::log2(errors[1] / errors[2]) > 1.8);

    std::size_t on_table = 0;
    double nearest_to_axis = 1;
    for (const FoldCurve& fold : drawn(scene, "source", 24).fold_curves) {
        REQUIRE(fold.places.size() == fold.points.size());
        if (fold.object != 1) continue;
        for (const Vec3& place : fold.places) {
            ++on_table;
            CHECK(std::fabs(place.y) < 1e-9);
            CHECK(off_nephroid(place) < 1e-3);
            nearest_to_axis = std::min(nearest_to_axis, std::hypot(place.x, place.z));
        }
    }
    CHECK(on_table > 500);
    CHECK(nearest_to_axis == Approx(0.5).margin(1e-3));  // the cusp: half way to the mirror
}

TEST_CASE("rays from a point of a ball have a cardioid turned about the axis, and the axis", "[laws][law]") {
    const Scene scene = inside_ball();
    std::vector<double> errors;
    for (const int n : {8, 16, 32}) {
        std::vector<double> off, off_axis;
        for (const LineDrawing::Caustic& caustic : drawn(scene, "main", n).caustics)
            for (const Vec3& p : caustic.sheet.points) {
                const double radius = std::hypot(p.x, p.y);
                off.push_back(std::min(off_cardioid(p.z, radius), radius));
            }
        REQUIRE(off.size() > 50);
        errors.push_back(mean(off));
    }
    INFO(errors[0] << " " << errors[1] << " " << errors[2]);
    CHECK(errors[2] < 1.5e-3);
    CHECK(std::log2(errors[0] / errors[1]) > 1.65);
    CHECK(std::log2(errors[1] / errors[2]) > 1.65);
}

TEST_CASE("the caustic of crossed slits are the slits; of an eye and a flat mirror there is none",
          "[laws][law]") {
    Scene scene = inside_ball();
    scene.meshes[0].role = Role::kObject, scene.meshes[0].primitive.reset();
    scene.materials[0] = {};
    // A wall that passes the second slit's depth where x = 0.
    scene.meshes[0].object.points = {{-3, -3, -1.5}, {3, -3, 1.5}, {3, 5, 1.5}, {-3, 5, -1.5}};
    scene.meshes[0].object.triangles = {{0, 1, 2}, {0, 2, 3}};
    scene.meshes[0].object.material = {0, 0};
    CameraDescription& camera = scene.cameras[0];
    camera = {};
    camera.name = "main";
    camera.eye = {0, 1, 6}, camera.at = {0, 1, -3};
    camera.kind =
        CrossedSlitsCamera{.slits = {WorldLine{{0, 1, 5}, {0, 1, 0}}, WorldLine{{0, 1, 0}, {1, 0, 0}}},
                           .window = {-3, 3, -1, 1}};
    camera.facets = 16;
    const LineDrawing drawing = drawn(scene, "main", 0);
    std::size_t on_slit[2] = {0, 0};
    for (const LineDrawing::Caustic& caustic : drawing.caustics) {
        CHECK(caustic.path == "direct");
        CHECK(caustic.optic == kNone);
        CHECK(caustic.sheet.triangles.empty());
        CHECK_FALSE(caustic.sheet.segments.empty());
        for (const Vec3& p : caustic.sheet.points) {
            const bool first = std::hypot(p.x, p.z - 5) < 1e-9, second = std::hypot(p.y - 1, p.z) < 1e-9;
            CHECK((first || second));
            ++on_slit[second];
        }
    }
    CHECK(on_slit[0] > 100);
    CHECK(on_slit[1] > 100);
    // On the film the picture of the wall turns over where the wall passes the slit.
    REQUIRE(drawing.folds > 0);
    for (const FoldCurve& fold : drawing.fold_curves) {
        CHECK(fold.object == 0);
        for (std::size_t i = 0; i < fold.points.size(); ++i) {
            CHECK(fold.points[i].x == Approx(30).margin(1e-4));
            CHECK(length(fold.places[i] - Vec3(0, 1, 0)) < 1e-4);
        }
    }
    CHECK(drawing.svg.find("<g class=\"fold\" data-path=\"direct\"") != std::string::npos);

    Scene flat = inside_ball();
    Primitive plane;
    plane.kind = PlanePrimitive();
    plane.center = {0, 0, -1}, plane.axis = {0, 0, 1};
    flat.meshes[0].primitive = plane;
    CHECK(drawn(flat, "main", 4).caustics.empty());
}

TEST_CASE("the command writes caustics as an OBJ, and the shipped one is what it writes",
          "[laws][law][golden]") {
    const std::string folder = scratch_dir("caustic_of_cup");
    const std::string file = folder + "/caustic_of_cup.obj";
    const CommandRun run =
        run_trilens("render " + cup() +
                    " --camera source --rays interpolated --set /meshes/0/resolution=12 --json -o " + file);
    REQUIRE(run.exit_code == 0);
    const std::string fresh = bytes_of(file),
                      shipped = bytes_of(source_dir() + "/scenes/models/catacaustic.obj");
    const ObjCounts counts = counts_of(fresh);
    REQUIRE(counts.objects.size() > 2);
    CHECK(counts.objects[0] == "ring-reflect-first");
    CHECK(std::count(counts.objects.begin(), counts.objects.end(), "ring-reflect-fold-on-table") > 0);
    CHECK(counts.lines == counts.objects.size() - 1);
    CHECK(run.out.find("\"triangles\": " + std::to_string(counts.faces)) != std::string::npos);
    REQUIRE(shipped.size() > 1000);
    CHECK(counts_of(shipped).faces == counts.faces);
    std::stringstream ours(fresh), theirs(shipped);
    for (std::string a, b; ours >> a && theirs >> b;) {
        if (a == b) continue;
        REQUIRE(b.find_first_not_of("-+.e0123456789") == std::string::npos);
        CHECK(std::stod(a) == Approx(std::stod(b)).margin(1e-7));
    }

    const CommandRun refused = run_trilens("render " + cup() + " --engine classic -o " + folder + "/no.obj");
    CHECK(refused.exit_code == 2);
    CHECK(run_trilens("trace " + cup() + " -o " + folder + "/no.obj").exit_code == 2);
}
