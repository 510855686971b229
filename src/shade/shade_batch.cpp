#include "shade/shade_batch.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "shade/shade_batch.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace trilens::shade_lanes {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// Sums and products one by one, never fused, and in the order of shade_hit, so that every instruction set
// rounds as it does.

using Tag = hn::CappedTag<double, 8>;
using Number = hn::Vec<Tag>;
using Truth = hn::Mask<Tag>;
inline constexpr Tag kTag;
constexpr std::size_t kWidth = hn::MaxLanes(kTag);
static_assert(kShadeLanes % kWidth == 0);

HWY_INLINE Number number(double x) {
    return hn::Set(kTag, x);
}
HWY_INLINE Number larger(Number a, Number b) {
    return hn::IfThenElse(hn::Lt(a, b), b, a);
}
HWY_INLINE Number smaller(Number a, Number b) {
    return hn::IfThenElse(hn::Lt(b, a), b, a);
}

struct Vector {
    Number x, y, z;
};
HWY_INLINE Vector vector(const Vec3& v) {
    return {number(v.x), number(v.y), number(v.z)};
}
HWY_INLINE Vector load(const ShadeLanes3& from, std::size_t first) {
    return {hn::Load(kTag, from.x + first), hn::Load(kTag, from.y + first), hn::Load(kTag, from.z + first)};
}
HWY_INLINE void store(const Vector& v, ShadeLanes3& to, std::size_t first) {
    hn::Store(v.x, kTag, to.x + first);
    hn::Store(v.y, kTag, to.y + first);
    hn::Store(v.z, kTag, to.z + first);
}
HWY_INLINE Vector plus(const Vector& a, const Vector& b) {
    return {hn::Add(a.x, b.x), hn::Add(a.y, b.y), hn::Add(a.z, b.z)};
}
HWY_INLINE Vector minus(const Vector& a, const Vector& b) {
    return {hn::Sub(a.x, b.x), hn::Sub(a.y, b.y), hn::Sub(a.z, b.z)};
}
HWY_INLINE Vector times(Number s, const Vector& a) {
    return {hn::Mul(s, a.x), hn::Mul(s, a.y), hn::Mul(s, a.z)};
}
HWY_INLINE Vector over(const Vector& a, Number s) {
    return {hn::Div(a.x, s), hn::Div(a.y, s), hn::Div(a.z, s)};
}
HWY_INLINE Number inner(const Vector& a, const Vector& b) {
    return hn::Add(hn::Add(hn::Mul(a.x, b.x), hn::Mul(a.y, b.y)), hn::Mul(a.z, b.z));
}
HWY_INLINE Vector outer(const Vector& a, const Vector& b) {
    return {hn::Sub(hn::Mul(a.y, b.z), hn::Mul(b.y, a.z)), hn::Sub(hn::Mul(a.z, b.x), hn::Mul(b.z, a.x)),
            hn::Sub(hn::Mul(a.x, b.y), hn::Mul(b.x, a.y))};
}
HWY_INLINE Vector either(Truth which, const Vector& a, const Vector& b) {
    return {hn::IfThenElse(which, a.x, b.x), hn::IfThenElse(which, a.y, b.y),
            hn::IfThenElse(which, a.z, b.z)};
}
HWY_INLINE Vector opposite(const Vector& a) {
    return {hn::Neg(a.x), hn::Neg(a.y), hn::Neg(a.z)};
}
HWY_INLINE ShadeBatch::Bits bits_of(Truth truth, std::size_t first) {
    std::uint8_t bytes[8] = {};
    hn::StoreMaskBits(kTag, truth, bytes);
    return static_cast<ShadeBatch::Bits>(bytes[0]) << first;
}
HWY_INLINE Truth truth_of(ShadeBatch::Bits bits, std::size_t first) {
    const std::uint8_t bytes[8] = {static_cast<std::uint8_t>(bits >> first)};
    return hn::LoadMaskBits(kTag, bytes);
}

/// As normalize_or_zero.
HWY_INLINE Vector unit_or_zero(const Vector& v) {
    const Number largest = larger(larger(hn::Abs(v.x), hn::Abs(v.y)), hn::Abs(v.z));
    const Truth usual = hn::AndNot(hn::Gt(largest, number(1.7e308)), hn::Gt(largest, number(0)));
    const Vector scaled = over(v, largest);
    const Vector unit = over(scaled, hn::Sqrt(inner(scaled, scaled)));
    return either(usual, unit, vector(Vec3(0)));
}

/// The lanes first .. first + kWidth - 1 of a batch.
struct Lanes {
    ShadeBatch& batch;
    std::size_t first;

    HWY_INLINE Number weight(int k) const { return hn::Load(kTag, batch.weight[k] + first); }
};

/// The corners' normals turned to one side, the smooth normal, and the point lifted to their tangent planes.
struct Smooth {
    Truth is_smooth;
    Vector normal, surface;
};

