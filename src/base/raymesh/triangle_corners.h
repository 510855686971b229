// The corners of a triangle of a scene.
#pragma once

#include <array>
#include <cstddef>

#include "base/raymesh/triangle_scene.h"

namespace trilens {

inline std::array<Vec3, 3> corners_of(const TriangleScene& scene, std::size_t triangle) {
    const IdTriple& corner = scene.triangles[triangle];
    return {scene.points[corner[0]], scene.points[corner[1]], scene.points[corner[2]]};
}

}  // namespace trilens
