#include "intersect/box_tree.h"
#include "intersect/ray_patches.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "intersect/local_segments.cpp"
#include <hwy/foreach_target.h>
#include "base/math/double_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace trilens::segment_lanes {
namespace HWY_NAMESPACE {
using namespace lanes::HWY_NAMESPACE;
namespace hn = hwy::HWY_NAMESPACE;

inline constexpr hn::Rebind<float, Tag> kFloatTag;
static_assert(Segments::kMost % kWidth == 0);

HWY_INLINE Vector load(const double (&from)[3][Segments::kMost], std::size_t first) {
    return vector_at(from[0] + first, from[1] + first, from[2] + first);
}
/// a + s b
HWY_INLINE Vector along(const Vector& a, Number s, const Vector& b) {
    return plus(a, times(s, b));
}
HWY_INLINE void store(const Vector& v, float (&to)[3][Segments::kMost], std::size_t first) {
    hn::Store(hn::DemoteTo(kFloatTag, v.x), kFloatTag, to[0] + first);
    hn::Store(hn::DemoteTo(kFloatTag, v.y), kFloatTag, to[1] + first);
    hn::Store(hn::DemoteTo(kFloatTag, v.z), kFloatTag, to[2] + first);
}

void make_local_here(const Segments& segments, const Vec3& centre, double scale, LocalSegments& local) {
    for (std::size_t first = 0; first < segments.count; first += kWidth) {
        const Vector step = load(segments.step, first), from = load(segments.from, first);
        const Number squared = dot(step, step), zero = number(0);
        const Truth usual = hn::And(hn::Gt(squared, number(1e-280)), hn::Lt(squared, number(1e280)));
        const Number inverse = hn::Div(number(1), hn::Sqrt(squared)), unit = number(scale);
        const Vector direction = times(inverse, step);
        const Number speed = hn::Mul(dot(direction, step), unit);
        const Vector origin = times(unit, minus(from, vector(centre)));

        // The stretch inside the scene's ball, with room for rounding of far origins.
        const Number far = hn::Add(hn::Add(hn::Abs(origin.x), hn::Abs(origin.y)), hn::Abs(origin.z));
        const Number radius = hn::Add(number(1 + 8 * kBoxMargin), hn::Mul(number(1e-14), far));
        const Number to_nearest = hn::Neg(dot(origin, direction));
        const Vector nearest = along(origin, to_nearest, direction);
        const Number half_chord_2 = hn::Sub(hn::Mul(radius, radius), dot(nearest, nearest));
        const Number half_chord = hn::Sqrt(hn::Max(half_chord_2, zero));
        const Number enter = hn::Max(hn::Sub(to_nearest, half_chord), zero);
        const Number leave = hn::Min(hn::Add(to_nearest, half_chord), speed);
        const Truth finite = hn::And(hn::IsFinite(speed), hn::IsFinite(dot(origin, origin)));
        const Truth meets = hn::And(hn::And(finite, hn::Gt(half_chord_2, zero)),
                                    hn::And(hn::Gt(speed, zero), hn::Le(enter, leave)));
        local.meets |= bits_of(hn::And(meets, usual)) << first;
        local.unusual |= bits_of(hn::Not(usual)) << first;

        store(along(nearest, hn::Sub(enter, to_nearest), direction), local.origin, first);
        store(direction, local.direction, first);
        const Number length = hn::Add(hn::Sub(leave, enter), number(4 * kBoxMargin));
        const auto above = hn::Set(kFloatTag, 1 + 0x1p-21f);  // more than both roundings take away
        hn::Store(hn::Mul(hn::DemoteTo(kFloatTag, length), above), kFloatTag, local.length + first);
    }
}

Segments::Bits may_meet_here(const Segments& segments, const Box& box) {
    // Segment and box are apart where a side of the box, or a side and the segment, have a plane between
    // them. Every comparison with what is no number says that they may meet.
    const Vec3 middle = 0.5 * box.low + 0.5 * box.high, half = 0.5 * box.high - 0.5 * box.low;
    const Vector side = vector(half);
    Segments::Bits apart = 0;
    for (std::size_t first = 0; first < segments.count; first += kWidth) {
        const Vector step = load(segments.step, first), from = load(segments.from, first);
        const Vector way = times(number(0.5), step);
        const Vector off = minus(plus(from, way), vector(middle));
        const Vector reach{hn::Abs(way.x), hn::Abs(way.y), hn::Abs(way.z)};
        const auto beyond = [](Number distance, Number own, Number other) {
            return hn::Gt(hn::Abs(distance), hn::Add(own, other));
        };
        const auto beside = [&](Number way_a, Number way_b, Number off_a, Number off_b, Number side_a,
                                Number side_b, Number reach_a, Number reach_b) {
            return beyond(hn::Sub(hn::Mul(way_a, off_b), hn::Mul(way_b, off_a)), hn::Mul(side_a, reach_b),
                          hn::Mul(side_b, reach_a));
        };
        const Truth on_axes = hn::Or(hn::Or(beyond(off.x, side.x, reach.x), beyond(off.y, side.y, reach.y)),
                                     beyond(off.z, side.z, reach.z));
        const Truth around =
            hn::Or(hn::Or(beside(way.x, way.y, off.x, off.y, side.x, side.y, reach.x, reach.y),
                          beside(way.y, way.z, off.y, off.z, side.y, side.z, reach.y, reach.z)),
                   beside(way.z, way.x, off.z, off.x, side.z, side.x, reach.z, reach.x));
        apart |= bits_of(hn::Or(on_axes, around)) << first;
    }
    return ~apart;
}

std::uint64_t balls_met_here(const PatchBalls& balls, const RayStretch& ray) {
    static_assert(PatchBalls::kWidest % kWidth == 0);
    const Vector origin = vector(ray.origin), direction = vector(ray.direction);
    const Number from = number(ray.from), to = number(ray.to);
    std::uint64_t met = 0;
    for (std::size_t first = 0; first < balls.count(); first += kWidth) {
        const auto row = [&](std::size_t number) { return hn::LoadU(kTag, balls.row(number) + first); };
        const Vector middle{row(0), row(1), row(2)};
        const Vector off = minus(middle, origin);
        const Number nearest = hn::Min(hn::Max(dot(off, direction), from), to);
        const Vector away = minus(off, times(nearest, direction));
        const Truth is_met = hn::Le(dot(away, away), row(3));
        met |= std::uint64_t{bits_of(is_met)} << first;
    }
    return met;
}

}  // namespace HWY_NAMESPACE
}  // namespace trilens::segment_lanes
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace trilens {
namespace segment_lanes {
HWY_EXPORT(make_local_here);
HWY_EXPORT(may_meet_here);
HWY_EXPORT(balls_met_here);
}  // namespace segment_lanes

LocalSegments make_local_segments(const Segments& segments, const Vec3& centre, double scale) {
    using namespace segment_lanes;
    LocalSegments local;
    HWY_DYNAMIC_DISPATCH(make_local_here)(segments, centre, scale, local);
    local.meets &= segments.all();
    local.unusual &= segments.all();
    return local;
}

Segments::Bits may_meet(const Segments& segments, const Box& box) {
    using namespace segment_lanes;
    return HWY_DYNAMIC_DISPATCH(may_meet_here)(segments, box) & segments.all();
}

std::uint64_t balls_met(const PatchBalls& balls, const RayStretch& ray) {
    using namespace segment_lanes;
    return HWY_DYNAMIC_DISPATCH(balls_met_here)(balls, ray);
}

}  // namespace trilens
#endif
