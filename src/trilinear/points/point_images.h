// Where a facet images a world point: the real roots of the coplanarity cubic (Vallance 2005, chapter 3,
// listing 3.1).
#pragma once

#include <array>

#include "trilinear/facet/coplanarity.h"

namespace trilens {

/// The point lies at `t` on the ray of `weights`, which sum to 1.
struct PointImage {
    double t = 0;  // in units of the interpolated direction
    Vec3 weights{0};
};

/// Up to three images, t ascending.
struct PointImages {
    int count = 0;
    std::array<PointImage, 3> image;

    const PointImage* begin() const { return image.data(); }
    const PointImage* end() const { return image.data() + count; }
};

/// Which images are wanted.
struct ImageFilter {
    bool behind = false;       // also those with t < 0
    bool whole_plane = false;  // also those whose weights leave [0, 1]
};

/// All images of a world point in a facet. Borders belong to the facet: a weight counts as >= 0 down to
/// -kWeightTolerance and further down by what rounding of the coordinates does to it (kCoordinateRounding, at
/// most kLooseWeight), so that a point on the border of two facets is found in at least one of them, maybe in
/// both; t >= 0 likewise, and t is then 0. A point whose root is double (on the caustic) has one image there.
/// No image where the parametric triangle is degenerate: a pinhole's root at t = 0, where every ray meets, is
/// none.
PointImages point_images(const Coplanarity& facet, const Vec3& point, const ImageFilter& filter = {});

inline constexpr double kWeightTolerance = 1e-12;
inline constexpr double kCoordinateRounding =
    2e-15;  // share of the coordinates' size that computing may lose
inline constexpr double kLooseWeight = 1e-6;

/// An image whose point misses the world point by more than this share of its distance is none: a root at a
/// far t that rounding made of a vanishing leading coefficient.
inline constexpr double kImageResidual = 1e-9;

}  // namespace trilens
