#include "shade/fresnel.h"

#include <algorithm>
#include <cmath>

namespace trilens {

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
