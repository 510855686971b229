// Spline patches of a scene: NURBS, uniform B-splines, bicubic Bezier and Coons patches, each turned exactly
// into the rational Bezier patches that it is made of, and those of objects into polygons.
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "base/math/vec.h"
#include "base/raymesh/rational_patch.h"
#include "base/util/names.h"
#include "scene/data/polygons.h"

namespace trilens {

enum class PatchKind { kBezier, kBspline, kCoons, kNurbs };

template <>
struct EnumNames<PatchKind> {
    static constexpr std::array kTable{NamedValue<PatchKind>{PatchKind::kBezier, "bezier"},
                                       NamedValue<PatchKind>{PatchKind::kBspline, "bspline"},
                                       NamedValue<PatchKind>{PatchKind::kCoons, "coons"},
                                       NamedValue<PatchKind>{PatchKind::kNurbs, "nurbs"}};
};

/// A bicubic Bezier patch: point 4 j + i, u along i and v along j.
using BezierPatch = std::array<Vec3, 16>;
using BezierCurve = std::array<Vec3, 4>;

/// The Coons patch, blended in both directions, of four cubic curves: the first two run along u, at v = 0 and
/// 1, the other two along v, at u = 0 and 1. Corners must agree. It is bicubic. [Coons, Surfaces for
/// Computer-Aided Design of Space Forms, 1967]
BezierPatch coons_patch(const std::array<BezierCurve, 4>& curves);

/// Control points of a NURBS surface, row by row, u along a row. [Piegl and Tiller, The NURBS Book, 1997]
struct SplineGrid {
    int columns = 4;
    std::vector<Vec3> points;
    std::vector<double> weights;                 // one per point, > 0; empty: all 1
    std::array<int, 2> degree{3, 3};             // along u and v, 1 .. kHighestPatchDegree
    std::array<std::vector<double>, 2> knots{};  // of either direction as many as points and the degree + 1

    int rows() const { return static_cast<int>(points.size()) / columns; }
};

/// A bicubic grid with knots at whole numbers: at least 4 x 4 points.
SplineGrid uniform_spline(int columns, std::vector<Vec3> points);
SplineGrid spline_of(const BezierPatch& patch);

/// What is wrong with the knots for so many points in their direction; empty: nothing. They must not fall,
/// and may stand at one place as often as the degree at most, once more at either end.
std::string knot_fault(const std::vector<double>& knots, int degree, int points);

/// The patches between the knots, row by row, each over the unit square. Knots have no fault.
std::vector<RationalPatch> beziers_of(const SplineGrid& spline);

/// The same surface with u running the other way.
void turn_around(SplineGrid& spline);

/// n x n quads per patch, triangles where an edge is one point, with the patch's normals and uv.
PolygonMesh patch_polygons(const std::vector<RationalPatch>& patches, int n);

/// How near edges lie whose ends and middles are this share of their length apart.
inline constexpr double kNearEdge = 0.01;

/// Edges that are joined to no other, as join_patches finds them; those that are one point do not count.
struct OpenEdges {
    std::size_t open = 0;
    std::size_t coincident = 0;  // of them: one of another patch is where it is, with other control points
    std::size_t near = 0;        // of the rest: those that lie near one of another patch, apart from it
};

OpenEdges find_open_edges(const std::vector<RationalPatch>& patches);

}  // namespace trilens
