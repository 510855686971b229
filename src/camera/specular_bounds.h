// What bounds of a surface say about images: that a cell holds none, or at most one.
#pragma once

#include "base/surface.h"
#include "camera/specular_point.h"

namespace trilens {

/// A piece of surface by a ball around its positions and one around its unit normals.
struct PlaceBounds {
    Vec3 position{0};  // world frame
    double position_radius = 0;
    Vec3 normal{0};  // unit
    double normal_radius = 2;
};

PlaceBounds place_of(const SurfaceBounds& bounds);

/// True only if the piece holds no image: everywhere it lies behind the camera, or eye and point lie on wrong
/// sides of it, or h = n1 e + n2 x cannot be parallel to the normal.
bool holds_no_image(const SpecularQuery& query, const PlaceBounds& place);

/// The interval Newton operator in Krawczyk's form (Neumaier, Interval Methods for Systems of Equations,
/// chapter 5) on a cell of a face, in parameters from the cell's middle: every zero of (h . du, h . dv) in
/// the cell lies within `spread` of `step`.
struct NewtonBounds {
    bool known = false;  // else the bounds say nothing
    Vec2 step{0};        // Newton's step from the middle
    Vec2 spread{0};      // for zeros anywhere in the cell; in proportion to their distance from the start
    Vec2 rounding{0};    // how far rounding moves a zero
    Mat2 inverse{0};     // of the Jacobian at the middle
};

/// `half`: half the cell's sides. For own normals.
NewtonBounds newton_bounds(const SpecularQuery& query, const SurfaceBounds& bounds, const Vec2& half);

}  // namespace trilens
