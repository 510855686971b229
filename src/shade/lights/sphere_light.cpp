// Spherical light of constant radiance: directions of equal solid angles within the cone that a point sees.
// Source: Shirley, Wang, Zimmerman, Monte Carlo Techniques for Direct Lighting Calculations, 1996.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "shade/lights/light_sample.h"

namespace trilens {

LightSample sample_light(const SphereLight& light, double intensity, const LitPoint& at, std::size_t sample) {
    const std::size_t count = static_cast<std::size_t>(light.samples);
    const Vec3 way = light.position - at.position;
    const double distance2 = dot(way, way), radius2 = light.radius * light.radius;
    if (!(distance2 > radius2)) return {};  // it shines outward
    const double sine2 = radius2 / distance2;
    const double one_minus_cosine = sine2 / (1 + std::sqrt(1 - sine2));
    LightSample seen;
    seen.toward = cone_direction(normalize_or_zero(way), one_minus_cosine, stratified_place(sample, count));
    // Where the direction meets the sphere first.
    const double along = dot(way, seen.toward);
    const double depth = std::sqrt(std::max(radius2 - (distance2 - along * along), 0.0));
    seen.target = at.position + (along - depth) * seen.toward;
    seen.irradiance = 2 * std::numbers::pi * one_minus_cosine / static_cast<double>(count) * intensity;
    seen.spread = std::sqrt(sine2 / static_cast<double>(count));
    return seen;
}

}  // namespace trilens
