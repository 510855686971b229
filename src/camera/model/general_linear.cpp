#include "camera/model/general_linear.h"

#include <algorithm>
#include <cmath>

#include "base/math/roots.h"

namespace trilens {
namespace {

constexpr double kOnePlace = 1e-13;  // of the origins' size: they are one place

/// The rays between two planes: from = on the first, to_second - its way to the second; lengths along the
/// planes are shares of the triangle's own size.
struct TwoPlanes {
    std::array<Vec2, 3> on_first, way;
    Ray middle;  // its direction reaches from plane to plane
};

Vec2 edge(const std::array<Vec2, 3>& corners, std::size_t k) {
    return corners[(k + 1) % 3] - corners[k];
}

double longest(const std::array<Vec2, 3>& corners) {
    return std::max({length(edge(corners, 0)), length(edge(corners, 1)), length(edge(corners, 2))});
}

std::optional<TwoPlanes> between_planes(const std::array<Ray, 3>& rays, const Vec3& across,
                                        double tolerance) {
    Vec3 origin(0);
    for (const Ray& ray : rays) origin += ray.origin / 3.0;
    const Vec3 axis = normalize_or_zero(across);
    if (axis == Vec3(0)) return std::nullopt;
    const Vec3 right = unit_across(axis), up = cross(right, axis);
    TwoPlanes planes;
    std::array<Vec3, 3> from, way;
    for (std::size_t k = 0; k < 3; ++k) {
        const double depth = dot(rays[k].direction, axis);
        if (!(depth > tolerance * length(rays[k].direction))) return std::nullopt;
        way[k] = rays[k].direction / depth;
        from[k] = rays[k].origin + dot(origin - rays[k].origin, axis) * way[k];
        planes.on_first[k] = {dot(from[k] - origin, right), dot(from[k] - origin, up)};
        planes.way[k] = {dot(way[k], right), dot(way[k], up)};
    }
    // The second plane stands where the rays have spread by as much as they are apart on the first; where
    // they meet on the first, a unit of their own depth away.
    double largest = 0;
    for (const Ray& ray : rays) largest = std::max(largest, length(ray.origin));
    const double apart = longest(planes.on_first), spread = longest(planes.way);
    const double reach = std::max(apart, length(from[0] - origin));
    const double scale = reach > kOnePlace * largest ? reach : 0;
    if (scale == 0) planes.on_first = {};
    const double between = spread > tolerance && scale > 0 ? scale / spread : scale > 0 ? scale : 1;
    const double size = std::max(apart, spread * between);
    if (!(size > 0)) return std::nullopt;
    for (std::size_t k = 0; k < 3; ++k) {
        if (length(edge(planes.on_first, k)) <= tolerance * size &&
            length(edge(planes.way, k)) * between <= tolerance * size)
            return std::nullopt;  // two rays are one
        planes.middle.origin += from[k] / 3.0;
        planes.middle.direction += between * way[k] / 3.0;
    }
    for (std::size_t k = 0; k < 3; ++k) {
        planes.on_first[k] /= size;
        planes.way[k] *= between / size;
    }
    return planes;
}

}  // namespace

const char* general_linear_kind_name(GeneralLinearKind kind) {
    constexpr std::array<const char*, kGeneralLinearKindCount> kNames{
        "pinhole", "orthographic",        "pushbroom", "crossedSlits",
        "pencil",  "twistedOrthographic", "bilinear",  "plane"};
    return kNames[static_cast<std::size_t>(kind)];
}

std::optional<GeneralLinearCamera> general_linear_camera(const std::array<Ray, 3>& rays, const Vec3& axis,
                                                         double tolerance) {
    const std::optional<TwoPlanes> planes = between_planes(rays, axis, tolerance);
    if (!planes) return std::nullopt;
    const Vec2 o1 = edge(planes->on_first, 0), o2 = -edge(planes->on_first, 2), w1 = edge(planes->way, 0),
               w2 = -edge(planes->way, 2);
    const double c = cross(o1, o2), b = cross(o1, w2) + cross(w1, o2), a = cross(w1, w2);
    bool parallel = true;
    for (std::size_t k = 0; k < 3; ++k)
        parallel = parallel && std::fabs(cross(edge(planes->on_first, k), edge(planes->way, k))) <= tolerance;

    GeneralLinearCamera camera;
    const auto meet = [&](double t) {
        camera.meets.push_back(planes->middle.origin + t * planes->middle.direction);
    };
    const auto is = [&](GeneralLinearKind kind) {
        camera.kind = kind;
        return camera;
    };
    const bool has_a = std::fabs(a) > tolerance, has_b = std::fabs(b) > tolerance;
    if (!has_a && !has_b) {
        if (!(std::fabs(c) > tolerance)) return is(GeneralLinearKind::kPlane);
        return is(parallel ? GeneralLinearKind::kOrthographic : GeneralLinearKind::kTwistedOrthographic);
    }
    if (!has_a) {
        meet(-c / b);
        return is(GeneralLinearKind::kPushbroom);
    }
    const double discriminant = b * b - 4 * a * c;
    if (std::fabs(discriminant) <= tolerance * (b * b + std::fabs(4 * a * c)) || parallel) {
        meet(-b / (2 * a));
        return is(parallel ? GeneralLinearKind::kPinhole : GeneralLinearKind::kPencil);
    }
    if (discriminant < 0) return is(GeneralLinearKind::kBilinear);
    for (const double root : real_roots({c, b, a, 0})) meet(root);
    return is(GeneralLinearKind::kCrossedSlits);
}

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
