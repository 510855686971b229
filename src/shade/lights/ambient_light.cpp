// Ambient occlusion: the same radiance from all directions that nothing near stands in.
// Source: Zhukov, Iones, Kronin, An Ambient Light Illumination Model, 1998.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "shade/lights/light_sample.h"

namespace trilens {

LightSample sample_light(const AmbientLight& light, double intensity, const LitPoint& at,
                         std::size_t sample) {
    // Directions in proportion to the cosine from the normal: a disk's points under the hemisphere (Malley).
    const std::size_t count = static_cast<std::size_t>(light.samples);
    const Vec2 disk = disk_place(stratified_place(sample, count));
    const double cosine = std::sqrt(std::max(1 - dot(disk, disk), 0.0));
    const auto [u, v] = tangent_basis(at.normal);
    const Vec3 toward = normalize_or_zero(disk.x * u + disk.y * v + cosine * at.normal);
    const double facing = dot(toward, at.normal);
    if (!(facing > 0)) return {};
    const double far = light.distance > 0 ? light.distance : 2 * at.scene_size;
    return {.toward = toward,
            .target = at.position + far * toward,
            .irradiance = std::numbers::pi / (static_cast<double>(count) * facing) * intensity};
}

}  // namespace trilens
