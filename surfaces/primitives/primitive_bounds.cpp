// The mean value theorem with the largest derivatives over each whole face.
#include "surfaces/primitives/primitive_bounds.h"

#include <algorithm>
#include <cmath>

#include "base/description/lens_sag.h"

namespace trilens {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr double kQuarter = kPi / 2;  // all angles run over quarter turns

/// Rounding of one evaluation, as a share of the largest value of its kind.
constexpr double kRounding = 1e-14;

/// The largest lengths of the position's derivatives over a face.
struct Slopes {
    double u = 0, v = 0, uu = 0, uv = 0, vv = 0, uuu = 0, uuv = 0, uvv = 0, vvv = 0;
    double normal_u = 0, normal_v = 0;  // of the unit normal's
};

/// The cube's face on the sphere. The largest values lie at the face's corners, but for the first
/// derivatives: (pi/2)^k times 1, sqrt(32/27), sqrt(16/27), 16/9 and 2.35178, here rounded up.
Slopes slopes_of(const SpherePrimitive& sphere, Id) {
    const double radius = sphere.radius;
    const double first = kQuarter, second = first * kQuarter, third = second * kQuarter;
    Slopes s;
    s.u = s.v = radius * first;
    s.uu = s.vv = radius * 1.08867 * second;
    s.uv = radius * 0.76981 * second;
    s.uuu = s.vvv = radius * 1.77778 * third;
    s.uuv = s.uvv = radius * 2.35179 * third;
    s.normal_u = s.normal_v = first;
    return s;
}

Slopes slopes_of(const CylinderPrimitive& cylinder, Id) {
    Slopes s;
    s.u = cylinder.radius * kQuarter;
    s.uu = s.u * kQuarter;
    s.uuu = s.uu * kQuarter;
    s.v = cylinder.height;
    s.normal_u = kQuarter;
    return s;
}

/// (1 - v) radius (cos, sin)(u), height v: every derivative is largest at the base.
Slopes slopes_of(const ConePrimitive& cone, Id) {
    Slopes s;
    s.u = s.uv = cone.radius * kQuarter;
    s.uu = s.uuv = s.u * kQuarter;
    s.uuu = s.uu * kQuarter;
    s.v = std::hypot(cone.radius, cone.height);
    s.normal_u = kQuarter * cone.height / s.v;
    return s;
}

/// The paraboloid's disk. Its inner square: r/2 (tan a, tan b), whose tangents have derivatives up to pi,
/// pi^2 and 2 pi^3 at the corners. Its sides: (1 - u) r/2 (1, tan b) + u r (cos b, sin b).
Slopes disk_slopes(double rim, bool inner) {
    const double half = rim / 2;
    Slopes s;
    if (inner) {
        s.u = s.v = half * kPi;
        s.uu = s.vv = half * kPi * kPi;
        s.uuu = s.vvv = half * 2 * kPi * kPi * kPi;
        return s;
    }
    s.u = half;
    s.v = std::max(half * kPi, rim * kQuarter);
    s.uv = half * kPi + rim * kQuarter;
    s.vv = std::max(half * kPi * kPi, rim * kQuarter * kQuarter);
    s.uvv = half * kPi * kPi + rim * kQuarter * kQuarter;
    s.vvv = std::max(half * 2 * kPi * kPi * kPi, rim * kQuarter * kQuarter * kQuarter);
    return s;
}

/// Lifts the disk by |p|^2 / (4 focal length), by the product rule.
Slopes slopes_of(const ParaboloidPrimitive& paraboloid, Id face) {
    const Slopes p = disk_slopes(paraboloid.radius, face == 4);
    const double far = paraboloid.radius, lift = 1 / (2 * paraboloid.focal_length);
    Slopes s;
    s.u = std::hypot(p.u, lift * far * p.u);
    s.v = std::hypot(p.v, lift * far * p.v);
    s.uu = std::hypot(p.uu, lift * (p.u * p.u + far * p.uu));
    s.uv = std::hypot(p.uv, lift * (p.u * p.v + far * p.uv));
    s.vv = std::hypot(p.vv, lift * (p.v * p.v + far * p.vv));
    s.uuu = std::hypot(p.uuu, lift * (3 * p.u * p.uu + far * p.uuu));
    s.uuv = std::hypot(p.uuv, lift * (2 * p.u * p.uv + p.v * p.uu + far * p.uuv));
    s.uvv = std::hypot(p.uvv, lift * (2 * p.v * p.uv + p.u * p.vv + far * p.uvv));
    s.vvv = std::hypot(p.vvv, lift * (3 * p.v * p.vv + far * p.vvv));

    // The normal is along (-2 p, 4 focal length), and directions of vectors longer than 4 f turn by no more
    // than their change over 4 f.
    s.normal_u = lift * p.u;
    s.normal_v = lift * p.v;
    return s;
}

Slopes slopes_of(const PlanePrimitive& plane, Id) {
    Slopes s;
    s.u = plane.size.x;
    s.v = plane.size.y;
    return s;
}

/// (hole + u (rim - hole)) (cos, sin)(v): every derivative by v is largest at the rim.
Slopes ring_slopes(double hole, double rim) {
    Slopes s;
    s.u = rim - hole;
    s.uv = s.u * kQuarter;
    s.uvv = s.uv * kQuarter;
    s.v = rim * kQuarter;
    s.vv = s.v * kQuarter;
    s.vvv = s.vv * kQuarter;
    return s;
}

/// A side lifts the disk, or ring, by its sag f(|p|^2), by the chain rule with s = |p|^2.
Slopes side_slopes(const LensSide& side, const Slopes& p) {
    const double far = side.aperture;
    const auto [f1, f2, f3] = largest_slopes(side);
    const double su = 2 * far * p.u, sv = 2 * far * p.v;
    const double suu = 2 * (p.u * p.u + far * p.uu), suv = 2 * (p.u * p.v + far * p.uv),
                 svv = 2 * (p.v * p.v + far * p.vv);
    const double suuu = 2 * (3 * p.u * p.uu + far * p.uuu),
                 suuv = 2 * (2 * p.u * p.uv + p.v * p.uu + far * p.uuv),
                 suvv = 2 * (2 * p.v * p.uv + p.u * p.vv + far * p.uvv),
                 svvv = 2 * (3 * p.v * p.vv + far * p.vvv);
    Slopes s;
    s.u = std::hypot(p.u, f1 * su);
    s.v = std::hypot(p.v, f1 * sv);
    s.uu = std::hypot(p.uu, f2 * su * su + f1 * suu);
    s.uv = std::hypot(p.uv, f2 * su * sv + f1 * suv);
    s.vv = std::hypot(p.vv, f2 * sv * sv + f1 * svv);
    s.uuu = std::hypot(p.uuu, f3 * su * su * su + 3 * f2 * su * suu + f1 * suuu);
    s.uuv = std::hypot(p.uuv, f3 * su * su * sv + f2 * (suu * sv + 2 * su * suv) + f1 * suuv);
    s.uvv = std::hypot(p.uvv, f3 * su * sv * sv + f2 * (svv * su + 2 * sv * suv) + f1 * suvv);
    s.vvv = std::hypot(p.vvv, f3 * sv * sv * sv + 3 * f2 * sv * svv + f1 * svvv);

    // The normal is along (-2 f' p, 1), and directions of vectors longer than 1 turn by no more than their
    // change.
    s.normal_u = 2 * (f2 * su * far + f1 * p.u);
    s.normal_v = 2 * (f2 * sv * far + f1 * p.v);
    return s;
}

/// A side of another form, by the chain rule with its slopes along x and y.
Slopes uneven_side_slopes(const LensSide& side, const Slopes& p) {
    const SagBounds f = sag_bounds(side);
    Slopes s;
    s.u = std::hypot(p.u, f.first * p.u);
    s.v = std::hypot(p.v, f.first * p.v);
    s.uu = std::hypot(p.uu, f.second * p.u * p.u + f.first * p.uu);
    s.uv = std::hypot(p.uv, f.second * p.u * p.v + f.first * p.uv);
    s.vv = std::hypot(p.vv, f.second * p.v * p.v + f.first * p.vv);
    const double uuu = f.third * p.u * p.u * p.u + 3 * f.second * p.u * p.uu + f.first * p.uuu,
                 uuv = f.third * p.u * p.u * p.v + f.second * (p.uu * p.v + 2 * p.u * p.uv) + f.first * p.uuv,
                 uvv = f.third * p.u * p.v * p.v + f.second * (p.vv * p.u + 2 * p.v * p.uv) + f.first * p.uvv,
                 vvv = f.third * p.v * p.v * p.v + 3 * f.second * p.v * p.vv + f.first * p.vvv;
    s.uuu = std::hypot(p.uuu, uuu);
    s.uuv = std::hypot(p.uuv, uuv);
    s.uvv = std::hypot(p.uvv, uvv);
    s.vvv = std::hypot(p.vvv, vvv);

    // The normal is along (-slope, 1), as of round sides.
    s.normal_u = f.second * p.u;
    s.normal_v = f.second * p.v;
    return s;
}

/// Between rims of such radii.
Slopes edge_slopes(double front, double back, double height) {
    Slopes s;
    s.u = std::max(front, back) * kQuarter;
    s.uv = std::fabs(back - front) * kQuarter;
    s.uu = s.u * kQuarter;
    s.uuv = s.uv * kQuarter;
    s.uuu = s.uu * kQuarter;
    s.v = std::hypot(back - front, height);
    s.normal_u = kQuarter * height / s.v;
    return s;
}

/// How fast a rim rises and falls: z by the angle, its first three derivatives.
SagBounds rim_bounds(const LensSide& side, double radius) {
    if (is_round(side)) return {};
    const SagBounds f = sag_bounds(side);
    const double r = radius, first = f.first * r;
    return {0, first, f.second * r * r + first, f.third * r * r * r + 3 * f.second * r * r + first};
}

/// The least distance along the axis between rims, over all angles; not positive: none is known.
double least_height(const LensPrimitive& lens, double front, double back) {
    constexpr int kPlaces = 512;
    const double step = 2 * kPi / kPlaces;
    double least = lens.thickness + sag_over(lens.back, {back, 0}).z - sag_over(lens.front, {front, 0}).z;
    for (int i = 0; i < kPlaces; ++i) {
        const Vec2 out(std::cos(step * i), std::sin(step * i));
        least = std::min(
            least, lens.thickness + sag_over(lens.back, back * out).z - sag_over(lens.front, front * out).z);
    }
    return least - step / 2 * (rim_bounds(lens.front, front).first + rim_bounds(lens.back, back).first);
}

/// Between rims of which one is not round: the position is ((1 - v) front + v back)(cos, sin) and as much of
/// their z.
Slopes uneven_edge_slopes(const LensPrimitive& lens, double front, double back) {
    const SagBounds a = rim_bounds(lens.front, front), b = rim_bounds(lens.back, back);
    const double most = std::max(front, back), wider = std::fabs(back - front), k = kQuarter;
    const double height = lens.thickness + sag_bounds(lens.front).z + sag_bounds(lens.back).z;
    Slopes s;
    s.u = k * std::hypot(most, std::max(a.first, b.first));
    s.uu = k * k * std::hypot(most, std::max(a.second, b.second));
    s.uuu = k * k * k * std::hypot(most, std::max(a.third, b.third));
    s.v = std::hypot(wider, height);
    s.uv = k * std::hypot(wider, a.first + b.first);
    s.uuv = k * k * std::hypot(wider, a.second + b.second);
    // The normal is along du x dv, whose part away from the axis is at least radius k height.
    const double long_enough = std::min(front, back) * k * least_height(lens, front, back);
    const double some = long_enough > 0 ? 1 / long_enough : 1e300;
    s.normal_u = std::min(some * (s.uu * s.v + s.u * s.uv), 1e300);
    s.normal_v = std::min(some * s.uv * s.v, 1e300);
    return s;
}

/// Faces as make_lens_surface numbers them: those of each side, then the quarters of the edge, and of the
/// hole.
Slopes slopes_of(const LensPrimitive& lens, Id face) {
    const Id of_side = lens.hole > 0 ? 4 : 5;
    if (face < 2 * of_side) {
        const LensSide& side = face < of_side ? lens.front : lens.back;
        const Slopes flat = lens.hole > 0 ? ring_slopes(lens.hole, side.aperture)
                                          : disk_slopes(side.aperture, face % of_side == 4);
        return is_round(side) ? side_slopes(side, flat) : uneven_side_slopes(side, flat);
    }
    const auto height = [&](double front, double back) {
        return lens.thickness + sag_at(lens.back, back * back).z - sag_at(lens.front, front * front).z;
    };
    const bool is_hole = face >= 2 * of_side + 4;
    const double front = is_hole ? lens.hole : lens.front.aperture,
                 back = is_hole ? lens.hole : lens.back.aperture;
    if (!is_round(lens.front) || !is_round(lens.back)) return uneven_edge_slopes(lens, front, back);
    return edge_slopes(front, back, height(front, back));
}

class PrimitiveBounder final : public SurfaceBounder {
  public:
    PrimitiveBounder(const PrimitiveKind& kind, const Surface& surface) : kind_(kind), surface_(surface) {}

