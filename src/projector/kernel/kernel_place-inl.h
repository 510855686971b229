// Where samples' rays pass the triangles that they surely meet: what place() gives, bit for bit, in lanes.
// Included once per instruction set.
#if defined(TRILENS_KERNEL_PLACE_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef TRILENS_KERNEL_PLACE_INL_H
#undef TRILENS_KERNEL_PLACE_INL_H
#else
#define TRILENS_KERNEL_PLACE_INL_H
#endif

#include <algorithm>
#include <limits>

#include "projector/exact/place.h"
#include "projector/kernel/kernel_setup-inl.h"

HWY_BEFORE_NAMESPACE();
namespace trilens {
namespace HWY_NAMESPACE {

// Every operation rounds as place() rounds it: no fused multiply-add.

HWY_INLINE Vector3 set3(const Vec3& v) {
    return {hn::Set(kDouble, v.x), hn::Set(kDouble, v.y), hn::Set(kDouble, v.z)};
}
template <typename A, typename B>
HWY_INLINE A exact_inner(const VectorOf<A>& a, const VectorOf<B>& b) {
    return plus(plus(product(a.x, b.x), product(a.y, b.y)), product(a.z, b.z));
}
template <typename A>
HWY_INLINE VectorOf<A> exact_outer(const VectorOf<A>& a, const VectorOf<A>& b) {
    return {minus(product(a.y, b.z), product(b.y, a.z)), minus(product(a.z, b.x), product(b.z, a.x)),
            minus(product(a.x, b.y), product(b.x, a.y))};
}
HWY_INLINE Double largest_part(const Vector3& v) {
    return hn::Max(hn::Abs(v.x), hn::Max(hn::Abs(v.y), hn::Abs(v.z)));
}

/// TriangleFrame, one triangle per lane.
struct FrameLanes {
    Vector3 corner, e1, turned, normal;
    Double size;
};

HWY_INLINE FrameLanes broadcast(const TriangleFrame& frame) {
    return {set3(frame.corner), set3(frame.e1), set3(frame.turned), set3(frame.normal),
            hn::Set(kDouble, frame.size)};
}

/// triangle_frame() in lanes.
HWY_INLINE FrameLanes frame_lanes(const Vector3 (&corner)[3]) {
    const Vector3 e1 = minus(corner[1], corner[0]), e2 = minus(corner[2], corner[0]);
    return {corner[0], e1, minus(corner[0], corner[2]), exact_outer(e1, e2),
            hn::Mul(largest_part(e1), largest_part(e2))};
}

/// The rays of some samples, as FacetRays::at gives them.
template <typename Number>
struct RaysOf {
    VectorOf<Number> origin, direction;
    Number weight;
};
using RayLanes = RaysOf<Double>;

template <typename Number>
HWY_INLINE Number linear_at(double c0, double c1, double c2, const Number& x, const Number& y) {
    return plus(plus(product(x, hn::Set(kDouble, c1)), hn::Set(kDouble, c0)),
                product(y, hn::Set(kDouble, c2)));
}
template <typename Number>
HWY_INLINE VectorOf<Number> linear_at(const std::array<Vec3, 3>& c, const Number& x, const Number& y) {
    return {linear_at(c[0].x, c[1].x, c[2].x, x, y), linear_at(c[0].y, c[1].y, c[2].y, x, y),
            linear_at(c[0].z, c[1].z, c[2].z, x, y)};
}

/// `x`, `y`: from FacetRays::screen.
template <typename Number>
HWY_INLINE RaysOf<Number> ray_lanes(const AffineRays& rays, const Number& x, const Number& y) {
    return {linear_at(rays.origin, x, y), linear_at(rays.direction, x, y),
            linear_at(rays.weight[0], rays.weight[1], rays.weight[2], x, y)};
}

/// What place() says, without its questions.
template <typename Number>
struct PlacedOf {
    Number t, second, third;  // weights of the sorted corners
    Number along;
};

template <typename Number>
HWY_INLINE PlacedOf<Number> place_lanes(const FrameLanes& f, const RaysOf<Number>& ray) {
    const VectorOf<Number> from = minus(times(ray.weight, f.corner), ray.origin);
    const Number along = exact_inner(ray.direction, f.normal);
    const VectorOf<Number> turn = exact_outer(ray.direction, from);
    const Number scale = inverse(product(ray.weight, along));
    return {product(exact_inner(from, f.normal), product(ray.weight, scale)),
            product(exact_inner(turn, f.turned), scale), product(exact_inner(turn, f.e1), scale), along};
}

/// `t` where place() trusts `along`, else not a number. `largest`: coordinate of the ray's direction, or
/// more.
HWY_INLINE Double trusted_time(const Double& t, const Double& along, const Double& largest,
                               const Double& size) {
    const Double least = hn::Mul(hn::Set(kDouble, kLeastDeterminant), hn::Mul(largest, size));
    const Double unknown = hn::Set(kDouble, std::numeric_limits<double>::quiet_NaN());
    return hn::IfThenElse(hn::Ge(hn::Abs(along), least), t, unknown);
}

/// The weight of the first sorted corner.
HWY_INLINE Double first_weight(const Double& second, const Double& third) {
    return hn::Sub(hn::Sub(hn::Set(kDouble, 1.0), second), third);
}

}  // namespace HWY_NAMESPACE
}  // namespace trilens
HWY_AFTER_NAMESPACE();

#endif
