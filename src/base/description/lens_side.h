// Sides of lenses: conicoids and even aspheres about an axis, biconics and toric sides across it, as optical
// prescriptions write them.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "base/util/names.h"

namespace trilens {

/// How many coefficients an even asphere has: of r^2, r^4, ... r^16.
inline constexpr std::size_t kAsphereTerms = 8;

/// How a side comes of its profile, z over the distance from the axis. kRound: turned about the axis.
/// kBiconic: a conic section along y, and another one along x. kToricY, kToricX: the profile lies along that
/// axis of the frame, and is turned about a line parallel to it, across the side's own axis.
enum class SideForm : std::uint8_t { kRound, kBiconic, kToricY, kToricX };

/// The profile: z over r from the axis: c r^2 / (1 + sqrt(1 - (1 + k) c^2 r^2)) + a1 r^2 + a2 r^4 + ... + a8
/// r^16
/// + (b1 r^2 + b2 r^4 + ... + b8 r^16) / sqrt(1 - c^2 r^2), up to the aperture.
struct LensSide {
    double curvature = 0;  // c = 1 / radius; positive: the centre lies farther along the axis
    double conic = 0;      // k: -1 a paraboloid, 0 a sphere
    std::array<double, kAsphereTerms> coefficients{};
    double aperture = 1;  // radius of the rim
    /// b, departures along the normal of the sphere of that curvature, as Forbes' Qbfs has them.
    std::array<double, kAsphereTerms> normal_departures{};
    /// Of forms that are not round: without departures along normals, a biconic without coefficients too.
    SideForm form = SideForm::kRound;
    double across_curvature = 0;  // of a biconic along x; of a toric side 1 / the radius that it is turned at
    double across_conic = 0;      // of a biconic along x
    /// Up to which radius its Q-type terms say something, for warnings; 0: it has none.
    double terms_radius = 0;
};

inline bool is_round(const LensSide& side) {
    return side.form == SideForm::kRound;
}

inline bool departs_along_normal(const LensSide& side) {
    return std::any_of(side.normal_departures.begin(), side.normal_departures.end(),
                       [](double b) { return b != 0; });
}

inline bool has_coefficients(const LensSide& side) {
    return std::any_of(side.coefficients.begin(), side.coefficients.end(), [](double a) { return a != 0; });
}

/// Whether nothing adds to a conicoid of revolution.
inline bool is_conicoid(const LensSide& side) {
    return is_round(side) && !departs_along_normal(side) && !has_coefficients(side);
}

/// Planes through the axis: that of x, and that of y, in which fields lie.
enum class LensSection : std::uint8_t { kY, kX };

template <>
struct EnumNames<LensSection> {
    static constexpr std::array kTable{NamedValue<LensSection>{LensSection::kY, "y"},
                                       NamedValue<LensSection>{LensSection::kX, "x"}};
};

/// The round side whose profile is what the plane cuts out of this one.
inline LensSide section_of(const LensSide& side, LensSection section) {
    LensSide cut = side;
    cut.form = SideForm::kRound;
    cut.across_curvature = cut.across_conic = 0;
    const LensSection profile = side.form == SideForm::kToricX ? LensSection::kX : LensSection::kY;
    if (is_round(side) || section == profile) return cut;
    cut.curvature = side.across_curvature;
    cut.conic = side.across_conic;
    cut.coefficients = {};
    return cut;
}

/// Whether it goes on beyond what its Q-type terms were made for, where polynomials run away.
inline bool outreaches_terms(const LensSide& side) {
    return side.terms_radius > 0 && side.aperture > side.terms_radius * (1 + 1e-9);
}

inline constexpr const char* kOutreachesTerms =
    "its aperture is larger than the normalization radius of its Q-type terms, which say nothing there";

/// The shape `factor` times as large, up to the same aperture.
inline LensSide with_scaled_shape(LensSide side, double factor) {
    side.curvature /= factor;
    side.across_curvature /= factor;
    side.terms_radius *= factor;
    double unit = factor;
    for (std::size_t i = 0; i < kAsphereTerms; ++i) {
        side.coefficients[i] /= unit;
        side.normal_departures[i] /= unit;
        unit *= factor * factor;
    }
    return side;
}

/// Of the profile, the least 1 - (1 + k) c^2 r^2 up to the aperture: 0 where the conicoid turns back; of the
/// sphere, too, where the side departs along its normals.
inline double rim_room(const LensSide& side) {
    const double r = side.aperture, c = side.curvature;
    const double of_conicoid = std::min(1.0, 1 - (1 + side.conic) * c * c * r * r);
    return departs_along_normal(side) ? std::min(of_conicoid, 1 - c * c * r * r) : of_conicoid;
}

/// Rims must stay so far from where the conicoid turns back: the edge of a hemisphere has no slope.
inline constexpr double kLeastRimRoom = 1e-6;

/// z with its derivatives by s = r^2.
struct Sag {
    double z = 0, by_s = 0, by_ss = 0;
};

/// a1 s + a2 s^2 + ... + a8 s^8.
inline Sag polynomial_at(const std::array<double, kAsphereTerms>& terms, double s) {
    Sag sum;
    for (std::size_t i = kAsphereTerms; i-- > 0;) {
        if (terms[i] == 0) continue;
        const auto power = static_cast<double>(i);  // of s it is power + 1
        sum.z += terms[i] * std::pow(s, power + 1);
        sum.by_s += terms[i] * (power + 1) * std::pow(s, power);
        if (i > 0) sum.by_ss += terms[i] * (power + 1) * power * std::pow(s, power - 1);
    }
    return sum;
}

/// Of the profile, where rim_room is positive; s up to the aperture's square. sag_over() has all sides.
inline Sag sag_at(const LensSide& side, double s) {
    const double c = side.curvature, k = (1 + side.conic) * c * c;
    const double w = 1 - k * s, root = std::sqrt(w);
    Sag sag{c * s / (1 + root), c / (2 * root), c * k / (4 * w * root)};
    const Sag added = polynomial_at(side.coefficients, s);
    sag = {sag.z + added.z, sag.by_s + added.by_s, sag.by_ss + added.by_ss};
    if (!departs_along_normal(side)) return sag;
    // The product with g = (1 - c^2 s)^(-1/2), whose derivatives are c^2 g^3 / 2 and 3 c^4 g^5 / 4.
    const Sag along = polynomial_at(side.normal_departures, s);
    const double g = 1 / std::sqrt(1 - c * c * s), g_s = c * c * g * g * g / 2,
                 g_ss = 1.5 * c * c * g * g * g_s;
    sag.z += along.z * g;
    sag.by_s += along.by_s * g + along.z * g_s;
    sag.by_ss += along.by_ss * g + 2 * along.by_s * g_s + along.z * g_ss;
    return sag;
}

/// How large a polynomial of s without a constant and its first three derivatives are at most, up to s.
inline std::array<double, 4> largest_derivatives(const std::array<double, kAsphereTerms>& terms, double s) {
    std::array<double, 4> most{};
    for (std::size_t i = 0; i < kAsphereTerms; ++i) {
        const auto n = static_cast<double>(i + 1);
        double factor = std::fabs(terms[i]);
        for (std::size_t k = 0; k < most.size() && k <= i + 1; ++k) {
            most[k] += factor * std::pow(s, n - static_cast<double>(k));
            factor *= n - static_cast<double>(k);
        }
    }
    return most;
}

/// How large the first three derivatives of the profile's z by s are at most, up to the aperture.
inline std::array<double, 3> largest_slopes(const LensSide& side) {
    const double c = std::fabs(side.curvature), k = std::fabs(1 + side.conic) * c * c;
    const double w = rim_room(side), root = std::sqrt(w), s = side.aperture * side.aperture;
    std::array<double, 3> most{c / (2 * root), c * k / (4 * w * root), 3 * c * k * k / (8 * w * w * root)};
    const std::array<double, 4> added = largest_derivatives(side.coefficients, s);
    for (std::size_t i = 0; i < 3; ++i) most[i] += added[i + 1];
    if (!departs_along_normal(side)) return most;
    // As in sag_at, by the product rule; g and its derivatives grow with s.
    const std::array<double, 4> p = largest_derivatives(side.normal_departures, s);
    const double v = 1 - c * c * s, g = 1 / std::sqrt(v), g1 = c * c * g / (2 * v), g2 = 1.5 * c * c * g1 / v,
                 g3 = 2.5 * c * c * g2 / v;
    most[0] += p[1] * g + p[0] * g1;
    most[1] += p[2] * g + 2 * p[1] * g1 + p[0] * g2;
    most[2] += p[3] * g + 3 * p[2] * g1 + 3 * p[1] * g2 + p[0] * g3;
    return most;
}

}  // namespace trilens
