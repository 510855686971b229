#include "camera/specular_sphere.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "camera/specular_sphere.cpp"
#include <hwy/foreach_target.h>
#include "base/double_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace trilens::specular {
namespace HWY_NAMESPACE {
using namespace lanes::HWY_NAMESPACE;
namespace hn = hwy::HWY_NAMESPACE;

/// Eye and point lie further from the sphere than this share of its radius, and the way between them further
/// than that share of its length: then |h| > 0.04 where their sides differ. Many times what the smallest cells
/// of a search need.
constexpr double kClearOfSphere = 0.02, kClearOfWay = 0.01;
/// From where a plane mirror would have the image.
constexpr int kNewtonSteps = 5;

/// In units of the sphere, from its centre.
struct Pair {
    Vector eye, point;
};

HWY_INLINE Number size_of(const Vector& v) {
    return hn::Sqrt(inner(v, v));
}

HWY_INLINE Vector unit(const Vector& v) {
    return over(v, size_of(v));
}

HWY_INLINE Truth is_clear(const Pair& pair) {
    const Number outside = number(1 + kClearOfSphere);
    const Vector way = minus(pair.point, pair.eye);
    const Number length = size_of(way);
    const Number along = hn::Div(hn::Neg(inner(pair.eye, way)), inner(way, way));
    const Number inside = hn::Min(hn::Max(along, number(0)), number(1));
    const Vector nearest = plus(pair.eye, times(inside, way));
    const Number least = hn::Add(outside, hn::Mul(number(kClearOfWay), length));
    const Truth apart = hn::And(hn::Gt(size_of(pair.eye), outside), hn::Gt(size_of(pair.point), outside));
    return hn::And(hn::And(apart, hn::Gt(length, number(0))), hn::Gt(size_of(nearest), least));
}

/// One step of Newton's method along the circle.
HWY_INLINE Vector nearer(const Pair& pair, const Vector& normal) {
    Vector bend = vector(Vec3(0));
    Number slope = number(0);
    for (const Vector& from : {pair.eye, pair.point}) {
        const Vector way = minus(normal, from);
        const Number by_distance = hn::Div(number(1), size_of(way));
        const Vector direction = times(by_distance, way);
        const Number cosine = inner(direction, normal);
        bend = plus(bend, direction);
        slope = hn::Add(slope, hn::Mul(cosine, hn::Sub(hn::Mul(cosine, by_distance), number(1))));
    }
    const Vector along = minus(bend, times(inner(bend, normal), normal));
    return unit(minus(normal, over(along, slope)));
}

HWY_INLINE Vector zero_near(const Pair& pair, Vector normal) {
    for (int step = 0; step < kNewtonSteps; ++step) normal = nearer(pair, normal);
    return normal;
}

HWY_INLINE void store(const Vector& v, PointLanes& to, std::size_t first) {
    hn::Store(v.x, kTag, to.x + first);
    hn::Store(v.y, kTag, to.y + first);
    hn::Store(v.z, kTag, to.z + first);
}

void two_zeros_here(const SphereShape& sphere, const Vec3& eye, const PointLanes& points,
                    SphereZeros& result) {
    const Number by_radius = number(1 / sphere.radius), one = number(1);
    const Vector center = vector(sphere.center);
    const Vector from_center = times(by_radius, minus(vector(eye), center));
    const Number eye_size = size_of(from_center);
    const Vector eye_direction = over(from_center, eye_size);
    result.two = 0;
    for (std::size_t first = 0; first < kPointLanes; first += kWidth) {
        const Vector point = vector_at(points.x + first, points.y + first, points.z + first);
        const Pair pair{from_center, times(by_radius, minus(point, center))};
        result.two |= bits_of(is_clear(pair)) << first;
        const Number size = size_of(pair.point);
        const Vector direction = over(pair.point, size);
        const auto between = [&](Number side) {
            return unit(plus(times(hn::Sub(size, side), eye_direction),
                             times(hn::Sub(eye_size, side), direction)));
        };
        store(zero_near(pair, between(one)), result.front, first);
        store(zero_near(pair, opposite(between(hn::Neg(one)))), result.back, first);
    }
}

}  // namespace HWY_NAMESPACE
}  // namespace trilens::specular
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace trilens {
namespace specular {
HWY_EXPORT(two_zeros_here);
}  // namespace specular

void find_two_zeros(const SphereShape& sphere, const Vec3& eye, const PointLanes& points,
                    SphereZeros& zeros) {
    using namespace specular;
    HWY_DYNAMIC_DISPATCH(two_zeros_here)(sphere, eye, points, zeros);
}

}  // namespace trilens
#endif
