// Round flat light of constant radiance: points of equal areas.
#include <numbers>

#include "shade/lights/light_sample.h"

namespace trilens {

FlatPart part_of(const DiskLight& light, double radiance, std::size_t sample) {
    const std::size_t count = static_cast<std::size_t>(light.samples);
    const Vec2 place = light.radius * disk_place(stratified_place(sample, count));
    const auto [u, v] = tangent_basis(light.direction);
    const double area = std::numbers::pi * light.radius * light.radius;
    return {light.position + place.x * u + place.y * v, light.direction, radiance,
            area / static_cast<double>(count)};
}

LightSample sample_light(const DiskLight& light, double intensity, const LitPoint& at, std::size_t sample) {
    return from_flat_light(part_of(light, intensity, sample), at);
}

}  // namespace trilens
