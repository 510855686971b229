#include "specular/sphere_images.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "specular/sphere_images.cpp"
#include <hwy/foreach_target.h>
#include "base/math/double_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace trilens::specular {
namespace HWY_NAMESPACE {
using namespace lanes::HWY_NAMESPACE;
namespace hn = hwy::HWY_NAMESPACE;

/// Eye and point lie further from the sphere than this share of its radius, and the way between them further
/// from it, or deeper in it, than that share more for each of its lengths: then |h| > 0.016 where their sides
/// differ and neither is far from edge-on. Many times what the smallest cells of a search need.
constexpr double kClearOfSphere = 0.01, kClearOfWay = 0.004;
/// Sine of the angle between eye and point, seen from the centre, where the way between them leads through
/// the sphere; and at zeros the least second derivatives of the path, per length of the sphere's radius.
constexpr double kClearOfLine = 0.05, kClearOfSingular = 0.05;
constexpr int kSphereSteps = 6;

/// In units of the sphere, from its centre.
struct EyeAndPoint {
    Vector eye, point;
};

HWY_INLINE Number size_of(const Vector& v) {
    return hn::Sqrt(dot(v, v));
}

HWY_INLINE Vector unit(const Vector& v) {
    return over(v, size_of(v));
}

/// The way between both: how near to the centre it comes, between its ends.
struct Way {
    Number length, nearest;
};

HWY_INLINE Way way_of(const EyeAndPoint& pair) {
    const Vector way = minus(pair.point, pair.eye);
    const Number along = hn::Div(hn::Neg(dot(pair.eye, way)), dot(way, way));
    const Number inside = hn::Min(hn::Max(along, number(0)), number(1));
    return {size_of(way), size_of(plus(pair.eye, times(inside, way)))};
}

struct Ways {
    Truth clear, through;
};

HWY_INLINE Ways ways_of(const EyeAndPoint& pair) {
    const auto [length, nearest] = way_of(pair);
    const Number margin = hn::Add(number(kClearOfSphere), hn::Mul(number(kClearOfWay), length));
    const Number eye = size_of(pair.eye), point = size_of(pair.point), outside = number(1 + kClearOfSphere);
    const Truth apart =
        hn::And(hn::Gt(length, number(0)), hn::And(hn::Gt(eye, outside), hn::Gt(point, outside)));
    const Truth aside =
        hn::Gt(size_of(cross(pair.eye, pair.point)), hn::Mul(number(kClearOfLine), hn::Mul(eye, point)));
    return {hn::And(apart, hn::Gt(nearest, hn::Add(number(1), margin))),
            hn::And(hn::And(apart, aside), hn::Lt(nearest, hn::Sub(number(1), margin)))};
}

/// One step of Newton's method along the circle.
HWY_INLINE Vector nearer(const EyeAndPoint& pair, const Vector& normal) {
    Vector bend = vector(Vec3(0));
    Number slope = number(0);
    for (const Vector& from : {pair.eye, pair.point}) {
        const Vector way = minus(normal, from);
        const Number by_distance = hn::Div(number(1), size_of(way));
        const Vector direction = times(by_distance, way);
        const Number cosine = dot(direction, normal);
        bend = plus(bend, direction);
        slope = hn::Add(slope, hn::Mul(cosine, hn::Sub(hn::Mul(cosine, by_distance), number(1))));
    }
    const Vector along = minus(bend, times(dot(bend, normal), normal));
    return unit(minus(normal, over(along, slope)));
}

HWY_INLINE Vector zero_near(const EyeAndPoint& pair, Vector normal) {
    for (int step = 0; step < kSphereSteps; ++step) normal = nearer(pair, normal);
    return normal;
}

/// Whether the path's second derivatives along the circle and across are clear of zero.
HWY_INLINE Truth is_regular(const EyeAndPoint& pair, const Vector& normal) {
    Number along = number(0), across = number(0);
    for (const Vector& from : {pair.eye, pair.point}) {
        const Vector way = minus(normal, from);
        const Number by_distance = hn::Div(number(1), size_of(way));
        const Number cosine = hn::Mul(by_distance, dot(way, normal));
        along = hn::Add(along, hn::Mul(cosine, hn::Sub(hn::Mul(cosine, by_distance), number(1))));
        across = hn::Add(across, hn::Sub(by_distance, cosine));
    }
    const Number least = number(kClearOfSingular);
    return hn::And(hn::Gt(hn::Abs(along), least), hn::Gt(hn::Abs(across), least));
}

/// Where rays from `from` touch the sphere, in the plane of it and the other: on that one's side, and beyond.
struct Edges {
    Vector near, far;
};

HWY_INLINE Edges edges_of(const Vector& from, const Vector& other) {
    const Number by_size = hn::Div(number(1), size_of(from));
    const Vector direction = times(by_size, from);
    const Vector across = unit(minus(other, times(dot(other, direction), direction)));
    const Vector out = times(by_size, direction);
    const Vector side = times(hn::Sqrt(hn::Sub(number(1), hn::Mul(by_size, by_size))), across);
    return {plus(out, side), minus(out, side)};
}

/// Where a plane mirror would have the image, if that is seen from both; else the middle of the arc that is
/// seen from both or from none.
HWY_INLINE Vector near_start(const EyeAndPoint& pair, const Edges& of_eye, const Edges& of_point) {
    const Number eye = size_of(pair.eye), point = size_of(pair.point), one = number(1);
    const Vector plane = unit(plus(times(hn::Div(hn::Sub(point, one), eye), pair.eye),
                                   times(hn::Div(hn::Sub(eye, one), point), pair.point)));
    const Truth seen = hn::And(hn::Gt(dot(plane, pair.eye), one), hn::Gt(dot(plane, pair.point), one));
    return either(seen, plane, unit(plus(of_eye.near, of_point.near)));
}

/// The middle of the arc beyond.
HWY_INLINE Vector far_start(const EyeAndPoint& pair, const Edges& of_eye, const Edges& of_point) {
    const Vector middle = unit(plus(of_eye.far, of_point.far));
    const Vector between = plus(unit(pair.eye), unit(pair.point));
    return either(hn::Gt(dot(middle, between), number(0)), opposite(middle), middle);
}

/// From `first` on, seen from the sphere's centre, in radii.
HWY_INLINE EyeAndPoint pair_at(const SphereShape& sphere, const Vec3& eye, const PointLanes& points,
                               std::size_t first) {
    const Number by_radius = number(1 / sphere.radius);
    const Vector center = vector(sphere.center);
    const Vector point = vector_at(points.x + first, points.y + first, points.z + first);
    return {times(by_radius, minus(vector(eye), center)), times(by_radius, minus(point, center))};
}

void find_zeros_here(const SphereShape& sphere, const Vec3& eye, const PointLanes& points,
                     SphereZeros& result) {
    result.lit = result.shaded = 0;
    for (std::size_t first = 0; first < kPointLanes; first += kWidth) {
        const EyeAndPoint pair = pair_at(sphere, eye, points, first);
        const Ways ways = ways_of(pair);
        const Edges of_eye = edges_of(pair.eye, pair.point), of_point = edges_of(pair.point, pair.eye);
        const Vector near = zero_near(pair, near_start(pair, of_eye, of_point));
        const Vector far = zero_near(pair, far_start(pair, of_eye, of_point));
        store(near, result.first, first);
        store(far, result.second, first);
        const Truth regular = hn::And(is_regular(pair, near), is_regular(pair, far));
        result.lit |= bits_of(hn::And(ways.clear, regular)) << first;
        result.shaded |= bits_of(hn::And(ways.through, regular)) << first;
    }
}

/// For images in front alone way and point may come nearer: there Newton's method has to converge, and no
/// more. A way that passes the sphere at d leaves an arc of about d / r on either side, r the distances of
/// eye and point, so the nearer of them counts.
constexpr double kFrontClearance = 2e-5;
constexpr int kFrontSteps = 5;

/// One step of Newton's method along the circle to where the tangents of half the angles to the normal are
/// opposite: on the arc seen from outside by both each grows with a slope of half or more, also where light
/// grazes.
HWY_INLINE Vector nearer_in_front(const EyeAndPoint& pair, const Vector& across, const Vector& normal) {
    const Vector along = cross(across, normal);
    Number sum = number(0), slope = number(0);
    for (const Vector& from : {pair.eye, pair.point}) {
        const Vector way = minus(normal, from);
        const Number by_distance = hn::Div(number(1), size_of(way));
        const Number cosine = hn::Mul(by_distance, dot(way, normal));
        const Number tangent = hn::Div(hn::Mul(by_distance, dot(way, along)), hn::Sub(number(1), cosine));
        const Number turn = hn::Sub(number(1), hn::Mul(cosine, by_distance));
        sum = hn::Add(sum, tangent);
        slope = hn::Add(slope, hn::Mul(turn, hn::Add(number(1), hn::Mul(tangent, tangent))));
    }
    return unit(minus(normal, times(hn::Div(hn::Add(sum, sum), slope), along)));
}

void find_front_zeros_here(const SphereShape& sphere, const Vec3& eye, const PointLanes& points,
                           FrontZeros& result) {
    result.one = result.none = 0;
    for (std::size_t first = 0; first < kPointLanes; first += kWidth) {
        const EyeAndPoint pair = pair_at(sphere, eye, points, first);
        const Number nearest = way_of(pair).nearest,
                     distance = hn::Min(size_of(pair.eye), size_of(pair.point));
        const Number margin =
            hn::Mul(number(kFrontClearance), hn::Add(number(1), hn::Add(distance, distance)));
        result.one |= bits_of(hn::Gt(nearest, hn::Add(number(1), margin))) << first;
        result.none |= bits_of(hn::Lt(nearest, hn::Sub(number(1), margin))) << first;
        const Edges of_eye = edges_of(pair.eye, pair.point), of_point = edges_of(pair.point, pair.eye);
        const Vector across = unit(cross(pair.eye, pair.point));
        Vector normal = near_start(pair, of_eye, of_point);
        for (int step = 0; step < kFrontSteps; ++step) normal = nearer_in_front(pair, across, normal);
        store(normal, result.at, first);
    }
}

}  // namespace HWY_NAMESPACE
}  // namespace trilens::specular
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace trilens {
namespace specular {
HWY_EXPORT(find_zeros_here);
HWY_EXPORT(find_front_zeros_here);
}  // namespace specular

void find_zeros(const SphereShape& sphere, const Vec3& eye, const PointLanes& points, SphereZeros& zeros) {
    using namespace specular;
    HWY_DYNAMIC_DISPATCH(find_zeros_here)(sphere, eye, points, zeros);
}

void find_front_zeros(const SphereShape& sphere, const Vec3& eye, const PointLanes& points,
                      FrontZeros& zeros) {
    using namespace specular;
    HWY_DYNAMIC_DISPATCH(find_front_zeros_here)(sphere, eye, points, zeros);
}

}  // namespace trilens
#endif
