// A camera and lights for a glTF that has none: what viewers show then.
#include <algorithm>
#include <cmath>

#include "base/math/box.h"
#include "scene/imports/gltf_scene.h"

namespace trilens {

GltfStudio studio_of_gltf(const GltfModel& model, const std::string& file) {
    const PolygonMesh polygons = polygons_of_gltf(model, file, nullptr);
    Box box;
    for (const Vec3& point : polygons.cage.points) box.include(point);
    constexpr double kYfov = 40, kRadians = 3.14159265358979323846 / 180;
    const double radius = std::max(0.5 * length(box.size()), 1e-6);
    const double distance = radius / std::sin(0.5 * kYfov * kRadians);
    const Vec3 at = 0.5 * (box.low + box.high), eye = at + distance * normalize_or_zero(Vec3(0.5, 0.4, 1));
    return {
        Json::array(
            {{{"name", "whole"},
              {"type", "perspective"},
              {"yfov", kYfov},
              {"lookAt",
               {{"eye", Json{eye.x, eye.y, eye.z}}, {"at", Json{at.x, at.y, at.z}}, {"up", {0, 1, 0}}}}}}),
        Json::array({{{"name", "key"},
                      {"type", "directional"},
                      {"direction", {-0.45, -0.8, -0.4}},
                      {"intensity", 2.4},
                      {"shadows", true}},
                     {{"name", "fill"}, {"type", "ambient"}, {"color", {1, 1, 1}}, {"intensity", 0.35}}})};
}

}  // namespace trilens
