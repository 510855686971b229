// Ambient occlusion: the same radiance from all directions that nothing near stands in.
// Source: Zhukov, Iones, Kronin, An Ambient Light Illumination Model, 1998.
#include <numbers>

#include "shade/lights/light_sample.h"

namespace trilens {

double occlusion_distance(const AmbientLight& light, double scene_size) {
    return light.distance > 0 ? light.distance : 2 * scene_size;
}

LightSample sample_light(const AmbientLight& light, double intensity, const LitPoint& at,
                         std::size_t sample) {
    const std::size_t count = static_cast<std::size_t>(light.samples);
    const Vec3 above = hemisphere_direction(sample, count);
    const auto [u, v] = tangent_basis(at.normal);
    const Vec3 toward = normalize_or_zero(above.x * u + above.y * v + above.z * at.normal);
    const double facing = dot(toward, at.normal);
    if (!(facing > 0)) return {};
    return {.toward = toward,
            .target = at.position + occlusion_distance(light, at.scene_size) * toward,
            .irradiance = std::numbers::pi / (static_cast<double>(count) * facing) * intensity};
}

}  // namespace trilens
