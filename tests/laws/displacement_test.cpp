// Displaced surfaces are surfaces as any: projected as traced, and where a map is even the same as a mesh
// that stands there.
#include <set>
#include <string>

#include "laws/pictures.h"
#include "laws/worlds.h"
#include "render/picture/picture.h"
#include "support/test.h"

using namespace trilens;
using namespace trilens_test;

namespace {

/// A mirror, flat or pressed, of 8 x 8 quads in the plane z = `z`, seen from z = 3 before a ball at z = 6.
std::unique_ptr<World> pressed_mirror(double z, const std::string& pressed, const std::string& of_ball) {
    std::string points, indices, uvs, counts;
    for (int y = 0; y <= 8; ++y)
        for (int x = 0; x <= 8; ++x) {
            const std::string comma = points.empty() ? "" : ",";
            points += comma + "[" + std::to_string(0.5 * x - 2) + "," + std::to_string(0.5 * y - 2) + "," +
                      std::to_string(z) + "]";
            uvs += comma + "[" + std::to_string(x / 8.0) + "," + std::to_string(y / 8.0) + "]";
        }
    for (int y = 0; y < 8; ++y)
        for (int x = 0; x < 8; ++x) {
            const int first = 9 * y + x;
            const std::string comma = counts.empty() ? "" : ",";
            counts += comma + "4";
            indices += comma + std::to_string(first) + "," + std::to_string(first + 1) + "," +
                       std::to_string(first + 10) + "," + std::to_string(first + 9);
        }
    return world_from(
        "pressed mirror",
        R"({"version": 1, "film": {"width": 48, "height": 36},
        "cameras": [{"name": "main", "yfov": 40,
                     "lookAt": {"eye": [0.2, 0.1, 3], "at": [0, 0, 0], "up": [0, 1, 0]}}],
        "background": {"color": [0.3, 0.4, 0.6]},
        "materials": [{"name": "chrome", "metallicFactor": 1}, {"name": "clay", "baseColorFactor": [0.7, 0.4, 0.3]}],
        "meshes": [{"name": "mirror", "role": "optic", "material": "chrome", "points": [)" +
            points + R"(], "faceVertexCounts": [)" + counts + R"(], "faceVertexIndices": [)" + indices +
            R"(], "uvs": [)" + uvs + R"(], "uvIndices": [)" + indices + "]" + pressed +
            R"(}, {"name": "ball", "role": "object", "material": "clay", "primitive": {"type": "sphere",
                     "center": [0, 0, 6], "radius": 2})" +
            of_ball + R"(}],
        "lights": [{"type": "directional", "direction": [-1, -1, 2], "shadows": true}]})",
        8);
}

const std::string kDimpled =
    R"(, "displacement": {"map": {"pattern": "dimples", "count": [12, 6]}, "scale": 0.3, "subdivide": 4})";

}  // namespace

TEST_CASE("displaced mirrors and objects are projected as they are traced, every id the same",
          "[laws][law]") {
    const auto world = pressed_mirror(
        0, R"(, "displacement": {"map": {"pattern": "ripples", "count": [2, 1]}, "scale": 0.2})", kDimpled);
    const Image projected = drawn_by(*world, 1, Engine::kExact),
                traced = drawn_by(*world, 1, Engine::kFacetsTruth);
    const std::vector<std::uint32_t>& ids = projected.find("reflectID.primitive")->ids();
    CHECK(ids == traced.find("reflectID.primitive")->ids());
    CHECK(projected.find("reflectID.object")->ids() == traced.find("reflectID.object")->ids());
    CHECK(picture_error(projected, traced).rms < 1e-6);
    std::set<std::uint32_t> seen(ids.begin(), ids.end());
    CHECK(seen.size() > 100);
    // The exact surface shows nearly the same.
    CHECK(picture_error(projected, drawn_by(*world, 1, Engine::kLimitTruth)).rms < 0.05);
}

TEST_CASE("a mirror displaced by an even map is the mirror moved, and by zero the mirror itself",
          "[laws][law]") {
    const std::string even =
        R"(, "displacement": {"map": {"pattern": "ramp", "colors": [[1, 1, 1], [1, 1, 1]]}, "scale": )";
    const auto moved = pressed_mirror(0.25, "", ""), displaced = pressed_mirror(0, even + "0.25}", ""),
               flat = pressed_mirror(0, "", ""), unmoved = pressed_mirror(0, even + "0}", even + "0}");
    for (const Engine engine : {Engine::kExact, Engine::kFacetsTruth, Engine::kLimitTruth}) {
        CHECK(picture_error(drawn_by(*moved, 1, engine), drawn_by(*displaced, 1, engine)).rms < 1e-5);
        const Image before = drawn_by(*flat, 1, engine), after = drawn_by(*unmoved, 1, engine);
        for (const char* channel : {"R", "G", "B", "Z", "reflectP.X"})
            CHECK(before.find(channel)->floats() == after.find(channel)->floats());
        CHECK(picture_error(before, drawn_by(*displaced, 1, engine)).rms > 1e-3);
    }
}
