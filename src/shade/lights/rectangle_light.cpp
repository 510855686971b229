// Rectangular light of constant radiance: points of equal areas.
#include "shade/lights/light_sample.h"

namespace trilens {

LightSample sample_light(const RectangleLight& light, double intensity, const LitPoint& at,
                         std::size_t sample) {
    const std::size_t count = static_cast<std::size_t>(light.samples);
    const Vec2 place = stratified_place(sample, count) - Vec2(0.5);
    const auto [width, height] = sides_of(light);
    return from_flat_light({light.position + place.x * width + place.y * height, light.direction, intensity,
                            light.size.x * light.size.y / static_cast<double>(count)},
                           at);
}

}  // namespace trilens
