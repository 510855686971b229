// Flat lights of constant radiance, rectangles and disks: points of equal areas.
#include <cmath>
#include <numbers>

#include "shade/lights/light_sample.h"

namespace trilens {

Vec3 before_flat_light(const FlatPart& part, double scene_size) {
    // A share of the scene's size: the light would hide itself wherever rounding puts the rays' ends behind
    // it.
    constexpr double kBeforeLight = 1e-5;
    return part.position + kBeforeLight * scene_size * part.normal;
}

LightSample from_flat_light(const FlatPart& part, const LitPoint& at) {
    const Vec3 way = part.position - at.position;
    const double distance2 = dot(way, way);
    if (!(distance2 > 0)) return {};
    const Vec3 toward = normalize_or_zero(way);
    const double cosine = -dot(toward, part.normal);
    if (!(cosine > 0)) return {};
    return {.toward = toward,
            .target = before_flat_light(part, at.scene_size),
            .irradiance = cosine / distance2 * (part.area * part.radiance),
            .spread = std::sqrt(cosine * part.area / (std::numbers::pi * distance2))};
}

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
