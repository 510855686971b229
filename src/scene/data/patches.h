// Spline patches of a scene: bicubic Bezier patches, uniform B-splines and Coons patches, each turned exactly
// into the cage whose limit surface it is, or into polygons.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "base/description/optic_description.h"
#include "base/math/box.h"
#include "base/math/vec.h"
#include "base/raymesh/surface.h"
#include "base/util/names.h"
#include "scene/data/polygons.h"

namespace trilens {

enum class PatchKind { kBezier, kBspline, kCoons };

template <>
struct EnumNames<PatchKind> {
    static constexpr std::array kTable{NamedValue<PatchKind>{PatchKind::kBezier, "bezier"},
                                       NamedValue<PatchKind>{PatchKind::kBspline, "bspline"},
                                       NamedValue<PatchKind>{PatchKind::kCoons, "coons"}};
};

/// A bicubic Bezier patch: point 4 j + i, u along i and v along j.
using BezierPatch = std::array<Vec3, 16>;
using BezierCurve = std::array<Vec3, 4>;

/// Rows of control points of a uniform bicubic B-spline, at least 4 x 4: (columns - 3) x (rows - 3) patches.
struct SplineGrid {
    int columns = 4;
    std::vector<Vec3> points;

    int rows() const { return static_cast<int>(points.size()) / columns; }
};

/// The Coons patch, blended in both directions, of four cubic curves: the first two run along u, at v = 0 and
/// 1, the other two along v, at u = 0 and 1. Corners must agree. It is bicubic. [Coons, Surfaces for
/// Computer-Aided Design of Space Forms, 1967]
BezierPatch coons_patch(const std::array<BezierCurve, 4>& curves);

/// The one patch as a B-spline of 4 x 4 points.
SplineGrid spline_of(const BezierPatch& patch);
/// The patches of a B-spline, row by row.
std::vector<BezierPatch> beziers_of(const SplineGrid& spline);

/// Position and derivatives, the normal where du x dv has one, zero elsewhere.
SurfacePoint evaluate(const BezierPatch& patch, const Vec2& uv);

/// The cage whose limit surface the splines are: faces along borders are holes, for a border that is not
/// interpolated has no limit.
Cage spline_cage(const std::vector<SplineGrid>& splines);

/// The box of the Bezier points of a spline_cage's patches, which holds them.
Box patch_bounds(const Cage& cage);

/// n x n quads per patch, triangles where an edge is one point, with the patch's normals and uv.
PolygonMesh patch_polygons(const std::vector<BezierPatch>& patches, int n);

/// Edges that no other edge runs along, point by point, in either direction; those that are one point do not
/// count. Tolerance: kSameControl.
std::size_t count_open_edges(const std::vector<BezierPatch>& patches);
inline constexpr double kSameControl = 1e-9;  // of the largest side of the box of all points

}  // namespace trilens
