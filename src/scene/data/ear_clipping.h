// A polygon in space cut into triangles between its corners.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "base/math/vec.h"

namespace trilens {

/// The n - 2 triangles of a polygon of n corners, as indices of its corners, wound as it is.
struct PolygonTriangles {
    std::vector<std::array<std::size_t, 3>> triangles;
    bool covers = true;  // false: no cut covers the polygon, and the triangles are its fan
};

/// Cuts a polygon of at least 3 corners with finite coordinates up to 1e30. Seen along Newell's normal, where
/// the triangles of the fan from corner 0 all keep the polygon's winding (so always where it is convex), they
/// are the answer; otherwise ears are clipped, the first from corner 0 on. A polygon that crosses itself, and
/// one without a plane, may have no such cut: then it is the fan, and `covers` is false. Corners are compared
/// on a grid of 2^-30 of the polygon's extent. Based on: Meisters, Polygons Have Ears (1975).
PolygonTriangles triangulate_polygon(std::span<const Vec3> corners);

}  // namespace trilens
