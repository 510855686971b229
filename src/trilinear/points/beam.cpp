#include "trilinear/points/beam.h"

#include <algorithm>
#include <array>

namespace trilens {
namespace {

// Borders count as inside by up to 1e-6 of a weight (kLooseWeight): the sides stand off by more than that.
constexpr double kStandOff = 1e-5;
// And by what rounding may do to a projection on a side's normal, as a share of the lengths involved.
constexpr double kRounding = 1e-13;

}  // namespace

FacetBeam make_facet_beam(const Coplanarity& facet) {
    const Vec3 d0 = facet.direction, d1 = d0 + facet.f1, d2 = d0 + facet.f2;
    FacetBeam beam;
    beam.axis = normalize_or_zero(normalize_or_zero(d0) + normalize_or_zero(d1) + normalize_or_zero(d2));
    beam.along = {dot(d0, beam.axis), dot(d1, beam.axis), dot(d2, beam.axis)};
    // Nearly across the axis, t would hang on rounding.
    constexpr double kAcross = 1e-3;
    if (beam.along.x <= kAcross * length(d0) || beam.along.y <= kAcross * length(d1) ||
        beam.along.z <= kAcross * length(d2))
        beam.axis = Vec3(0);
    return beam;
}

bool may_hold(const Coplanarity& facet, const FacetBeam& beam, const Vec3& point) {
    if (beam.axis == Vec3(0)) return true;
    const Vec3 x = point - facet.origin;
    const Vec3 d0 = facet.direction, d1 = d0 + facet.f1, d2 = d0 + facet.f2;
    const double size =
        length(x) + length(facet.e1) + length(facet.e2) + kRounding * length(facet.origin) / kStandOff;

    // t = (sum w_k N_k) / (sum w_k D_k) is a mean of the N_k / D_k, since all D_k are positive.
    const double height = dot(x, beam.axis);
    const Vec3 t =
        Vec3(height, height - dot(facet.e1, beam.axis), height - dot(facet.e2, beam.axis)) / beam.along;
    const Vec3 margin = kStandOff * size / beam.along;
    const double low = std::max(std::min({t.x - margin.x, t.y - margin.y, t.z - margin.z}),
                                -std::max({margin.x, margin.y, margin.z}));
    const double high = std::max({t.x + margin.x, t.y + margin.y, t.z + margin.z});
    if (high < low) return false;

    // The parametric triangles at both ends, and their sides along the axis.
    const std::array<Vec3, 6> hull = {low * d0,  facet.e1 + low * d1,  facet.e2 + low * d2,
                                      high * d0, facet.e1 + high * d1, facet.e2 + high * d2};
    for (std::size_t k = 0; k < 3; ++k) {
        const std::size_t next = (k + 1) % 3;
        const Vec3 normal = cross(hull[next] + hull[next + 3] - hull[k] - hull[k + 3], beam.axis);
        double least = dot(normal, hull[0]), most = least;
        for (std::size_t i = 1; i < 6; ++i) {
            const double side = dot(normal, hull[i]);
            least = std::min(least, side), most = std::max(most, side);
        }
        const double room =
            kStandOff * (most - least) + kRounding * length(normal) * (size + length(facet.origin));
        const double here = dot(normal, x);
        if (here > most + room || here < least - room) return false;
    }
    return true;
}

}  // namespace trilens
