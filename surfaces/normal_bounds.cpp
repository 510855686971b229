// The cross product of two vectors in balls.
#include "surfaces/normal_bounds.h"

#include <cmath>

namespace trilens {

double normal_radius(const SurfaceBounds& bounds) {
    const SurfacePoint& middle = bounds.middle;
    const Vec3 across = cross(middle.du, middle.dv);
    const double moved = length(middle.du) * bounds.dv_radius + length(middle.dv) * bounds.du_radius +
                         bounds.du_radius * bounds.dv_radius;
    const double sine = moved / length(across);
    if (!(sine < 1) || middle.normal == Vec3(0)) return 2;

    // The cross product lies in a ball around `across`: the tangent from the origin has this sine, and the
    // chord between unit vectors is 2 sin(angle / 2).
    const double cosine = std::sqrt((1 - sine) * (1 + sine));
    return sine * std::sqrt(2 / (1 + cosine)) + 1e-14;
}

}  // namespace trilens