    SurfaceBounds bounds(Id face, const Vec2& low, const Vec2& high) const override {
        const Slopes s = std::visit([&](const auto& one) { return slopes_of(one, face); }, kind_);
        const Vec2 way = 0.5 * (high - low);
        const auto within = [&](double by_u, double by_v, double size) {
            return by_u * way.x + by_v * way.y + kRounding * size;
        };
        SurfaceBounds result;
        result.middle = surface_.eval(face, 0.5 * (low + high));
        result.position_radius = within(s.u, s.v, s.u + s.v + length(result.middle.position));
        result.du_radius = within(s.uu, s.uv, s.u);
        result.dv_radius = within(s.uv, s.vv, s.v);
        result.duu_radius = within(s.uuu, s.uuv, s.uu);
        result.duv_radius = within(s.uuv, s.uvv, s.uv);
        result.dvv_radius = within(s.uvv, s.vvv, s.vv);
        result.normal_radius = std::min(within(s.normal_u, s.normal_v, 1), 2.0);
        return result;
    }

  private:
    PrimitiveKind kind_;
    const Surface& surface_;
};

}  // namespace

std::unique_ptr<const SurfaceBounder> make_primitive_bounder(const PrimitiveKind& kind,
                                                             const Surface& surface) {
    return std::make_unique<PrimitiveBounder>(kind, surface);
}

}  // namespace trilens
