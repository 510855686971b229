// Lights of constant radiance: rectangles and disks by points of equal areas, spheres by directions of equal
// solid angles within the cone that a point sees. Source: Shirley, Wang, Zimmerman, Monte Carlo Techniques
// for Direct Lighting Calculations, 1996.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "shade/lights/light_sample.h"

namespace trilens {

Vec3 before_flat_light(const FlatPart& part, double scene_size) {
    // A share of the scene's size: the light would hide itself where rounding puts the rays' ends behind it.
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

LightSample sample_light(const SphereLight& light, double intensity, const LitPoint& at, std::size_t sample) {
    const std::size_t count = static_cast<std::size_t>(light.samples);
    const Vec3 way = light.position - at.position;
    const double distance2 = dot(way, way), radius2 = light.radius * light.radius;
    if (!(distance2 > radius2)) return {};  // it shines outward
    const double sine2 = radius2 / distance2;
    const double one_minus_cosine = sine2 / (1 + std::sqrt(1 - sine2));
    LightSample seen;
    seen.toward = cone_direction(normalize_or_zero(way), one_minus_cosine, stratified_place(sample, count));
    // Where the direction meets the sphere first.
    const double along = dot(way, seen.toward);
    const double depth = std::sqrt(std::max(radius2 - (distance2 - along * along), 0.0));
    seen.target = at.position + (along - depth) * seen.toward;
    seen.irradiance = 2 * std::numbers::pi * one_minus_cosine / static_cast<double>(count) * intensity;
    seen.spread = std::sqrt(sine2 / static_cast<double>(count));
    return seen;
}

}  // namespace trilens
