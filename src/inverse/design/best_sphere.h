// The sphere that comes nearest to a wish: what a freeform mirror is held against.
#pragma once

#include <span>

#include "inverse/design/design.h"
#include "inverse/design/reflection_rows.h"

namespace trilens {

DesignErrors design_errors(std::vector<double> degrees);

/// Radius and tilt by Levenberg and Marquardt, through the anchor, from the flat rectangle.
BestSphere best_sphere(const DesignWish& wish, const WishedRays& rays, std::span<const Vec2> samples);

/// The height over `at` of the sphere of this curvature (0: a plane; positive: convex towards +z) through
/// (anchor, 0) with slopes `tilt` there; none where the sphere does not reach so far.
std::optional<Height> sphere_height(double curvature, const Vec2& tilt, const Vec2& at);

}  // namespace trilens
