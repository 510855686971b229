// A floor, one optic and one light, whose light over the optic is followed.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "render/world/world.h"
#include "study/scenes.h"
#include "support/test.h"

namespace trilens_test {

using namespace trilens;

inline constexpr const char* kFloor =
    R"({"name": "floor", "role": "object", "material": "white", "points": [[-6,0,6],[6,0,6],[6,0,-6],[-6,0,-6]],
        "faceVertexCounts": [4], "faceVertexIndices": [0,1,2,3]})";

/// A scene with a floor at y = 0, one optic and one light; the camera stands where the light does.
inline std::unique_ptr<World> lit_world(const std::string& optic, const std::string& light,
                                        const Vec3& eye = {0, 4, 3}) {
    const std::string text =
        R"({"version": 1, "film": {"width": 64, "height": 64},
            "cameras": [{"yfov": 60, "lookAt": {"eye": [)" +
        std::to_string(eye.x) + "," + std::to_string(eye.y) + "," + std::to_string(eye.z) +
        R"(], "at": [0, 0.5, 0]}}],
            "materials": [{"name": "white"}, {"name": "mirror", "metallicFactor": 1},
                {"name": "dim", "metallicFactor": 1, "baseColorFactor": [0.3, 0.3, 0.3]}, {"name": "glass", "transmissionFactor": 1, "ior": 1.5},
                {"name": "veil", "alphaMode": "blend", "alphaFactor": 0.25}, {"name": "smoke", "alphaMode": "blend", "alphaFactor": 0.5}],
            "meshes": [)" +
        kFloor + ", " + optic + R"(], "lights": [)" + light + R"(], "render": {"maxDepth": 4}})";
    return make_world(parse_scene(text), ignore);
}

inline const std::string kLamp =
    R"({"type": "point", "position": [0, 4, 3], "intensity": 10, "caustics": true})";

inline Receiver on_floor(double x, double z) {
    const Vec3 up(0, 1, 0), point(x, 0, z);
    return {point, up, up, point + 1e-5 * up, {}};
}

struct LitWorld {
    std::unique_ptr<World> world;
    PathWorld optics;
    std::vector<std::unique_ptr<BeamLight>> lights;

    explicit LitWorld(std::unique_ptr<World> made, const BeamGridParams& params = {})
        : world(std::move(made)),
          optics(optics_for_lights(*world)),
          lights(make_beam_lights(*world, optics, 0, params)) {}
    const BeamLight& light() const { return *lights.front(); }
};

}  // namespace trilens_test
