// Where on a triangle a sample's ray passes it, by the operations that the vector engine repeats in lanes.
#pragma once

#include <array>
#include <optional>

#include "projector/exact/facet_rays.h"

namespace trilens {

/// A line meets a triangle.
struct LineHit {
    double t = 0;         // any sign, or not a number
    Vec2 barycentric{0};  // weights of the second and third corner
};

/// What hit_point() takes of a triangle: its first corner c, the edges e1 and e2 from there, and their
/// product.
struct TriangleFrame {
    Vec3 corner{0}, e1{0}, turned{0};  // turned: -e2
    Vec3 normal{0};                    // e1 x e2
    double size = 0;                   // of e1 times that of e2, in the largest coordinate
};

/// `corner`: from the facet's centre.
TriangleFrame triangle_frame(const std::array<Vec3, 3>& corner);

/// Below this share of what it is made of, the denominator is not trusted: a sliver, or a triangle seen
/// edge-on.
inline constexpr double kLeastDeterminant = 0x1p-30;

/// Where the ray passes: with s = W c - origin' and the ray times its weight W (origin' and direction',
/// mathematics section 2), t = n . s / n . direction', and the weights of the second and third corner are
/// -e2 . K and e1 . K, over W n . direction', with K = direction' x s (Moeller and Trumbore, Fast, Minimum
/// Storage Ray/Triangle Intersection, 1997, around the normal). None where the value is not trusted, or is
/// outside the triangle by its rounding. hit_points-inl.h repeats the operations, bit for bit.
std::optional<LineHit> hit_point(const SampleRay& ray, const TriangleFrame& triangle);

}  // namespace trilens
