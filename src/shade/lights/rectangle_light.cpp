// Rectangular light of constant radiance: points of equal areas.
#include "shade/lights/light_sample.h"

namespace trilens {

FlatPart part_of(const RectangleLight& light, double radiance, std::size_t sample) {
    const std::size_t count = static_cast<std::size_t>(light.samples);
    const Vec2 place = stratified_place(sample, count) - Vec2(0.5);
    const auto [width, height] = sides_of(light);
    return {light.position + place.x * width + place.y * height, light.direction, radiance,
            light.size.x * light.size.y / static_cast<double>(count)};
}

LightSample sample_light(const RectangleLight& light, double intensity, const LitPoint& at,
                         std::size_t sample) {
    return from_flat_light(part_of(light, intensity, sample), at);
}

}  // namespace trilens
