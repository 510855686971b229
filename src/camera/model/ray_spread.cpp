#include "camera/model/ray_spread.h"

#include "base/math/roots.h"

namespace trilens {

namespace {

double det(const Vec3& a, const Vec3& b, const Vec3& c) {
    return dot(cross(a, b), c);
}

}  // namespace

std::vector<double> RaySpread::roots() const {
    std::vector<double> distinct;
    for (const double root : real_roots({constant, linear, quadratic, 0}))
        if (distinct.empty() || root != distinct.back()) distinct.push_back(root);
    return distinct;
}

RaySpread ray_spread(const RayChange& change) {
    const Vec3 &d = change.ray.direction, &ox = change.along_x.origin, &oy = change.along_y.origin,
               &dx = change.along_x.direction, &dy = change.along_y.direction;
    return {det(ox, oy, d), det(ox, dy, d) + det(dx, oy, d), det(dx, dy, d)};
}

std::optional<RaySpread> film_spread(const CameraModel& model, const Vec2& at, double step) {
    const auto here = model.ray(at), left = model.ray(at - Vec2(step, 0)),
               right = model.ray(at + Vec2(step, 0)), above = model.ray(at - Vec2(0, step)),
               below = model.ray(at + Vec2(0, step));
    if (!here || !left || !right || !above || !below) return std::nullopt;
    const auto change = [step](const Ray& from, const Ray& to) {
        return Ray{(to.origin - from.origin) / (2 * step), (to.direction - from.direction) / (2 * step)};
    };
    return ray_spread({*here, change(*left, *right), change(*above, *below)});
}

}  // namespace trilens
