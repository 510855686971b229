// A caustic as data: that the map's numbers agree with each other, and what it leaves out is said.
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "base/util/format.h"
#include "inverse/maps/caustic_map.h"
#include "support/lit_world.h"
#include "support/test.h"

using namespace trilens;
using namespace trilens_test;

namespace {

CausticMapRequest onto_object(Id object, int side) {
    CausticMapRequest request;
    request.target.kind = TargetKind::kObject;
    request.target.object = object;
    request.target.width = request.target.height = side;
    return request;
}

}  // namespace

TEST_CASE("light that a closed mirror holds stops after maxDepth, and never comes out",
          "[laws][law][caustics]") {
    const auto world = lit_world(R"({"name": "ball", "role": "optic", "material": "mirror", "resolution": 8,
        "primitive": {"type": "sphere", "center": [0, 1, 0], "radius": 0.8}})",
                                 R"({"type": "point", "position": [0, 1.1, 0], "intensity": 2})");
    const CausticMap map = make_caustic_map(*world, onto_object(0, 8));
    CHECK(map.flux_in.y == Approx(2 * 4 * 3.14159265358979).epsilon(1e-3));
    CHECK(map.flux_on_objects.y == 0);
    CHECK(map.flux_away.y == 0);
    CHECK(map.flux_received.y == 0);
    REQUIRE(map.warnings.size() == 1);
    CHECK(map.warnings[0].find("after maxDepth 4") != std::string::npos);
}

TEST_CASE("a lamp in a block of glass gives off the light that leaves it, and no ray slips out at an edge",
          "[laws][law][caustics]") {
    // Along each axis a ray in a box keeps its cosine: it leaves through faces across an axis to which it is
    // nearer than the critical angle, unless none is, and without Fresnel's law by all of its light.
    const double cosine = std::sqrt(1 - 1 / (1.5 * 1.5)), leaving = 6 * 2 * 3.14159265358979 * (1 - cosine);
    for (const double height : {0.5, 2.0})
        for (const bool turned : {false, true}) {
            const std::string block =
                R"({"name": "block", "role": "optic", "material": "glass", "resolution": 4,
                "subdivisionScheme": "bilinear", "points": [[-1, -1, -1], [-1, -1, 1], [-1, 1, -1], [-1, 1, 1],
                    [1, -1, -1], [1, -1, 1], [1, 1, -1], [1, 1, 1]], "faceVertexCounts": [4, 4, 4, 4, 4, 4],
                "faceVertexIndices": [0, 1, 3, 2, 4, 6, 7, 5, 0, 4, 5, 1, 2, 3, 7, 6, 0, 2, 6, 4, 1, 5, 7, 3],
                "transform": {"translate": [0, 1.5, 0], "scale": [1, )" +
                fmt::format("{}", height / 2) + R"(, 0.8], "rotate": {"axis": [0, 1, 0], "angle": )" +
                (turned ? "20" : "0") + "}}}";
            const auto world =
                lit_world(block, R"({"type": "point", "position": [0.2, 1.55, 0.1], "intensity": 1})");
            Scene scene = world->scene;
            scene.render.fresnel = false, scene.render.max_depth = 8;
            const CausticMap map = make_caustic_map(*make_world(scene, ignore), onto_object(0, 8));
            INFO(height << (turned ? ", turned" : ""));
            CHECK(map.flux_in.y == Approx(4 * 3.14159265358979).epsilon(1e-3));
            CHECK(map.flux_on_objects.y + map.flux_away.y == Approx(leaving).epsilon(1e-3));
        }
}

TEST_CASE("what a map says that ends on a floor comes to it where Fresnel's weights are steep",
          "[laws][law][caustics]") {
    const auto world = lit_world(R"({"name": "ball", "role": "optic", "material": "dim", "resolution": 8,
        "primitive": {"type": "sphere", "center": [0, 1, 0], "radius": 0.8}})",
                                 R"({"type": "point", "position": [0.5, 4, 1], "intensity": 20})");
    const CausticMap map = make_caustic_map(*world, onto_object(0, 32));
    CHECK(map.flux_received.y > 0.1);
    CHECK(map.flux_on_objects.y == Approx(map.flux_received.y).epsilon(3e-3));
}

