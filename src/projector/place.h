// Where on a triangle the rays of a facet pass it: a few polynomials over the screen per triangle, then
// little work per sample.
#pragma once

#include <array>
#include <optional>

#include "projector/facet_rays.h"

namespace trilens {

/// A line meets a triangle.
struct LineHit {
    double t = 0;         // any sign, or not a number
    Vec2 barycentric{0};  // weights of the second and third corner
};

/// With corners c, edges e1 = c1 - c0, e2 = c2 - c0, n = e1 x e2 and the ray times its weight W (origin' and
/// direction', mathematics section 2): t = (W n . c0 - n . origin') / (n . direction'), and the weights of
/// the second and third corner are -e2 . K and e1 . K, over W n . direction', with K = (origin' - W c0) x
/// direction'. All of these are polynomials of the offset (x, y) from FacetRays::screen: the linear ones of
/// 1, x, y, the quadratic ones of 1, x, y, x^2, x y, y^2. kernel_place-inl.h repeats the operations in lanes,
/// bit for bit.
struct PlaceForms {
    std::array<double, 3> above{}, along{};   // t = above / along
    std::array<double, 6> second{}, third{};  // weights, times W along
    double size = 0;                          // of e1 times that of e2, in the largest coordinate
};

/// Below this share of what it is made of, the denominator is not trusted: a sliver, or a triangle seen
/// edge-on.
inline constexpr double kLeastDeterminant = 0x1p-30;

/// Nor is a weight that has cancelled below this share of its terms: a sample far outside its facet, near its
/// horizon.
inline constexpr double kLeastWeightShare = 0x1p-2;

/// `corner`: from the facet's centre.
PlaceForms place_forms(const FacetRays& facet, const std::array<Vec3, 3>& corner);

/// Where the ray passes, at `from` the facet's `screen`. None where the value is not trusted, or is outside
/// the triangle by its rounding.
std::optional<LineHit> place(const FacetRays& facet, const PlaceForms& forms, const Vec2& from);

}  // namespace trilens
