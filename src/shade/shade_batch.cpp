#include "shade/shade_batch.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "shade/shade_batch.cpp"
#include <hwy/foreach_target.h>
#include "base/math/double_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace trilens::shade_lanes {
namespace HWY_NAMESPACE {
using namespace lanes::HWY_NAMESPACE;
namespace hn = hwy::HWY_NAMESPACE;

// In the order of shade_hit, so that it rounds alike.

static_assert(kShadeLanes % kWidth == 0);

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
    const Number side = hn::IfThenElse(hn::Lt(dot(smooth, geometric), number(0)), number(-1), number(1));

    Vector lifted = position;
    for (int k = 0; k < 3; ++k) {
        const Vector turned = times(side, n[k]);
        const Number depth =
            smaller(number(0), dot(minus(position, load(at.batch.corner[k], at.first)), turned));
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
        const Vector upward = unit_or_zero(cross(minus(b, a), minus(c, a)));
        const Truth away = hn::Gt(dot(upward, load(batch.toward, first)), number(0));
        const Vector geometric = either(away, opposite(upward), upward);

        Vector normal = geometric, surface = position;
        if (batch.has_normals) {
            const Smooth smooth = smooth_at(at, geometric, position);
            normal = either(smooth.is_smooth, smooth.normal, normal);
            surface = either(smooth.is_smooth, smooth.surface, surface);
            batch.smooth |= bits_of(smooth.is_smooth) << first;
        }
        store(position, batch.position, first);
        store(geometric, batch.geometric_normal, first);
        store(normal, batch.normal, first);
        store(plus(surface, times(number(offset), geometric)), batch.shadow_start, first);
        store(vector(Vec3(0)), batch.arriving, first);
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
        store(either(truth_of(lanes >> first), after, before), batch.arriving, first);
    }
}

}  // namespace HWY_NAMESPACE
}  // namespace trilens::shade_lanes
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace trilens {
namespace shade_lanes {
HWY_EXPORT(find_surfaces_here);
HWY_EXPORT(add_ambient_here);
HWY_EXPORT(add_light_here);
}  // namespace shade_lanes

void find_surfaces(ShadeBatch& batch, double offset) {
    using namespace shade_lanes;
    HWY_DYNAMIC_DISPATCH(find_surfaces_here)(batch, offset);
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
