// Light over a mirror a part of which lies before another: it is as over two mirrors.
#include <cmath>
#include <string>

#include "base/math/luminance.h"
#include "inverse/maps/caustic_map.h"
#include "shade/shade.h"
#include "support/draw.h"
#include "support/lit_world.h"

using namespace trilens;
using namespace trilens_test;

namespace {

const std::string kWall = "[-1.5,0.2,-1.5],[1.5,0.2,-1.5],[1.5,1.8,-1.5],[-1.5,1.8,-1.5]";
const std::string kPane = "[-0.4,0.6,-0.5],[0.6,0.65,-0.45],[0.6,1.2,-0.6],[-0.4,1.15,-0.65]";

std::string mirror(const std::string& name, const std::string& points, int quads) {
    std::string counts = "4", indices = "0,1,2,3";
    if (quads == 2) counts += ",4", indices += ",4,5,6,7";
    return R"({"name": ")" + name +
           R"(", "role": "optic", "material": "mirror", "subdivisionScheme": "none", "points": [)" + points +
           R"(], "faceVertexCounts": [)" + counts + R"(], "faceVertexIndices": [)" + indices + "]}";
}

Receiver square_on_floor(double x, double z, double side) {
    Receiver receiver = on_floor(x, z);
    receiver.sides = {Vec3(side, 0, 0), Vec3(0, 0, -side)};
    return receiver;
}

/// That falls on the floor, square by square.
double flux(const LitWorld& lit) {
    constexpr double kSide = 0.1;
    double sum = 0;
    for (int j = -50; j < 50; ++j)
        for (int i = -50; i < 50; ++i)
            sum += luminance(
                irradiance(lit.lights, square_on_floor((i + 0.5) * kSide, (j + 0.5) * kSide, kSide)));
    return kSide * kSide * sum;
}

}  // namespace

TEST_CASE("light over a mirror that lies before itself is that over two mirrors", "[laws][law][caustics]") {
    const LitWorld one(lit_world(mirror("both", kWall + "," + kPane, 2), kLamp));
    const LitWorld two(lit_world(mirror("wall", kWall, 1) + ", " + mirror("pane", kPane, 1), kLamp));
    for (const auto& light : one.lights) CHECK(light->losses().coarse == 0);
    CHECK(flux(one) == Approx(flux(two)).epsilon(5e-4));

    Draw draw(3);
    double mean = 0, off = 0;
    int lit = 0, wrong = 0;
    for (int i = 0; i < 4000; ++i) {
        const Vec3 at = draw.in_cube(2.5);
        const Receiver square = square_on_floor(at.x, at.z, 0.02);
        const double by_one = luminance(irradiance(one.lights, square)),
                     by_two = luminance(irradiance(two.lights, square));
        if (by_two > 0) ++lit;
        mean += by_two, off += std::fabs(by_one - by_two);
        wrong += std::fabs(by_one - by_two) > 0.01;
    }
    CHECK(lit > 1000);
    CHECK(off < 5e-3 * mean);
    CHECK(wrong < 15);
}

TEST_CASE("light that turns around in a ring more often than any corner's is found at the border",
          "[laws][law][caustics]") {
    const std::string
        ring = R"({"name": "ring", "role": "optic", "material": "mirror", "resolution": 24,
        "primitive": {"type": "cylinder", "center": [0, 0.2, 0], "axis": [0, 1, 0], "radius": 1, "height": 0.4}})",
        sun =
            R"({"type": "directional", "direction": [-0.85, -0.6, -0.35], "intensity": 2, "caustics": true})";
    BeamGridParams fine;
    fine.tolerance = 6e-5;
    const LitWorld usual(lit_world(ring, sun)), much(lit_world(ring, sun), fine);
    CHECK(usual.light().beams().histories.size() == 5);
    CHECK(flux(usual) == Approx(flux(much)).epsilon(4e-4));
}

// Each ball shows the others in bands, and those in narrower bands, that no corner of the light's film needs
// to lie in.
TEST_CASE("no light is lost between three mirror balls", "[laws][law][caustics][thorough]") {
    std::string balls;
    for (const char* center : {"-0.62,0.8,0", "0.62,0.8,0", "0,0.8,-1.05"})
        balls +=
            (balls.empty() ? "" : ", ") +
            (R"({"name": "ball )" + std::string(center) +
             R"(", "role": "optic", "material": "mirror", "resolution": 8, "primitive": {"type": "sphere", "center": [)") +
            center + R"(], "radius": 0.6}})";
    std::unique_ptr<World> world = lit_world(
        balls, R"({"type": "point", "position": [1.6, 4.2, 1.4], "intensity": 26, "caustics": true})");
    world->scene.render.max_depth = 8;
    CausticMapRequest request;
    request.target.kind = TargetKind::kObject;
    request.target.object = 0;
    request.target.width = request.target.height = 24;
    const CausticMap map = make_caustic_map(*world, request);
    CHECK(map.flux_in.y > 1);
    CHECK(std::fabs(map.flux_on_objects.y + map.flux_away.y - map.flux_in.y) < 1e-3 * map.flux_in.y);
    // What is said to end on the floor comes to it.
    CHECK(map.flux_received.y == Approx(map.flux_on_objects.y).epsilon(1e-3));
}
