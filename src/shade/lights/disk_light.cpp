// Round flat light of constant radiance: points of equal areas.
#include <numbers>

#include "shade/lights/light_sample.h"

namespace trilens {

LightSample sample_light(const DiskLight& light, double intensity, const LitPoint& at, std::size_t sample) {
    const std::size_t count = static_cast<std::size_t>(light.samples);
    const Vec2 place = light.radius * disk_place(stratified_place(sample, count));
    const auto [u, v] = tangent_basis(light.direction);
    const double area = std::numbers::pi * light.radius * light.radius;
    return from_flat_light({light.position + place.x * u + place.y * v, light.direction, intensity,
                            area / static_cast<double>(count)},
                           at);
}

}  // namespace trilens
