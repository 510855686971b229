// Sides of lenses: conicoids and even aspheres about an axis, as optical prescriptions write them.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace trilens {

/// How many coefficients an even asphere has: of r^2, r^4, ... r^16.
inline constexpr std::size_t kAsphereTerms = 8;

/// z over r from the axis: c r^2 / (1 + sqrt(1 - (1 + k) c^2 r^2)) + a1 r^2 + a2 r^4 + ... + a8 r^16, up to
/// the aperture.
struct LensSide {
    double curvature = 0;  // c = 1 / radius; positive: the centre lies farther along the axis
    double conic = 0;      // k: -1 a paraboloid, 0 a sphere
    std::array<double, kAsphereTerms> coefficients{};
    double aperture = 1;  // radius of the rim
};

/// Whether no coefficient adds to the conicoid.
inline bool is_conicoid(const LensSide& side) {
    return std::all_of(side.coefficients.begin(), side.coefficients.end(), [](double a) { return a == 0; });
}

/// The shape `factor` times as large, up to the same aperture.
inline LensSide with_scaled_shape(LensSide side, double factor) {
    side.curvature /= factor;
    double unit = factor;
    for (double& a : side.coefficients) {
        a /= unit;
        unit *= factor * factor;
    }
    return side;
}

/// The least 1 - (1 + k) c^2 r^2 up to the aperture: 0 where the conicoid turns back.
inline double rim_room(const LensSide& side) {
    const double r = side.aperture, c = side.curvature;
    return std::min(1.0, 1 - (1 + side.conic) * c * c * r * r);
}

/// Rims must stay so far from where the conicoid turns back: the edge of a hemisphere has no slope.
inline constexpr double kLeastRimRoom = 1e-6;

/// z with its derivatives by s = r^2.
struct Sag {
    double z = 0, by_s = 0, by_ss = 0;
};

/// Of a side whose rim_room is positive; s up to the aperture's square.
inline Sag sag_at(const LensSide& side, double s) {
    const double c = side.curvature, k = (1 + side.conic) * c * c;
    const double w = 1 - k * s, root = std::sqrt(w);
    Sag sag{c * s / (1 + root), c / (2 * root), c * k / (4 * w * root)};
    for (std::size_t i = kAsphereTerms; i-- > 0;) {
        if (side.coefficients[i] == 0) continue;
        const auto power = static_cast<double>(i);  // of s it is power + 1
        const double a = side.coefficients[i];
        sag.z += a * std::pow(s, power + 1);
        sag.by_s += a * (power + 1) * std::pow(s, power);
        if (i > 0) sag.by_ss += a * (power + 1) * power * std::pow(s, power - 1);
    }
    return sag;
}

/// z at the aperture; as sag_at.
inline double sag_of_rim(const LensSide& side) {
    return sag_at(side, side.aperture * side.aperture).z;
}

/// How large the first three derivatives of z by s are at most, up to the aperture.
inline std::array<double, 3> largest_slopes(const LensSide& side) {
    const double c = std::fabs(side.curvature), k = std::fabs(1 + side.conic) * c * c;
    const double w = rim_room(side), root = std::sqrt(w), s = side.aperture * side.aperture;
    std::array<double, 3> most{c / (2 * root), c * k / (4 * w * root), 3 * c * k * k / (8 * w * w * root)};
    for (std::size_t i = 0; i < kAsphereTerms; ++i) {
        const auto n = static_cast<double>(i + 1);
        const double a = std::fabs(side.coefficients[i]);
        most[0] += a * n * std::pow(s, n - 1);
        if (i > 0) most[1] += a * n * (n - 1) * std::pow(s, n - 2);
        if (i > 1) most[2] += a * n * (n - 1) * (n - 2) * std::pow(s, n - 3);
    }
    return most;
}

/// What a lens of two sides at such a distance cannot be; null: it can be made. Where its sides come near
/// each other between 128 places it is not seen.
inline const char* lens_fault(const LensSide& front, const LensSide& back, double thickness) {
    for (const LensSide* side : {&front, &back}) {
        if (!(rim_room(*side) >= kLeastRimRoom)) return "its aperture reaches to where the side turns back";
        if (!std::isfinite(sag_of_rim(*side))) return "its side is not finite";
    }
    const double front_rim = sag_of_rim(front), back_rim = thickness + sag_of_rim(back);
    if (!(front_rim < back_rim))
        return "its rims have no edge between them: the sides meet within the aperture";
    constexpr int kPlaces = 128;
    const double inner = std::min(front.aperture, back.aperture);
    const double outer = std::max(front.aperture, back.aperture);
    for (int i = 0; i < kPlaces; ++i) {
        const double r = outer * i / kPlaces, along = (r - front.aperture) / (back.aperture - front.aperture);
        const double edge = front_rim + along * (back_rim - front_rim);
        const double before = r <= front.aperture ? sag_at(front, r * r).z : edge;
        const double behind = r <= back.aperture ? thickness + sag_at(back, r * r).z : edge;
        if (!(before < behind))
            return r <= inner ? "its sides cross within the aperture" : "its edge cuts through a side";
    }
    return nullptr;
}

}  // namespace trilens
