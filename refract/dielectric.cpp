#include "refract/dielectric.h"

#include <algorithm>
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

bool is_beyond_critical(double cos_incident, double eta) {
    const double cosine = std::clamp(cos_incident, 0.0, 1.0);
    return eta * eta * (1 - cosine * cosine) > 1;
}

double fresnel_reflectance(double cos_incident, double eta) {
    const double cos_i = std::clamp(cos_incident, 0.0, 1.0);
    const double sin2 = eta * eta * (1 - cos_i * cos_i);
    if (sin2 >= 1) return 1;
    const double cos_t = std::sqrt(1 - sin2);

    // Amplitudes for the field parallel and at right angles to the plane of incidence; light is half of each.
    const double parallel = (cos_i - eta * cos_t) / (cos_i + eta * cos_t);
    const double perpendicular = (eta * cos_i - cos_t) / (eta * cos_i + cos_t);
    return 0.5 * (parallel * parallel + perpendicular * perpendicular);
}

}  // namespace trilens
