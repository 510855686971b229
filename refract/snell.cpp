#include "refract/snell.h"

#include <cmath>

namespace trilens {

std::optional<Vec3> refracted(const Vec3& incoming, const Vec3& unit_normal, double eta) {
    const double size = length(incoming);
    if (!(size > 0)) return std::nullopt;
    const Vec3 unit = incoming / size;

    // The part along the surface. A ray beyond grazing is laid into the surface first.
    const double cosine = -dot(unit, unit_normal);
    Vec3 along = unit + cosine * unit_normal;
    if (cosine < 0) along /= length(along);
    const Vec3 tangential = eta * along;
    const double sin2 = dot(tangential, tangential);
    if (sin2 > 1) return std::nullopt;
    const Vec3 direction = tangential - std::sqrt(1 - sin2) * unit_normal;
    return direction * (size / length(direction));
}

}  // namespace trilens
