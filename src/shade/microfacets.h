// GGX microfacets: the distribution of their normals, how they mask each other, and samples of those that are
// seen.
// Source: Walter, Marschner, Li, Torrance, Microfacet Models for Refraction through Rough Surfaces, EGSR
// 2007; glTF 2.0 specification, appendix B (masking of both directions by itself: Smith's, separable).
#pragma once

#include <cstddef>

#include "base/math/vec.h"

namespace trilens {

/// The least cosine between view and normal that counts: a shading normal may look away.
inline constexpr double kLeastViewCosine = 1e-4;

/// A surface of microfacets as seen from one side. alpha: glTF's roughness squared.
struct RoughSurface {
    Vec3 normal{0, 1, 0};  // unit, on the side that is looked at
    Vec3 view{0, 1, 0};    // unit, to the viewer
    double alpha = 0;
};

/// Microfacets per solid angle of normals and unit of area whose normal has this cosine.
double ggx_distribution(double alpha2, double cos_half);

/// The share of microfacets that is seen from a direction of this cosine: 0..1.
double ggx_masking(double alpha2, double cosine);

/// The normal of one of the microfacets that are seen, in proportion to the area that each shows; unit.
/// `place`: of the unit square, areas in proportion.
/// Source: Heitz, Sampling the GGX Distribution of Visible Normals, JCGT 2018.
Vec3 visible_normal(const RoughSurface& surface, const Vec2& place);

/// Visible normals per solid angle about `microfacet`.
double visible_density(const RoughSurface& surface, const Vec3& microfacet);

/// One of `count` ways in which rough surfaces turn the rays of one path: a place of the unit square for each
/// meeting with one. At the first meeting they are Hammersley's points, at later ones a sequence of
/// Kronecker's, so that the ways cover the microfacets evenly there, too. `shift` moves the points inside of
/// their strata: pixels with other shifts have other points. Source: Keller, Heidrich, Interleaved Sampling,
/// 2001; Niederreiter, Random Number Generation and Quasi-Monte Carlo Methods, 1992, chapter 3.
struct RoughWay {
    std::size_t sample = 0, count = 1;
    std::size_t shift = 0;

    Vec2 place(std::size_t meeting) const;
};

}  // namespace trilens