TEST_CASE("what lies on a mirror's surface, or just inside of it, hides nothing of its light",
          "[laws][law][caustics]") {
    const auto ball = [](const std::string& name, const std::string& material, double radius) {
        return R"({"name": ")" + name + R"(", "role": "optic", "material": ")" + material +
               R"(", "resolution": 8, "primitive": {"type": "sphere", "center": [0, 2, 0], "radius": )" +
               fmt::format("{}", radius) + "}}";
    };
    const std::string mirror = ball("ball", "mirror", 0.8),
                      lamp = R"({"type": "point", "position": [0.3, 0.7, 1.5],
        "intensity": 20})";
    for (const std::string& optics :
         {mirror + "," + ball("silvered", "glass", 0.8), ball("silvered", "glass", 0.8) + "," + mirror,
          mirror + "," + ball("twin", "mirror", 0.8), mirror + "," + ball("thin", "glass", 0.8001)})
        for (const bool exact : {false, true}) {
            CausticMapRequest request = onto_object(0, 16);
            request.exact = exact;
            const CausticMap map = make_caustic_map(*lit_world(optics, lamp), request);
            INFO(optics << (exact ? ", exact" : ""));
            REQUIRE(map.flux_on_objects.y > 1);
            CHECK(map.flux_received.y == Approx(map.flux_on_objects.y).epsilon(2e-3));
        }
}

TEST_CASE("the light of a ball is the same in any unit of length, whatever lamp it is of",
          "[laws][law][caustics]") {
    // Radiance stays: irradiance of lamps that have an extent, too; that of points grows by the square.
    const auto text = [](const std::string& kind, double unit) {
        const auto at = [unit](double x, double y, double z) {
            return fmt::format("[{}, {}, {}]", unit * x, unit * y, unit * z);
        };
        const std::string size = kind == "rectangle"
                                     ? fmt::format(R"("size": [{}, {}],)", 0.5 * unit, 0.3 * unit)
                                     : fmt::format(R"("radius": {},)", 0.25 * unit);
        const std::string way = kind == "sphere" ? "" : R"("direction": [-0.1, -1, 0.1],)";
        return R"({"version": 1, "film": {"width": 8, "height": 8}, "cameras": [{"lookAt": {"eye": )" +
               at(0, 3, 6) +
               R"(, "at": [0, 0, 0]}}], "materials": [{"name": "matt"}, {"name": "mirror", "metallicFactor": 1}], "lights": [{"type": ")" +
               kind + "\", " + size + way + R"("position": )" + at(0.3, 2.4, 0.2) +
               R"(, "samples": 2, "caustics": true}], "meshes": [{"name": "floor", "role": "object", "material": "matt", "points": [)" +
               at(-2, 0, 2) + "," + at(2, 0, 2) + "," + at(2, 0, -2) + "," + at(-2, 0, -2) +
               R"(], "faceVertexCounts": [4], "faceVertexIndices": [0, 1, 2, 3]}, {"name": "ball", "role": "optic",
               "material": "mirror", "primitive": {"type": "sphere", "center": )" +
               at(0, 0.8, 0) + R"(, "radius": )" + fmt::format("{}", 0.6 * unit) + "}}]}";
    };
    for (const std::string kind : {"rectangle", "disk", "sphere"}) {
        const auto light = [&](double unit) {
            const auto world = make_world(parse_scene(text(kind, unit)), ignore);
            return make_caustic_map(*world, onto_object(0, 16)).irradiance;
        };
        const std::vector<Vec3> whole = light(1);
        const double brightest =
            std::max_element(whole.begin(), whole.end(), [](const Vec3& a, const Vec3& b) {
                return a.y < b.y;
            })->y;
        REQUIRE(brightest > 0);
        for (const double unit : {1e-6, 1e-3, 1e3}) {
            const std::vector<Vec3> scaled = light(unit);
            double off = 0;
            for (std::size_t i = 0; i < whole.size(); ++i)
                off = std::max(off, std::fabs(scaled[i].y - whole[i].y) / brightest);
            INFO(kind << " in units of " << unit << ": off by " << off);
            CHECK(off < 1e-6);
        }
    }
}

