// Can a facet's beam hold a point at all? A cheap test before the cubic.
#pragma once

#include "trilinear/facet/coplanarity.h"

namespace trilens {

/// What the test needs of a facet besides its Coplanarity: an axis on which all its rays go forward.
struct FacetBeam {
    Vec3 axis{0};   // unit; zero where the corner rays have no such axis: then every point may be held
    Vec3 along{0};  // the corner directions' parts along the axis, all positive
};

FacetBeam make_facet_beam(const Coplanarity& facet);

/// False only where point_images (with the usual filter) finds no image. On the axis, t of the point is a
/// mean of its values at the three corner rays; between the least and the largest of them the beam lies in
/// the hull of six points, and the point must not be beyond that hull's sides.
bool may_hold(const Coplanarity& facet, const FacetBeam& beam, const Vec3& point);

}  // namespace trilens
