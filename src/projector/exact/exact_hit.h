// Whether one ray's line meets one triangle, and where: the decision that all engines share, bit for bit.
#pragma once

#include <array>
#include <optional>

#include "projector/exact/hit_point.h"

namespace trilens {

/// An edge conic (trilinear/edge_conic.h) further from zero than this share of its terms has the sign of the
/// decision. With p = weight corner - origin', the conic is direction' . (p_a x p_b) / weight. Counting
/// roundings, each half a unit in the last place: 24 in the corners' positions on the ray's screen, 20 in the
/// conic, 16 where coefficients are moved from the facet's corner to another reference, 8 in the ray.
inline constexpr double kDecisionErrorBound = 128 * 2.220446049250313e-16;

/// Whether the ray's line meets the triangle, by exact signs: the corners are projected along the ray on the
/// plane of two axes, where the ray is the origin. Every triangle with a corner gets the same projection of
/// it, so the rounded picture is still a mesh without gaps (Woop, Benthin, Wald, Watertight Ray/Triangle
/// Intersection, JCGT 2(1), 2013). `corner`: from the facet's centre. Where it lies: as hit_point() says;
/// where that says nothing, from the projection, as convex combinations: never outside the triangle, however
/// thin it is.
std::optional<LineHit> exact_hit(const SampleRay& ray, const std::array<Vec3, 3>& corner);

}  // namespace trilens
