// Point, spot and directional lights; and the sun: a disk at no finite distance, of constant radiance.
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

LightSample sample_light(const DirectionalLight& light, double intensity, const LitPoint& at,
                         std::size_t sample) {
    const auto at_infinity = [&](const Vec3& toward, double irradiance) {
        return LightSample{
            .toward = toward, .target = at.position + 2 * at.scene_size * toward, .irradiance = irradiance};
    };
    if (!(light.angle > 0)) return at_infinity(-light.direction, intensity);
    const std::size_t count = static_cast<std::size_t>(light.samples);
    const double half = light.angle / 2 * (3.14159265358979323846 / 180);
    const double sine = std::sin(half), half_sine = std::sin(half / 2);
    const double one_minus_cosine = 2 * half_sine * half_sine;
    // A surface that faces the disk gets radiance times pi sin^2; a sample has its share of 2 pi (1 - cos).
    const double share = 2 * one_minus_cosine / (sine * sine) / static_cast<double>(count);
    LightSample seen =
        at_infinity(cone_direction(-light.direction, one_minus_cosine, stratified_place(sample, count)),
                    share * intensity);
    seen.spread = sine / std::sqrt(static_cast<double>(count));
    return seen;
}

}  // namespace trilens
