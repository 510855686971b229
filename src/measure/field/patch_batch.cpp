#include "measure/field/patch.h"


#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "measure/field/patch_batch.cpp"
#include <hwy/foreach_target.h>
#include "base/math/double_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace trilens::patches {
namespace HWY_NAMESPACE {
using namespace lanes::HWY_NAMESPACE;
namespace hn = hwy::HWY_NAMESPACE;

static_assert(kPatchLanes % kWidth == 0);

struct Vector2 {
    Number x, y;
};
HWY_INLINE Number norm(const Vector& a) {
    return hn::Sqrt(dot(a, a));
}

struct Tangents {
    Vector value, du, dv;
};

/// The lanes first .. first + kWidth - 1 of a batch.
struct Lanes {
    PatchBatch& batch;
    std::size_t first;

    HWY_INLINE Number load(const PatchBatch::Lane& of) const { return hn::Load(kTag, of.lane + first); }
    HWY_INLINE void store(Number value, PatchBatch::Lane& to) const {
        hn::Store(value, kTag, to.lane + first);
    }
    HWY_INLINE Vector node(std::size_t i) const {
        return {load(batch.nodes[i][0]), load(batch.nodes[i][1]), load(batch.nodes[i][2])};
    }
};

HWY_INLINE Tangents bilinear(const Lanes& n, const Vector2& uv) {
    const Vector p00 = n.node(5), p10 = n.node(6), p01 = n.node(9), p11 = n.node(10);
    const Vector twist = plus(minus(minus(p11, p10), p01), p00), du = minus(p10, p00), dv = minus(p01, p00);
    return {plus(plus(plus(p00, times(uv.x, du)), times(uv.y, dv)), times(hn::Mul(uv.x, uv.y), twist)),
            plus(du, times(uv.y, twist)), plus(dv, times(uv.x, twist))};
}

/// The cubic through values at -1, 0, 1, 2 (Lagrange): weights and their derivatives.
struct Cubic {
    Number weight[4], slope[4];
};

HWY_INLINE Cubic cubic_at(Number s) {
    const Number a = hn::Add(s, number(1)), b = s, c = hn::Sub(s, number(1)), d = hn::Sub(s, number(2));
    const Number half = number(0.5), six = number(6);
    const Number bc = hn::Mul(b, c), bd = hn::Mul(b, d), cd = hn::Mul(c, d);
    const Number ab = hn::Mul(a, b), ac = hn::Mul(a, c), ad = hn::Mul(a, d);
    return {
        {hn::Div(hn::Neg(hn::Mul(bc, d)), six), hn::Mul(hn::Mul(ac, d), half),
         hn::Neg(hn::Mul(hn::Mul(ab, d), half)), hn::Div(hn::Mul(ab, c), six)},
        {hn::Div(hn::Neg(hn::Add(hn::Add(cd, bd), bc)), six), hn::Mul(hn::Add(hn::Add(cd, ad), ac), half),
         hn::Mul(hn::Neg(hn::Add(hn::Add(bd, ad), ab)), half), hn::Div(hn::Add(hn::Add(bc, ac), ab), six)}};
}

HWY_INLINE Tangents bicubic(const Lanes& n, const Vector2& uv) {
    const Cubic u = cubic_at(uv.x), v = cubic_at(uv.y);
    const Vector zero = {number(0), number(0), number(0)};
    Tangents result = {zero, zero, zero};
    for (std::size_t b = 0; b < 4; ++b) {
        Vector value = zero, slope = zero;
        for (std::size_t a = 0; a < 4; ++a) {
            const Vector node = n.node(a + 4 * b);
            value = plus(value, times(u.weight[a], node));
            slope = plus(slope, times(u.slope[a], node));
        }
        result.value = plus(result.value, times(v.weight[b], value));
        result.du = plus(result.du, times(v.weight[b], slope));
        result.dv = plus(result.dv, times(v.slope[b], value));
    }
    return result;
}

/// Where each lane stands, and the length of its last move: small where it arrived.
struct Walk {
    Vector2 uv;
    Number size;
};

/// One step of the lanes that are `under_way` to where their surface comes closest to the origin; returns
/// those that go on. Moves are at most half a cell; a direction in which the surface stands still is not
/// followed.
HWY_INLINE Truth step(const Tangents& t, Truth under_way, Walk& walk) {
    const Number g0 = dot(t.du, t.value), g1 = dot(t.dv, t.value);
    const Number a0 = dot(t.du, t.du), d0 = dot(t.dv, t.dv), b = dot(t.du, t.dv);
    const Number sum = hn::Add(a0, d0), damping = hn::Mul(number(1e-14), sum);
    const Truth moves = hn::And(under_way, hn::Gt(sum, number(0)));
    const Number a = hn::Add(a0, damping), d = hn::Add(d0, damping);
    const Number determinant = hn::Sub(hn::Mul(a, d), hn::Mul(b, b));
    Vector2 move = {hn::Div(hn::Sub(hn::Mul(b, g1), hn::Mul(d, g0)), determinant),
                    hn::Div(hn::Sub(hn::Mul(b, g0), hn::Mul(a, g1)), determinant)};
    const Number size = hn::Sqrt(hn::Add(hn::Mul(move.x, move.x), hn::Mul(move.y, move.y)));
    const Number share = hn::IfThenElse(hn::Gt(size, number(0.5)), hn::Div(number(0.5), size), number(1));
    const auto moved = [&](Number from, Number by) {
        const Number to = hn::Add(from, hn::Mul(by, share));
        return hn::IfThenElse(moves, smaller(larger(to, number(-1)), number(2)), from);
    };
    walk.uv = {moved(walk.uv.x, move.x), moved(walk.uv.y, move.y)};
    walk.size = hn::IfThenElse(under_way, hn::IfThenElse(moves, size, number(0)), walk.size);
    return hn::And(moves, hn::Gt(size, number(1e-10)));
}

/// `lanes` walk until they arrive, at most so many steps; `longer`: kMostSteps.
template <typename Surface>
HWY_INLINE void gauss_newton(const Surface& surface, Truth lanes, int steps, Truth longer, Walk& walk) {
    constexpr int kMostSteps = 12;
    walk.size = hn::IfThenElse(lanes, number(0), walk.size);
    Truth under_way = lanes;
    for (int i = 0; i < kMostSteps; ++i) {
        if (i == steps) under_way = hn::And(under_way, longer);
        if (hn::AllFalse(kTag, under_way)) return;
        under_way = step(surface(walk.uv), under_way, walk);
    }
}

/// How much the flat cell's value at uv rests on corners that are mere extrapolation.
HWY_INLINE Number extrapolated_share(const Lanes& n, const Vector2& uv) {
    const Number u = uv.x, v = uv.y, one = number(1);
    const Number weight[4] = {hn::Mul(hn::Sub(one, u), hn::Sub(one, v)), hn::Mul(u, hn::Sub(one, v)),
                              hn::Mul(hn::Sub(one, u), v), hn::Mul(u, v)};
    Number share = number(0);
    for (std::size_t corner = 0; corner < 4; ++corner)
        share = hn::Add(share, hn::Mul(n.load(n.batch.extrapolated[corner]), hn::Abs(weight[corner])));
    return share;
}
constexpr double kMostExtrapolated = 0.25;

constexpr double kArrived = 1e-4;  // pixels

HWY_INLINE Truth is_smooth(const Lanes& n) {
    Truth smooth = hn::FirstN(kTag, kWidth);
    for (const std::size_t along : {std::size_t{1}, std::size_t{4}}) {
        Number longest = number(0), third = number(0);
        for (std::size_t line = 0; line < 4; ++line) {
            const std::size_t i = line * (5 - along);
            const Vector p0 = n.node(i), p1 = n.node(i + along), p2 = n.node(i + 2 * along),
                         p3 = n.node(i + 3 * along);
            const Vector a = minus(p1, p0), b = minus(p2, p1), c = minus(p3, p2);
            const Vector d3 = plus(minus(c, times(number(2), b)), a);
            longest = larger(larger(longest, dot(a, a)), larger(dot(b, b), dot(c, c)));
            third = larger(third, dot(d3, d3));
        }
        smooth = hn::And(smooth, hn::Le(third, hn::Mul(number(kSmoothThird), longest)));
    }
    return smooth;
}

HWY_INLINE Number outside_of(const Vector2& uv) {
    const Number one = number(1);
    return larger(
        larger(larger(hn::Neg(uv.x), hn::Sub(uv.x, one)), larger(hn::Neg(uv.y), hn::Sub(uv.y, one))),
        number(0));
}

/// Whether the origin lies on the surface at uv, where the surface comes closest to it. What is left is along
/// the normal; it may be as large as the surface's own bends between pixels (a crease, facets as small as
/// pixels), a twentieth of the shorter tangent, and the rounding of float positions.
HWY_INLINE Truth lies_on(const Lanes& n, const Tangents& at, Number rounding) {
    const Vector normal = unit_or_zero(cross(at.du, at.dv));
    Number height[16];
    for (std::size_t i = 0; i < 16; ++i) height[i] = dot(normal, n.node(i));
    Number bend = number(0);
    for (const std::size_t along : {std::size_t{1}, std::size_t{4}}) {
        for (std::size_t line = 0; line < 4; ++line) {
            const Number* h = &height[line * (5 - along)];
            for (const std::size_t i : {std::size_t{0}, along}) {
                const Number second =
                    hn::Add(hn::Sub(h[i], hn::Mul(number(2), h[i + along])), h[i + 2 * along]);
                bend = larger(bend, hn::Abs(second));
            }
        }
    }
    const Number tangent = hn::Sqrt(smaller(dot(at.du, at.du), dot(at.dv, at.dv)));
    const Number most = hn::Add(
        hn::Add(hn::Mul(number(kBendShare), bend), hn::Mul(number(kTangentShare), tangent)), rounding);
    return hn::Le(norm(at.value), most);
}

/// Returns which of the lanes have a hit.
HWY_INLINE Truth invert(const Lanes& n, Truth asked) {
    const auto cell = [&](const Vector2& at) { return bilinear(n, at); };
    const auto cubic = [&](const Vector2& at) { return bicubic(n, at); };
    const Truth smooth = is_smooth(n);

    // The flat cell leads near; a point far outside it is not in the curved one either.
    Walk walk = {{n.load(n.batch.start[0]), n.load(n.batch.start[1])}, number(0)};
    gauss_newton(cell, asked, 4, hn::Not(smooth), walk);
    Truth near = hn::And(asked, hn::Le(outside_of(walk.uv), number(2 * kOvershoot)));
    const Truth curved = hn::And(near, smooth);
    if (!hn::AllFalse(kTag, curved)) gauss_newton(cubic, curved, 12, curved, walk);

    const Number overshoot = outside_of(walk.uv);
    near = hn::And(near, hn::And(hn::Le(overshoot, number(kOvershoot)), hn::Le(walk.size, number(kArrived))));
    near = hn::And(near, hn::Or(smooth, hn::Le(extrapolated_share(n, walk.uv), number(kMostExtrapolated))));
    if (hn::AllFalse(kTag, near)) return near;
    Tangents there = bilinear(n, walk.uv);
    if (!hn::AllFalse(kTag, hn::And(near, smooth))) {
        const Tangents bent = bicubic(n, walk.uv);
        there = {either(smooth, bent.value, there.value), either(smooth, bent.du, there.du),
                 either(smooth, bent.dv, there.dv)};
    }
    n.store(walk.uv.x, n.batch.u);
    n.store(walk.uv.y, n.batch.v);
    n.store(overshoot, n.batch.overshoot);
    return hn::And(near, lies_on(n, there, hn::Mul(number(kRounding), n.load(n.batch.size))));
}

void invert_patches_here(PatchBatch& batch) {
    batch.hits = 0;
    for (std::size_t first = 0; first < batch.count; first += kWidth) {
        const Lanes lanes{batch, first};
        const Truth asked = hn::FirstN(kTag, batch.count - first);
        batch.hits |= bits_of(invert(lanes, asked)) << first;
    }
}

}  // namespace HWY_NAMESPACE
}  // namespace trilens::patches
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace trilens {
namespace patches {
HWY_EXPORT(invert_patches_here);
}

void PatchBatch::ask(std::size_t lane, const Vec3& point, const Vec2& from, std::uint16_t supported) {
    for (int k = 0; k < 2; ++k) start[k].lane[lane] = from[k];
    size.lane[lane] = length(point);
    for (std::size_t corner = 0; corner < 4; ++corner)
        extrapolated[corner].lane[lane] = (supported >> kCellCorner[corner]) & 1 ? 0 : 1;
}

void invert_patches(PatchBatch& batch) {
    using namespace patches;
    HWY_DYNAMIC_DISPATCH(invert_patches_here)(batch);
}

std::optional<PatchHit> invert_patch(const Patch& patch, const Vec3& point, const Vec2& start) {
    PatchBatch batch;
    batch.count = 1;
    batch.ask(0, point, start, patch.supported);
    for (std::size_t i = 0; i < 16; ++i) batch.set_node(0, i, patch.nodes[i] - point);
    invert_patches(batch);
    if (!batch.has_hit(0)) return std::nullopt;
    return PatchHit{{batch.u.lane[0], batch.v.lane[0]}, batch.overshoot.lane[0]};
}

}  // namespace trilens
#endif
