// Directional lights, and the sun: a disk at no finite distance, of constant radiance.
#include <cmath>

#include "shade/lights/light_sample.h"

namespace trilens {

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
