// Calibrated cameras behind ports: images of points where rays that are refracted by hand end, and what is
// refused.
#include <cmath>
#include <random>

#include "base/util/error.h"
#include "json/json.h"
#include "render/project/project.h"
#include "render/world/world.h"
#include "scene/imports/housing.h"
#include "scene/load.h"
#include "support/test.h"

using namespace trilens;

namespace {

/// Snell's law: d and n unit, d . n > 0.
Vec3 snell_refracted(const Vec3& d, const Vec3& n, double ratio) {
    const double cosine = dot(d, n);
    return ratio * d + (std::sqrt(1 - ratio * ratio * (1 - cosine * cosine)) - ratio * cosine) * n;
}

struct PortNumbers {
    bool dome;
    Vec3 at;
    double inside, thickness, air, glass, water;
};

/// The ray in the water that a direction from the origin becomes: by plane or sphere and Snell's law.
Ray ray_through_port(const PortNumbers& port, const Vec3& direction) {
    Ray ray{Vec3(0), normalize(direction)};
    double from = port.air;
    for (const auto& [distance, to] :
         {std::pair(port.inside, port.glass), std::pair(port.inside + port.thickness, port.water)}) {
        Vec3 normal = normalize(port.at);
        if (port.dome) {
            const Vec3 q = ray.origin - port.at;
            const double b = dot(q, ray.direction);
            ray.origin += (-b + std::sqrt(b * b - dot(q, q) + distance * distance)) * ray.direction;
            normal = (ray.origin - port.at) / distance;
        } else {
            ray.origin += (distance - dot(ray.origin, normal)) / dot(ray.direction, normal) * ray.direction;
        }
        ray.direction = snell_refracted(ray.direction, normal, from / to);
        from = to;
    }
    return ray;
}

double worst_port_pixel(const std::string& text, const std::string& file, const PortNumbers& port,
                        const Vec2& focal, const Vec2& middle) {
    const Json json = scene_of_housing(text, file);
    const auto world = make_world(load_scene_text(json.dump(), SceneSource(file), {}, {}), {});
    std::mt19937 random(7);
    std::uniform_real_distribution<double> unit(0, 1);
    std::vector<Vec3> points;
    std::vector<Vec2> pixels;
    for (int i = 0; i < 200; ++i) {
        pixels.emplace_back(2 * middle.x * unit(random), 2 * middle.y * unit(random));
        const Ray ray = ray_through_port(port, Vec3((pixels.back() - middle) / focal, 1));
        points.push_back(ray.origin + (0.2 + 3 * unit(random)) * ray.direction);
    }
    ProjectRequest request;
    request.path = EventWord("TT");
    const std::vector<PointProjection> found = project_points(*world, request, points);
    double worst = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
        double nearest = 1e9;
        for (const WorldImage& image : found[i].images)
            nearest = std::min(nearest, length(image.pixel - pixels[i]));
        // Images over several surfaces are looked for from facets that end where the film does, and show
        // things a little off their place: at its very edge one may be missed, none be wrong.
        const Vec2 to_edge = glm::min(pixels[i], 2.0 * middle - pixels[i]);
        if (found[i].images.empty() && std::min(to_edge.x, to_edge.y) < 0.1) continue;
        worst = std::max(worst, nearest);
    }
    return worst;
}

constexpr const char* kFlatPort =
    "model: PINHOLE\n# fx, fy, cx, cy\nparameters: [860, 850, 640, 512]\nnon_svp_model: FLATPORT\n"
    "non_svp_parameters: [0.098, -0.05, 0.994, 0.02, 0.014, 1.003, 1.473, 1.333]\nwidth: 1280\nheight: "
    "1024\n";
constexpr const char* kDomePort =
    "# Camera list\n7 SIMPLE_PINHOLE 1000 800 700 500 400 DOMEPORT 0.004 -0.003 -0.02 0.0501 0.007 1.003 "
    "1.473 1.333\n";

}  // namespace

TEST_CASE("points behind a flat and a dome port are seen where Snell's law by hand has them",
          "[scene][oracle]") {
    CHECK(worst_port_pixel(kFlatPort, "calibration.yaml",
                           {false, {0.098, -0.05, 0.994}, 0.02, 0.014, 1.003, 1.473, 1.333}, {860, 850},
                           {640, 512}) < 1e-8);
    CHECK(worst_port_pixel(kDomePort, "cameras.txt",
                           {true, {0.004, -0.003, -0.02}, 0.0501, 0.007, 1.003, 1.473, 1.333}, {700, 700},
                           {500, 400}) < 1e-8);
}

TEST_CASE("calibrations that cannot be used are refused with their line", "[scene][bad-input]") {
    const auto replaced = [](std::string text, const std::string& from, const std::string& to) {
        return text.replace(text.find(from), from.size(), to);
    };
    const auto message = [](const std::string& text, const std::string& file) -> std::string {
        try {
            scene_of_housing(text, file);
        } catch (const InputError& error) {
            return error.what();
        }
        return "";
    };
    const std::string flat = kFlatPort, dome = kDomePort;
    CHECK(message(replaced(flat, "PINHOLE", "PINNHOLE"), "c.yaml")
              .starts_with("c.yaml: line 1: there is no camera"));
    CHECK(message(replaced(flat, "512]", "512, 3]"), "c.yaml") ==
          "c.yaml: line 3: a camera PINHOLE has 4 parameters, not 5");
    CHECK(message(replaced(flat, "512]", "x]"), "c.yaml") == "c.yaml: line 3: \"x\" is no number");
    CHECK(message(replaced(flat, "FLATPORT", "ROUNDPORT"), "c.yaml") ==
          "c.yaml: line 4: there is no port \"ROUNDPORT\"; known: FLATPORT, DOMEPORT");
    CHECK(message(replaced(flat, ", 1.333]", "]"), "c.yaml") ==
          "c.yaml: line 4: a port has 8 numbers, not 7");
    CHECK(message(replaced(flat, "0.994", "-0.994"), "c.yaml") ==
          "c.yaml: line 4: a flat port's normal looks away from the camera: Nz > 0");
    CHECK(message("width: 3\n", "c.yaml") == "c.yaml: has no \"model\": it is no calibration of Calibmar's");
    CHECK(message("", "cameras.txt") == "cameras.txt: has no cameras");
    CHECK(message(replaced(dome, "-0.02 ", "-0.2 "), "cameras.txt") ==
          "cameras.txt: line 2: the camera stands outside of its dome");
    CHECK(message(dome + "8 SIMPLE_PINHOLE 1000 800 700 500 400\n", "cameras.txt") ==
          "cameras.txt: line 3: has another port than the camera before: a scene has one; give each a file "
          "of its own");
    CHECK(message(flat, "c.yaml").empty());
    CHECK(message(dome, "cameras.txt").empty());
}
