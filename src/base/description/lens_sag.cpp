// A biconic's z is N / (1 + sqrt(1 - D)), N = cx x^2 + cy y^2, D = (1 + kx) cx^2 x^2 + (1 + ky) cy^2 y^2. A
// toric side's point lies on a circle about the line that its profile is turned about: with the profile's
// z = p, of radius 1 / q = 1 / c - p, so that z = p + N / (1 + sqrt(1 - D)), N = q w^2, D = q^2 w^2, w across
// the profile.
#include "base/description/lens_sag.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

namespace trilens {
namespace {

/// A function of x and y with its derivatives, by the rules of sums, products and chains.
SideSag operator+(const SideSag& a, const SideSag& b) {
    return {a.z + b.z, a.slope + b.slope, a.xx + b.xx, a.xy + b.xy, a.yy + b.yy};
}

SideSag operator*(const SideSag& a, const SideSag& b) {
    return {a.z * b.z, a.z * b.slope + b.z * a.slope, a.z * b.xx + b.z * a.xx + 2 * a.slope.x * b.slope.x,
            a.z * b.xy + b.z * a.xy + a.slope.x * b.slope.y + a.slope.y * b.slope.x,
            a.z * b.yy + b.z * a.yy + 2 * a.slope.y * b.slope.y};
}

/// f(a) by f, f' and f'' there.
SideSag chain(const Sag& f, const SideSag& a) {
    return {f.z, f.by_s * a.slope, f.by_s * a.xx + f.by_ss * a.slope.x * a.slope.x,
            f.by_s * a.xy + f.by_ss * a.slope.x * a.slope.y, f.by_s * a.yy + f.by_ss * a.slope.y * a.slope.y};
}

/// a x^2 + b y^2.
SideSag squares(double a, double b, const Vec2& p) {
    return {a * p.x * p.x + b * p.y * p.y, {2 * a * p.x, 2 * b * p.y}, 2 * a, 0, 2 * b};
}

/// 1 / (1 + sqrt(1 - d)) and its derivatives.
Sag half_root(double d) {
    const double root = std::sqrt(1 - d), g = 1 / (1 + root);
    return {g, g * g / (2 * root), g * g * g / (2 * root * root) + g * g / (4 * root * root * root)};
}

SideSag biconic_over(const LensSide& side, const Vec2& p) {
    const double cx = side.across_curvature, cy = side.curvature;
    const SideSag d = squares((1 + side.across_conic) * cx * cx, (1 + side.conic) * cy * cy, p);
    return squares(cx, cy, p) * chain(half_root(d.z), d);
}

/// The profile along y.
SideSag toric_over(const LensSide& side, const Vec2& p) {
    const double c = side.across_curvature;
    const SideSag profile = chain(sag_at(side, p.y * p.y), squares(0, 1, p));
    const double room = 1 - c * profile.z;
    if (!(room > 0)) return {std::numeric_limits<double>::quiet_NaN()};
    const double q = c / room;
    const SideSag turned = chain({q, q * q, 2 * q * q * q}, profile);
    const SideSag n = turned * squares(1, 0, p), d = turned * n;
    return profile + n * chain(half_root(d.z), d);
}

}  // namespace

SideSag sag_over(const LensSide& side, const Vec2& p) {
    switch (side.form) {
        case SideForm::kRound:
            return chain(sag_at(side, dot(p, p)), squares(1, 1, p));
        case SideForm::kBiconic:
            return biconic_over(side, p);
        case SideForm::kToricY:
            return toric_over(side, p);
        case SideForm::kToricX:
            break;
    }
    const SideSag along_y = toric_over(side, {p.y, p.x});
    return {along_y.z, {along_y.slope.y, along_y.slope.x}, along_y.yy, along_y.xy, along_y.xx};
}

namespace {

double conic_z(const LensSide& side, double s) {
    return side.curvature * s / (1 + std::sqrt(1 - (1 + side.conic) * side.curvature * side.curvature * s));
}

/// Of the profile's share [low, high] of the aperture: 1 - c p at least, for it may be 0 or less.
double least_turning_room(const LensSide& side, double low, double high) {
    const double c = side.across_curvature, s = high * high;
    const double conic = std::max(c * conic_z(side, low * low), c * conic_z(side, s));
    return 1 - conic - std::fabs(c) * largest_derivatives(side.coefficients, s)[0];
}

/// Strips of the aperture across the profile, whose bounds make the whole's.
constexpr int kStrips = 64;

double toric_room(const LensSide& side) {
    const double r = side.aperture;
    double room = 1;
    for (int i = 0; i < kStrips; ++i) {
        const double low = r * i / kStrips, high = r * (i + 1) / kStrips;
        const double turning = least_turning_room(side, low, high);
        if (!(turning > 0)) return 0;
        const double q = side.across_curvature / turning;
        room = std::min(room, 1 - q * q * (r * r - low * low));
    }
    return room;
}

}  // namespace

double side_room(const LensSide& side) {
    const double profile = rim_room(side);
    if (is_round(side) || !(profile > 0)) return profile;
    const double r = side.aperture, c = side.across_curvature;
    if (side.form == SideForm::kBiconic)
        return std::min(profile, 1 - (1 + side.across_conic) * c * c * r * r);
    return std::min(profile, toric_room(side));
}

namespace {

// Bounds of sums, products and chains.

SagBounds sum_of(const SagBounds& a, const SagBounds& b) {
    return {a.z + b.z, a.first + b.first, a.second + b.second, a.third + b.third};
}

SagBounds product_of(const SagBounds& a, const SagBounds& b) {
    return {a.z * b.z, a.first * b.z + a.z * b.first, a.second * b.z + 2 * a.first * b.first + a.z * b.second,
            a.third * b.z + 3 * (a.second * b.first + a.first * b.second) + a.z * b.third};
}

SagBounds chain_of(const SagBounds& f, const SagBounds& a) {
    return {f.z, f.first * a.first, f.second * a.first * a.first + f.first * a.second,
            f.third * a.first * a.first * a.first + 3 * f.second * a.first * a.second + f.first * a.third};
}

/// Of c x^2, |c| at most `most`, within r.
SagBounds square_bounds(double most, double r) {
    return {most * r * r, 2 * most * r, 2 * most, 0};
}

/// Of 1 / (1 + sqrt(1 - d)), 1 - d at least `room`, at most 1 or not: its derivatives grow with d.
SagBounds half_root_bounds(double room) {
    const double r = std::sqrt(std::min(room, 1.0)), g = 1 / (1 + r), g2 = g * g, r3 = r * r * r;
    return {g, g2 / (2 * r), g2 * g / (2 * r * r) + g2 / (4 * r3),
            0.75 * g2 * g2 / r3 + 0.75 * g2 * g / (r3 * r) + 0.375 * g2 / (r3 * r * r)};
}

/// Of the profile, as a function of one coordinate or of the distance from the axis.
SagBounds profile_bounds(const LensSide& side) {
    const double r = side.aperture, s = r * r;
    const auto [f1, f2, f3] = largest_slopes(side);
    return {std::fabs(conic_z(side, s)) + largest_derivatives(side.coefficients, s)[0], 2 * r * f1,
            2 * f1 + 4 * s * f2, 12 * r * f2 + 8 * r * s * f3};
}

SagBounds biconic_bounds(const LensSide& side) {
    const double cx = side.across_curvature, cy = side.curvature, r = side.aperture;
    const double d =
        std::max(std::fabs(1 + side.across_conic) * cx * cx, std::fabs(1 + side.conic) * cy * cy);
    return product_of(square_bounds(std::max(std::fabs(cx), std::fabs(cy)), r),
                      chain_of(half_root_bounds(side_room(side)), square_bounds(d, r)));
}

SagBounds toric_bounds(const LensSide& side) {
    const SagBounds profile = profile_bounds(side);
    double turning = 1;
    for (int i = 0; i < kStrips; ++i)
        turning = std::min(turning, least_turning_room(side, side.aperture * i / kStrips,
                                                       side.aperture * (i + 1) / kStrips));
    const double q = std::fabs(side.across_curvature) / turning;
    const SagBounds turned = chain_of({q, q * q, 2 * q * q * q, 6 * q * q * q * q}, profile);
    const SagBounds n = product_of(turned, square_bounds(1, side.aperture)), d = product_of(turned, n);
    return sum_of(profile, product_of(n, chain_of(half_root_bounds(side_room(side)), d)));
}

}  // namespace

SagBounds sag_bounds(const LensSide& side) {
    if (side.form == SideForm::kBiconic) return biconic_bounds(side);
    if (!is_round(side)) return toric_bounds(side);
    return profile_bounds(side);
}

namespace {

/// The sides, and the edge between them, along one direction from the axis.
const char* fault_along(const LensSide& front, const LensSide& back, double thickness,
                        const std::pair<Vec2, double>& direction_and_hole) {
    const auto& [direction, hole] = direction_and_hole;
    const auto z = [&direction = direction](const LensSide& side, double r) {
        return sag_over(side, r * direction).z;
    };
    const double front_rim = z(front, front.aperture), back_rim = thickness + z(back, back.aperture);
    if (!std::isfinite(front_rim) || !std::isfinite(back_rim)) return "its side is not finite";
    if (!(front_rim < back_rim))
        return "its rims have no edge between them: the sides meet within the aperture";
    constexpr int kPlaces = 128;
    const double inner = std::min(front.aperture, back.aperture);
    const double outer = std::max(front.aperture, back.aperture);
    for (int i = 0; i < kPlaces; ++i) {
        const double r = hole + (outer - hole) * i / kPlaces,
                     along = (r - front.aperture) / (back.aperture - front.aperture);
        const double edge = front_rim + along * (back_rim - front_rim);
        const double before = r <= front.aperture ? z(front, r) : edge;
        const double behind = r <= back.aperture ? thickness + z(back, r) : edge;
        if (!(before < behind))
            return r <= inner ? "its sides cross within the aperture" : "its edge cuts through a side";
    }
    return nullptr;
}

}  // namespace

const char* lens_fault(const LensSide& front, const LensSide& back, double thickness, double hole) {
    if (!(hole >= 0 && hole < std::min(front.aperture, back.aperture)))
        return "its hole is not smaller than its apertures";
    for (const LensSide* side : {&front, &back}) {
        if (!is_round(*side) && departs_along_normal(*side))
            return "its side departs along normals, and is not round";
        if (side->form == SideForm::kBiconic && has_coefficients(*side))
            return "its side is a biconic with coefficients";
        if (!(side_room(*side) >= kLeastRimRoom)) return "its aperture reaches to where the side turns back";
    }
    // All forms are even in x and y.
    constexpr int kSteps = 32;
    const int steps = is_round(front) && is_round(back) ? 0 : kSteps;
    for (int i = 0; i <= steps; ++i) {
        const double turn = std::numbers::pi / 2 * i / kSteps;
        if (const char* fault = fault_along(front, back, thickness, {{std::cos(turn), std::sin(turn)}, hole}))
            return fault;
    }
    return nullptr;
}

}  // namespace trilens
