#include "specular/simd_bounds.h"

#include <limits>

#include "specular/specular_point.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "specular/simd_bounds.cpp"
#include <hwy/foreach_target.h>
#include "base/math/double_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace trilens::specular {
namespace HWY_NAMESPACE {
using namespace lanes::HWY_NAMESPACE;
namespace hn = hwy::HWY_NAMESPACE;

static_assert(kPointLanes % kWidth == 0);

/// h . normal, and what it is compared with, this far from zero is far from singular: a share of n1 + n2.
constexpr double kClearBend = 0.02;

HWY_INLINE Number scaled(double s, Number a) {
    return hn::Mul(number(s), a);
}

/// Sight from each lane's point to the place.
struct Sights {
    Truth apart;
    Vector direction;
    Number distance, by_distance, sine, turn;
};

HWY_INLINE Sights sights_of(const Vector& points, const Vec3& position, double radius) {
    Sights sights;
    const Vector way = minus(vector(position), points);
    sights.distance = hn::Sqrt(dot(way, way));
    sights.apart = hn::Gt(sights.distance, number(radius));
    sights.by_distance = hn::Div(number(1), sights.distance);
    sights.direction = times(sights.by_distance, way);
    sights.sine = scaled(radius, sights.by_distance);
    // chord_of.
    sights.turn = hn::Mul(sights.sine, hn::Add(number(1), scaled(0.4143, hn::Mul(sights.sine, sights.sine))));
    return sights;
}

HWY_INLINE Vector points_from(const PointLanes& points, std::size_t first) {
    return vector_at(points.x + first, points.y + first, points.z + first);
}

constexpr LaneBits kAllOfVector = (LaneBits{1} << kWidth) - 1;

/// h = n1 e + n2 x in the middle of a place, and how much h . m for a fixed m changes when both h and a
/// normal go over the place.
struct Bend {
    Vector middle;
    Number most;
};

HWY_INLINE Bend bend_of(const PathIndices& n, const Sights& sights, const PlaceBounds& place,
                        const EyeView& view) {
    const Vector bend =
        plus(times(number(n.eye), vector(view.sight.direction)), times(number(n.point), sights.direction));
    const Number turn = hn::Add(number(n.eye * view.sight.turn), scaled(n.point, sights.turn));
    const Number size = hn::Sqrt(dot(bend, bend));
    return {bend, hn::Add(turn, hn::Mul(hn::Add(size, turn), number(place.normal_radius)))};
}

HWY_INLINE Truth empty_of(const LaneQuestion& question, const Vector& points, const PlaceBounds& place,
                          const EyeView& view) {
    const Sights sights = sights_of(points, place.position, place.position_radius);
    const Vector normal = vector(place.normal);
    const Number normal_radius = number(place.normal_radius);
    Truth empty = hn::FirstN(kTag, 0);
    if (view.knows_side) {
        const Number cosine = dot(sights.direction, normal);
        const Truth known = hn::Not(hn::Le(hn::Abs(cosine), hn::Add(sights.turn, normal_radius)));
        const Truth reflects = hn::Gt(scaled(view.cosine, cosine), number(0));
        empty = hn::And(known, question.reflects ? hn::Not(reflects) : reflects);
    }
    const Bend bend = bend_of(question.n, sights, place, view);
    const Vector across = minus(bend.middle, times(dot(bend.middle, normal), normal));
    empty = hn::Or(empty, hn::Gt(dot(across, across), hn::Mul(bend.most, bend.most)));
    return hn::And(sights.apart, empty);
}

LaneBits empty_lanes_here(const LaneQuestion& question, const PlaceBounds& place, const EyeView& view) {
    LaneBits empty = 0;
    for (std::size_t first = 0; first < kPointLanes; first += kWidth)
        if (question.asked >> first & kAllOfVector)
            empty |= bits_of(empty_of(question, points_from(question.points, first), place, view)) << first;
    return empty & question.asked;
}

HWY_INLINE Truth alone_of(const LaneQuestion& question, const PlaceBounds& place, const EyeView& view,
                          const ZeroLanes& zeros, double curvature, std::size_t first) {
    const PathIndices& n = question.n;
    const Sights sights =
        sights_of(points_from(question.points, first), place.position, place.position_radius);
    const Bend bend = bend_of(n, sights, place, view);
    const Number middle = dot(bend.middle, vector(place.normal));
    const Number margin = number(kClearBend * (n.eye + n.point)), along = hn::Load(kTag, zeros.along + first);
    const Number high = hn::Max(along, hn::Add(middle, bend.most));
    const Number low = hn::Min(along, hn::Sub(middle, bend.most));
    const Truth bends_back = hn::Le(high, hn::Neg(margin));

    // The chords from the zero into the place lie within this of the place's middle.
    const Vector way = minus(points_from(zeros.at, first), vector(place.position));
    const Number reach = hn::Add(hn::Sqrt(dot(way, way)), number(place.position_radius));
    const Number by_eye = number(view.sight.by_distance);
    const Number to_eye = hn::Sub(number(1), hn::Mul(by_eye, reach));
    const Number to_point = hn::Sub(sights.distance, reach);
    const Number turning =
        hn::Add(hn::Div(scaled(n.eye, by_eye), to_eye), hn::Div(number(n.point), to_point));
    const Truth outside = hn::And(hn::Gt(to_eye, number(0)), hn::Gt(to_point, number(0)));
    const Truth bends_more =
        hn::And(outside, hn::Ge(scaled(curvature, hn::Sub(low, margin)), scaled(1 + kClearBend, turning)));
    return hn::And(sights.apart, hn::Or(bends_back, bends_more));
}

LaneBits alone_lanes_here(const LaneQuestion& question, const PlaceBounds& place, const EyeView& view,
                          const ZeroLanes& zeros, double curvature) {
    LaneBits alone = 0;
    for (std::size_t first = 0; first < kPointLanes; first += kWidth)
        if ((question.asked & zeros.known) >> first & kAllOfVector)
            alone |= bits_of(alone_of(question, place, view, zeros, curvature, first)) << first;
    return alone & question.asked & zeros.known;
}

struct Pair {
    Number x, y;
};

struct Verdicts {
    Truth leaves, contracts, open, narrow;
};

HWY_INLINE Number turning_radius(const Sights& point, Number stretch, const Reach& a, const Reach& b) {
    const Number along =
        hn::Add(number(a.radius * b.all + a.length * b.radius), scaled(a.length * b.all, point.sine));
    return hn::Add(scaled(a.all * b.all, stretch), hn::Mul(point.by_distance, along));
}

HWY_INLINE Verdicts newton_of(const CellTerms& cell, const Vector& points, const Vec2& half) {
    const SurfacePoint& m = cell.bounds->middle;
    const Sights point = sights_of(points, m.position, cell.bounds->position_radius);
    const Vector bend = plus(vector(cell.eye_bend), times(number(cell.n.point), point.direction));
    const Number bend_size = hn::Sqrt(dot(bend, bend));
    const Number bend_turn = hn::Add(number(cell.eye_turn), scaled(cell.n.point, point.turn));
    const Number stretch = hn::Div(hn::Mul(point.by_distance, point.sine), hn::Sub(number(1), point.sine));
    const auto radius = [&](double eye, const Reach& a, const Reach& b, const Reach& second) {
        const Number turning =
            hn::Add(number(eye), scaled(cell.n.point, turning_radius(point, stretch, a, b)));
        return hn::Add(turning, hn::Add(scaled(second.all, bend_turn), scaled(second.radius, bend_size)));
    };
    const Number uu = radius(cell.eye_uu, cell.u, cell.u, cell.uu);
    const Number uv = radius(cell.eye_uv, cell.u, cell.v, cell.uv);
    const Number vv = radius(cell.eye_vv, cell.v, cell.v, cell.vv);

    // The Hessian in the middle, and its inverse.
    const Vector du = vector(m.du), dv = vector(m.dv);
    const Number share = scaled(cell.n.point, point.by_distance);
    const auto change = [&](const Vec3& eye, const Vector& step) {
        const Vector turned = minus(step, times(dot(point.direction, step), point.direction));
        return plus(vector(eye), times(share, turned));
    };
    const Vector change_u = change(cell.eye_change_u, du), change_v = change(cell.eye_change_v, dv);
    const Number a = hn::Add(dot(change_u, du), dot(bend, vector(m.duu)));
    const Number b = hn::Add(dot(change_u, dv), dot(bend, vector(m.duv)));
    const Number d = hn::Add(dot(change_v, dv), dot(bend, vector(m.dvv)));
    const Number by_determinant = hn::Div(number(1), hn::Sub(hn::Mul(a, d), hn::Mul(b, b)));
    const Number inverse_uu = hn::Mul(d, by_determinant), inverse_vv = hn::Mul(a, by_determinant);
    const Number inverse_uv = hn::Neg(hn::Mul(b, by_determinant));
    const auto product = [&](const Pair& of) {
        return Pair{hn::Add(hn::Mul(hn::Abs(inverse_uu), of.x), hn::Mul(hn::Abs(inverse_uv), of.y)),
                    hn::Add(hn::Mul(hn::Abs(inverse_uv), of.x), hn::Mul(hn::Abs(inverse_vv), of.y))};
    };
    const Pair law = {dot(bend, du), dot(bend, dv)};
    const Pair step = {hn::Add(hn::Mul(inverse_uu, law.x), hn::Mul(inverse_uv, law.y)),
                       hn::Add(hn::Mul(inverse_uv, law.x), hn::Mul(inverse_vv, law.y))};
    const Pair spread = product(
        {hn::Add(scaled(half.x, uu), scaled(half.y, uv)), hn::Add(scaled(half.x, uv), scaled(half.y, vv))});

    // As rounding_of_law has it.
    constexpr double kRounding = 64 * std::numeric_limits<double>::epsilon();
    const Number coordinate = hn::Max(
        number(cell.coordinate), hn::Max(hn::Abs(points.x), hn::Max(hn::Abs(points.y), hn::Abs(points.z))));
    const Number of_eye = scaled(cell.n.eye, hn::Add(number(1), scaled(cell.eye_by_distance, coordinate)));
    const Number of_point = scaled(cell.n.point, hn::Add(number(1), hn::Mul(coordinate, point.by_distance)));
    const Number rounding = scaled(kRounding, hn::Add(of_eye, of_point));
    const Pair lost = product({scaled(cell.u.length, rounding), scaled(cell.v.length, rounding)});

    const Number border = number(kCellBorder);
    const auto leaves = [&](double side, Number at, Number wide, Number off) {
        return hn::Gt(hn::Abs(at), hn::Add(hn::Add(number(side), wide), hn::Add(off, border)));
    };
    const Truth finite = hn::IsFinite(
        hn::Add(hn::Add(hn::Add(step.x, step.y), hn::Add(spread.x, spread.y)), hn::Add(lost.x, lost.y)));
    const Truth known = hn::And(point.apart, finite);
    const Truth leaving = hn::And(
        known, hn::Or(leaves(half.x, step.x, spread.x, lost.x), leaves(half.y, step.y, spread.y, lost.y)));
    const Truth contracting = hn::And(hn::Le(spread.x, number(kContraction * half.x)),
                                      hn::Le(spread.y, number(kContraction * half.y)));
    const Truth inside =
        hn::And(hn::Le(hn::Abs(step.x), number(half.x)), hn::Le(hn::Abs(step.y), number(half.y)));
    // With room for rounding.
    constexpr double kSurely = 1e-6;
    const auto stays = [&](double side, Number at, Number wide) {
        return hn::Le(hn::Abs(at), scaled(1 - kSurely, hn::Add(number(side), wide)));
    };
    const auto is_wider = [&](double part) {
        return hn::Or(hn::Gt(spread.x, number(part * half.x)), hn::Gt(spread.y, number(part * half.y)));
    };
    const Truth wide = is_wider(kAloneShare + kSurely);
    const Truth narrow = hn::AndNot(is_wider(kAloneShare - kSurely), is_wider(kContraction + kSurely));
    const Truth staying = hn::And(stays(half.x, step.x, spread.x), stays(half.y, step.y, spread.y));
    return {leaving, hn::AndNot(leaving, hn::And(known, hn::And(contracting, inside))),
            hn::And(known, hn::And(wide, staying)), hn::And(known, hn::And(narrow, staying))};
}

NewtonLanes newton_lanes_here(const LaneQuestion& question, const CellTerms& cell, const Vec2& half) {
    NewtonLanes result;
    for (std::size_t first = 0; first < kPointLanes; first += kWidth) {
        if (!(question.asked >> first & kAllOfVector)) continue;
        const Verdicts verdicts = newton_of(cell, points_from(question.points, first), half);
        result.leaves |= bits_of(verdicts.leaves) << first;
        result.contracts |= bits_of(verdicts.contracts) << first;
        result.open |= bits_of(verdicts.open) << first;
        result.narrow |= bits_of(verdicts.narrow) << first;
    }
    result.leaves &= question.asked;
    result.contracts &= question.asked;
    result.open &= question.asked;
    result.narrow &= question.asked;
    return result;
}

}  // namespace HWY_NAMESPACE
}  // namespace trilens::specular
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace trilens {
namespace specular {
HWY_EXPORT(empty_lanes_here);
HWY_EXPORT(alone_lanes_here);
HWY_EXPORT(newton_lanes_here);
}  // namespace specular

LaneBits empty_lanes(const LaneQuestion& question, const PlaceBounds& place, const EyeView& view) {
    using namespace specular;
    if (view.is_behind) return question.asked;
    // Where every direction may be a normal no light is excluded.
    if (place.normal_radius >= 1 || !view.is_apart) return 0;
    return HWY_DYNAMIC_DISPATCH(empty_lanes_here)(question, place, view);
}

LaneBits alone_lanes(const LaneQuestion& question, const PlaceBounds& place, const EyeView& view,
                     const ZeroLanes& zeros, double curvature) {
    using namespace specular;
    if (!(curvature > 0) || place.normal_radius >= 1 || !view.is_apart) return 0;
    return HWY_DYNAMIC_DISPATCH(alone_lanes_here)(question, place, view, zeros, curvature);
}

NewtonLanes newton_lanes(const LaneQuestion& question, const CellTerms& cell, const Vec2& half) {
    using namespace specular;
    return HWY_DYNAMIC_DISPATCH(newton_lanes_here)(question, cell, half);
}

}  // namespace trilens
#endif