HWY_INLINE Smooth smooth_at(const Lanes& at, const Vector& geometric, const Vector& position) {
    Vector n[3];
    for (int k = 0; k < 3; ++k) n[k] = load(at.batch.corner_normal[k], at.first);
    const Vector smooth = unit_or_zero(
        plus(plus(times(at.weight(0), n[0]), times(at.weight(1), n[1])), times(at.weight(2), n[2])));
    const Truth none = hn::And(hn::And(hn::Eq(smooth.x, number(0)), hn::Eq(smooth.y, number(0))),
                               hn::Eq(smooth.z, number(0)));
    const Number side = hn::IfThenElse(hn::Lt(inner(smooth, geometric), number(0)), number(-1), number(1));

    Vector lifted = position;
    for (int k = 0; k < 3; ++k) {
        const Vector turned = times(side, n[k]);
        const Number depth =
            smaller(number(0), inner(minus(position, load(at.batch.corner[k], at.first)), turned));
        lifted = minus(lifted, times(hn::Mul(at.weight(k), depth), turned));
    }
    return {hn::Not(none), times(side, smooth), lifted};
}

void find_surfaces_here(ShadeBatch& batch, double offset) {
    batch.smooth = 0;
    for (std::size_t first = 0; first < batch.count; first += kWidth) {
        const Lanes at{batch, first};
        const Vector a = load(batch.corner[0], first), b = load(batch.corner[1], first),
                     c = load(batch.corner[2], first);
        const Vector position =
            plus(plus(times(at.weight(0), a), times(at.weight(1), b)), times(at.weight(2), c));
        const Vector upward = unit_or_zero(outer(minus(b, a), minus(c, a)));
        const Truth away = hn::Gt(inner(upward, load(batch.toward, first)), number(0));
        const Vector geometric = either(away, opposite(upward), upward);

        Vector normal = geometric, surface = position;
        if (batch.has_normals) {
            const Smooth smooth = smooth_at(at, geometric, position);
            normal = either(smooth.is_smooth, smooth.normal, normal);
            surface = either(smooth.is_smooth, smooth.surface, surface);
            batch.smooth |= bits_of(smooth.is_smooth, first);
        }
        store(position, batch.position, first);
        store(geometric, batch.geometric_normal, first);
        store(normal, batch.normal, first);
        store(plus(surface, times(number(offset), geometric)), batch.shadow_start, first);
        store(vector(Vec3(0)), batch.arriving, first);
    }
}

void find_light_here(ShadeBatch& batch, const ShadeLight& light) {
    constexpr double kInversePi = 0.31830988618379067154;
    batch.lit = 0;
    for (std::size_t first = 0; first < batch.count; first += kWidth) {
        const Vector position = load(batch.position, first), normal = load(batch.normal, first);
        Vector toward = vector(light.toward), target = plus(position, vector(light.far));
        Number irradiance = number(light.intensity);
        Truth lit = hn::FirstN(kTag, kWidth);
        if (light.is_point) {
            target = vector(light.position);
            const Vector step = minus(target, position);
            const Number distance2 = inner(step, step);
            lit = hn::Gt(distance2, number(0));
            toward = unit_or_zero(step);
            irradiance = hn::Div(irradiance, distance2);
        }
        const Number cosine = inner(normal, toward);
        lit = hn::AndNot(hn::Le(cosine, number(0)), lit);
        if (light.casts_shadows) {
            // Light that arrives from behind a flat triangle is in the triangle's own shadow.
            const Truth behind = hn::Le(inner(load(batch.geometric_normal, first), toward), number(0));
            lit = hn::AndNot(hn::AndNot(truth_of(batch.smooth, first), behind), lit);
            store(minus(target, load(batch.shadow_start, first)), batch.way, first);
        }
        hn::Store(hn::Mul(hn::Mul(number(kInversePi), irradiance), cosine), kTag, batch.irradiance + first);
        batch.lit |= bits_of(lit, first);
    }
}

void add_ambient_here(ShadeBatch& batch, const Vec3& radiance) {
    for (std::size_t first = 0; first < batch.count; first += kWidth)
        store(plus(load(batch.arriving, first), vector(radiance)), batch.arriving, first);
}

void add_light_here(ShadeBatch& batch, const Vec3& color, ShadeBatch::Bits lanes) {
    for (std::size_t first = 0; first < batch.count; first += kWidth) {
        const Vector before = load(batch.arriving, first);
        const Vector after = plus(before, times(hn::Load(kTag, batch.irradiance + first), vector(color)));
        store(either(truth_of(lanes, first), after, before), batch.arriving, first);
    }
}

}  // namespace HWY_NAMESPACE
}  // namespace trilens::shade_lanes
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace trilens {
namespace shade_lanes {
HWY_EXPORT(find_surfaces_here);
HWY_EXPORT(find_light_here);
HWY_EXPORT(add_ambient_here);
HWY_EXPORT(add_light_here);
}  // namespace shade_lanes

void find_surfaces(ShadeBatch& batch, double offset) {
    using namespace shade_lanes;
    HWY_DYNAMIC_DISPATCH(find_surfaces_here)(batch, offset);
}
void find_light(ShadeBatch& batch, const ShadeLight& light) {
    using namespace shade_lanes;
    HWY_DYNAMIC_DISPATCH(find_light_here)(batch, light);
}
void add_ambient(ShadeBatch& batch, const Vec3& radiance) {
    using namespace shade_lanes;
    HWY_DYNAMIC_DISPATCH(add_ambient_here)(batch, radiance);
}
void add_light(ShadeBatch& batch, const Vec3& color, ShadeBatch::Bits lanes) {
    using namespace shade_lanes;
    HWY_DYNAMIC_DISPATCH(add_light_here)(batch, color, lanes);
}

}  // namespace trilens
#endif
