// Colours at points are factors of the base colour, straight over each triangle: against the formula at what
// every pixel sees, directly and in a mirror, for projector and truth alike.
#include <string>

#include "laws/pictures.h"
#include "laws/worlds.h"
#include "render/picture/picture.h"
#include "support/test.h"

using namespace trilens;
using namespace trilens_test;

namespace {

/// A wall of two triangles at z, from -8 to 8, whose colour is straight over it: red grows with x, green with
/// y, and so does alpha with x. `material`: its keys.
std::string wall_scene(const std::string& material, double z, const std::string& mirror) {
    const std::string depth = std::to_string(z);
    const auto point = [&](const char* xy) { return "[" + std::string(xy) + "," + depth + "]"; };
    return R"({"version": 1, "film": {"width": 16, "height": 12},
        "cameras": [{"name": "main", "yfov": 40,
                     "lookAt": {"eye": [0, 0, 4], "at": [0, 0, 0], "up": [0, 1, 0]}}],
        "background": {"color": [0.25, 0.25, 0.25]}, "render": {"fresnel": false},
        "materials": [{"name": "chrome", "metallicFactor": 1}, {"name": "paint", "baseColorFactor": [0.5, 1, 0.75])" +
           material + R"(}],
        "meshes": [{"name": "wall", "role": "object", "material": "paint", "points": [)" +
           point("-8,-8") + "," + point("8,-8") + "," + point("8,8") + "," + point("-8,8") + R"(],
            "faceVertexCounts": [4], "faceVertexIndices": [0, 1, 2, 3],
            "colors": [[0, 0, 0.2, 0], [1, 0, 0.2, 1], [1, 1, 0.2, 1], [0, 1, 0.2, 0]]})" +
           mirror + "]}";
}

const char* const kFlatMirror = R"(, {"name": "mirror", "role": "optic", "material": "chrome", "primitive":
    {"type": "plane", "center": [0, 0, 0], "normal": [0, 0, 1], "tangent": [1, 0, 0], "size": [60, 60]}})";

/// The colour of the wall at a point.
Vec3 painted(double x, double y) {
    return {0.5 * (x + 8) / 16, (y + 8) / 16, 0.75 * 0.2};
}

double value_at(const Image& image, const char* channel, std::size_t pixel) {
    return double{image.find(channel)->floats()[pixel]};
}

constexpr Engine kThreeEngines[] = {Engine::kExact, Engine::kFacetsTruth, Engine::kLimitTruth};

}  // namespace

TEST_CASE("colours at points: what a mirror shows of a wall has the formula's colour at each point",
          "[laws][law]") {
    // In a mirror at z = 0, of a wall behind the camera.
    const auto world = world_from("wall", wall_scene(R"(, "unlit": true)", 6, kFlatMirror), 4);
    for (const Engine engine : kThreeEngines) {
        INFO("engine " << static_cast<int>(engine));
        const Image image = drawn_by(*world, 1, engine);
        for (std::size_t pixel = 0; pixel < 16 * 12; ++pixel) {
            const Vec3 expected =
                painted(value_at(image, "reflectP.X", pixel), value_at(image, "reflectP.Y", pixel));
            CHECK(value_at(image, "R", pixel) == Approx(expected.x).margin(1e-6));
            CHECK(value_at(image, "G", pixel) == Approx(expected.y).margin(1e-6));
            CHECK(value_at(image, "B", pixel) == Approx(expected.z).margin(1e-6));
        }
    }
    // With several samples a pixel shows the mean, which is what its middle shows of what is straight.
    const Image one = drawn_by(*world, 1, Engine::kLimitTruth);
    for (const Engine engine : kThreeEngines) {
        const Image many = drawn_by(*world, 4, engine);
        for (std::size_t pixel = 0; pixel < 16 * 12; ++pixel)
            CHECK(value_at(many, "R", pixel) == Approx(value_at(one, "R", pixel)).margin(1e-5));
    }
}

TEST_CASE("colours at points: a matt wall reflects their share of light, a blended one hides by their alpha",
          "[laws]") {
    const std::string lamp = R"(], "lights": [{"type": "ambient", "color": [0.5, 0.5, 0.5]})";
    const auto matt = world_from("wall", wall_scene("", -2, lamp), 4);
    const auto unlit = world_from("wall", wall_scene(R"(, "unlit": true)", -2, ""), 4);
    const auto blended =
        world_from("wall", wall_scene(R"(, "unlit": true, "alphaMode": "blend")", -2, ""), 4);
    REQUIRE(blended->blended);
    const Image plain = drawn_by(*unlit, 1, Engine::kExact);
    for (const Engine engine : kThreeEngines) {
        const Image dim = drawn_by(*matt, 1, engine), through = drawn_by(*blended, 1, engine);
        for (std::size_t pixel = 0; pixel < 16 * 12; ++pixel) {
            CHECK(value_at(dim, "G", pixel) == Approx(0.5 * value_at(plain, "G", pixel)).margin(1e-6));
            const double alpha = value_at(plain, "R", pixel) / 0.5;  // both grow with x alone
            CHECK(value_at(through, "G", pixel) ==
                  Approx(alpha * value_at(plain, "G", pixel) + (1 - alpha) * 0.25).margin(1e-6));
        }
    }
}
