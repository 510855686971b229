// What tests of scenes of patches share: such scenes as text, and places on patches.
#pragma once

#include <string>
#include <vector>

#include "scene/data/patches.h"

namespace trilens_test {

using namespace trilens;

inline SurfacePoint on_first(const RationalPatch& patch, const Vec2& uv) {
    return evaluate(patch, uv, extent_of(patch));
}
/// On the one patch that it is.
inline SurfacePoint on_first(const BezierPatch& patch, const Vec2& uv) {
    return on_first(beziers_of(spline_of(patch)).at(0), uv);
}

inline std::string numbers(const std::vector<Vec3>& points) {
    std::string text;
    for (const Vec3& p : points)
        text += (text.empty() ? "[" : ", [") + std::to_string(p.x) + ", " + std::to_string(p.y) + ", " +
                std::to_string(p.z) + "]";
    return "[" + text + "]";
}

inline std::string patch_scene(const std::string& patches, const std::string& mesh = R"("role": "object")") {
    return R"({"version": 1, "cameras": [{"yfov": 40, "lookAt": {"eye": [0, 1, 4], "at": [0, 0, 0]}}],
        "materials": [{"name": "glass", "transmissionFactor": 1},
                      {"name": "chrome", "metallicFactor": 1, "roughnessFactor": 0}],
        "meshes": [{"name": "sheet", )" +
           mesh + ", \"patches\": [" + patches + "]}]}";
}

inline std::string bezier_text(const BezierPatch& patch) {
    return R"({"type": "bezier", "points": )" + numbers({patch.begin(), patch.end()}) + "}";
}

}  // namespace trilens_test
