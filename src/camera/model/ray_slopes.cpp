#include "camera/model/ray_slopes.h"

#include <algorithm>
#include <cmath>

namespace trilens {
namespace {

constexpr double kNearestMiss = 1e-9;  // units of t: nearer to the ray's origin shares do not grow

}  // namespace

std::optional<RaySlopes> ray_slopes(const CameraModel& model, const Vec2& at, double step) {
    if (const LinearRays* rays = model.linear_rays())
        return RaySlopes{rays->at(at), rays->per_x, rays->per_y};
    const auto here = model.ray(at), x1 = model.ray(at + Vec2(step, 0)), x0 = model.ray(at - Vec2(step, 0)),
               y1 = model.ray(at + Vec2(0, step)), y0 = model.ray(at - Vec2(0, step));
    if (!here || !x1 || !x0 || !y1 || !y0) return std::nullopt;
    const auto slope = [step](const Ray& ahead, const Ray& back) {
        return Ray{(ahead.origin - back.origin) / (2 * step),
                   (ahead.direction - back.direction) / (2 * step)};
    };
    return RaySlopes{*here, slope(*x1, *x0), slope(*y1, *y0)};
}

void add_product(RaySlopes& sum, const WeightSlopes& weight, const RaySlopes& rays) {
    const auto add = [&](Vec3 Ray::*part) {
        const Vec3& here = rays.corner.*part;
        sum.corner.*part += weight.here * here;
        sum.per_x.*part += weight.here * rays.per_x.*part + weight.per_pixel.x * here;
        sum.per_y.*part += weight.here * rays.per_y.*part + weight.per_pixel.y * here;
    };
    add(&Ray::origin);
    add(&Ray::direction);
}

MissSlopes miss_slopes(const RaySlopes& rays, const Vec3& point) {
    const Vec3 &origin = rays.corner.origin, &direction = rays.corner.direction;
    const Vec3 from = point - origin;
    const double square = dot(direction, direction), t = dot(from, direction) / square,
                 share = 1 / std::max(std::fabs(t), kNearestMiss), sign = t < 0 ? -1 : 1;
    const auto slope = [&](const Ray& by) {
        const double of_t =
            (dot(from, by.direction) - dot(by.origin, direction) - 2 * t * dot(direction, by.direction)) /
            square;
        const double of_share = std::fabs(t) > kNearestMiss ? -sign * of_t * share * share : 0;
        return of_share * from - share * by.origin - sign * by.direction;
    };
    return {share * from - sign * direction, slope(rays.per_x), slope(rays.per_y)};
}

}  // namespace trilens
