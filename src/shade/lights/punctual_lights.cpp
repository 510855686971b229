// Point and spot lights.
// Source: KHR_lights_punctual.
#include <algorithm>
#include <cmath>

#include "shade/lights/light_sample.h"

namespace trilens {

LightSample sample_light(const PointLight& light, double intensity, const LitPoint& at, std::size_t) {
    const Vec3 way = light.position - at.position;
    const double distance2 = dot(way, way);
    if (!(distance2 > 0)) return {};
    return {.toward = normalize_or_zero(way), .target = light.position, .irradiance = intensity / distance2};
}

ConeCosines cone_cosines(const SpotLight& light) {
    constexpr double kRadians = 3.14159265358979323846 / 180;
    const double inner = std::cos(light.inner_cone_angle * kRadians),
                 outer = std::cos(light.outer_cone_angle * kRadians);
    return {outer, std::max(inner - outer, 1e-9)};
}

LightSample sample_light(const SpotLight& light, double intensity, const LitPoint& at, std::size_t) {
    LightSample sample = sample_light(PointLight{light.position}, intensity, at, 0);
    // Between the cones the square of the cosine's share of the way from the outer one.
    const auto [outer, fall_off] = cone_cosines(light);
    const double share = std::clamp((-dot(light.direction, sample.toward) - outer) / fall_off, 0.0, 1.0);
    sample.irradiance *= share * share;
    return sample;
}

}  // namespace trilens