TEST_CASE("with the tolerance a map comes nearer to the truth, also where histories end",
          "[laws][law][caustics]") {
    const auto world =
        lit_world(R"({"name": "ring", "role": "optic", "material": "mirror", "resolution": 8,
        "primitive": {"type": "cylinder", "center": [0, 0.4, 0], "axis": [0, 1, 0], "radius": 2, "height": 0.8}})",
                  R"({"type": "directional", "direction": [-0.85, -0.6, -0.35], "intensity": 2})");
    CausticMapRequest request = onto_object(0, 96);
    const auto map = [&](double tolerance, bool exact) {
        request.tolerance = tolerance;
        request.exact = exact;
        return make_caustic_map(*world, request).irradiance;
    };
    const std::vector<Vec3> truth = map(1e-3, true);
    const auto error = [&](double tolerance) {
        const std::vector<Vec3> light = map(tolerance, false);
        double square = 0;
        for (std::size_t i = 0; i < light.size(); ++i) square += std::pow(light[i].y - truth[i].y, 2);
        return std::sqrt(square / static_cast<double>(light.size()));
    };
    const double usual = error(1e-3), fine = error(1e-3 / 16);
    CAPTURE(usual, fine);
    CHECK(usual < 2e-3);
    CHECK(fine < usual / 3);
}

TEST_CASE("traced pictures have borders of histories nearer to their places than others",
          "[laws][law][caustics]") {
    LitWorld ring(lit_world(R"({"name": "ring", "role": "optic", "material": "mirror", "resolution": 8,
        "primitive": {"type": "cylinder", "center": [0, 0.4, 0], "axis": [0, 1, 0], "radius": 2, "height": 0.8}})",
                            R"({"type": "directional", "direction": [-0.85, -0.6, -0.35], "intensity": 2,
        "caustics": true})"),
                  BeamGridParams::truth(1e-3 / 8));
    constexpr int kSide = 24;
    const double step = 4.0 / kSide;
    const auto light = [&](const std::vector<std::unique_ptr<BeamLight>>& beams) {
        std::vector<double> found;
        for (int i = 0; i < kSide * kSide; ++i) {
            Receiver there = on_floor(step * (i % kSide + 0.5) - 2, step * (i / kSide + 0.5) - 2);
            there.sides = {Vec3(step, 0, 0), Vec3(0, 0, step)};
            there.exact = true;
            found.push_back(irradiance(beams, there).y);
        }
        return found;
    };
    const std::vector<double> truth = light(ring.lights);
    const auto error = [&](bool exact) {
        const std::vector<double> found = light(caustic_lights(*ring.world, exact).by_light[0]);
        double square = 0;
        for (std::size_t i = 0; i < found.size(); ++i) square += std::pow(found[i] - truth[i], 2);
        return std::sqrt(square / static_cast<double>(found.size()));
    };
    const double usual = error(false), exact = error(true);
    CAPTURE(usual, exact);
    CHECK(exact < usual / 3);
    CHECK(exact < 1e-3);
}

TEST_CASE("a map that no optic brings light to says so", "[laws][caustics]") {
    const auto world = lit_world(R"({"name": "thing", "role": "object", "material": "white",
        "primitive": {"type": "sphere", "center": [0, 1, 0], "radius": 0.5}})",
                                 kLamp);
    const CausticMap map = make_caustic_map(*world, onto_object(0, 8));
    CHECK(map.flux_received.y == 0);
    REQUIRE(map.warnings.size() == 1);
    CHECK(map.warnings[0] == "no light of light 0 comes to an optic: the map is dark");
}

TEST_CASE("a map onto faces that share texture coordinates says so", "[laws][caustics]") {
    const std::string ball = R"({"name": "ball", "role": "optic", "material": "glass", "resolution": 8,
        "primitive": {"type": "sphere", "center": [0, 2.5, 0], "radius": 0.5}})";
    for (const char* shape : {"box", "sphere"}) {
        const bool is_box = shape == std::string("box");
        const std::string size = is_box ? R"("center": [0, 0.6, 0], "size": [2, 0.8, 2])"
                                        : R"("center": [0, 1, 0], "radius": 0.5)";
        const auto world = lit_world(ball + R"(, {"name": "thing", "role": "object", "material": "white",
            "primitive": {"type": ")" + shape +
                                         "\", " + size + "}}",
                                     kLamp);
        const std::vector<std::string> warnings = make_caustic_map(*world, onto_object(2, 8)).warnings;
        const bool says = std::any_of(warnings.begin(), warnings.end(), [](const std::string& one) {
            return one.find("share texture coordinates") != std::string::npos;
        });
        CAPTURE(shape);
        CHECK(says == is_box);
    }
}
