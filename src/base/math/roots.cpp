// Brackets every real root between the critical points, then closes in by Newton steps guarded by bisection.
#include "base/math/roots.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>

namespace trilens {
namespace {

using Coefficients = std::array<double, 4>;

constexpr double kEpsilon = std::numeric_limits<double>::epsilon();

// A value smaller than this share of the sum of its terms' magnitudes is rounding: Horner's scheme alone is
// off by up to 3 epsilon of that sum for a cubic, and coefficients rounded to double by another half.
constexpr double kNoise = 4 * kEpsilon;

double value(const Coefficients& c, double t) {
    return ((c[3] * t + c[2]) * t + c[1]) * t + c[0];
}
double slope(const Coefficients& c, double t) {
    return (3 * c[3] * t + 2 * c[2]) * t + c[1];
}

double value_noise(const Coefficients& c, double t) {
    const double m = std::fabs(t);
    return kNoise * (((std::fabs(c[3]) * m + std::fabs(c[2])) * m + std::fabs(c[1])) * m + std::fabs(c[0]));
}

double slope_noise(const Coefficients& c, double t) {
    const double m = std::fabs(t);
    return kNoise * ((3 * std::fabs(c[3]) * m + 2 * std::fabs(c[2])) * m + std::fabs(c[1]));
}

// -1, 0 or 1; a value that is all rounding has no sign.
int sign_of(const Coefficients& c, double t) {
    const double v = value(c, t);
    return std::fabs(v) <= value_noise(c, t) ? 0 : v > 0 ? 1 : -1;
}

// Doubles in their order as integers: the middle of two such numbers halves the doubles between them, so that
// a bracket of any width closes in 64 steps.
std::int64_t rank_of(double t) {
    std::int64_t bits;
    std::memcpy(&bits, &t, sizeof bits);
    return bits >= 0 ? bits : std::numeric_limits<std::int64_t>::min() - bits;
}

double of_rank(std::int64_t rank) {
    const std::int64_t bits = rank >= 0 ? rank : std::numeric_limits<std::int64_t>::min() - rank;
    double t;
    std::memcpy(&t, &bits, sizeof t);
    return t;
}

double middle(double low, double high) {
    // Half the sum of two ranks of opposite sign cannot overflow; of one sign their distance cannot.
    const std::int64_t a = rank_of(low), b = rank_of(high);
    return of_rank((a < 0) != (b < 0) ? (a + b) / 2 : a + (b - a) / 2);
}

// The root in (low, high), where the polynomial is monotone and has signs -rising and rising at the ends.
double root_between(const Coefficients& c, double low, double high, int rising) {
    // Where the bracket has no sign inside and ends of like magnitude, its plain middle is the better first
    // guess.
    double t = low < 0 && high > 0 ? 0.0 : 0.5 * (low + high);
    double last = std::numeric_limits<double>::infinity();
    for (int step = 0; step < 200; ++step) {
        const double v = value(c, t);
        if (v == 0) return t;
        ((v > 0) == (rising > 0) ? high : low) = t;

        // A Newton step must stay inside, and the one before it must have made the value a tenth: far from
        // the root, where a step only takes a share of the way, bisection is faster.
        double next = t - v / slope(c, t);
        const bool trusted = next > low && next < high && std::fabs(v) < 0.1 * last;
        if (!trusted && std::fabs(v) <= value_noise(c, t)) return t;
        if (!trusted) next = middle(low, high);
        if (next <= low || next >= high) return t;
        if (std::fabs(next - t) <= 0.5 * kEpsilon * std::fabs(t)) return next;
        last = trusted ? std::fabs(v) : std::numeric_limits<double>::infinity();
        t = next;
    }
    return t;
}

// Keeps the roots in order; one that is too far away is left out.
void add(RealRoots& roots, double t) {
    if (!(std::fabs(t) <= kFarthestRoot)) return;
    std::size_t at = static_cast<std::size_t>(roots.count++);
    for (; at > 0 && roots.root[at - 1] > t; --at) roots.root[at] = roots.root[at - 1];
    roots.root[at] = t;
}

// a t^2 + b t + c with a, c not zero. Ends up with both roots, or the vertex twice, or none.
RealRoots quadratic_roots(double a, double b, double c) {
    RealRoots roots;
    // Scale t by a power of two so that a and c have like magnitude, then all three to order one.
    const int shift = (std::ilogb(c) - std::ilogb(a)) / 2;
    const int largest =
        std::max({std::ilogb(a) + shift, b != 0 ? std::ilogb(b) : -2000, std::ilogb(c) - shift});
    a = std::ldexp(a, shift - largest), b = std::ldexp(b, -largest), c = std::ldexp(c, -shift - largest);
    const auto add_scaled = [&](double t) { add(roots, std::ldexp(t, shift)); };
    if (a == 0 || c == 0) {
        // One root is beyond every double from the other: each follows from two coefficients.
        const double large = a != 0 ? -b / a : std::numeric_limits<double>::infinity();
        add_scaled(large), add_scaled(-c / b);
        return roots;
    }

    // The discriminant of the halved form, exact up to its last rounding.
    const double h = 0.5 * b;
    const double ac = a * c;
    const double discriminant = std::fma(h, h, -ac) - std::fma(a, c, -ac);
    if (std::fabs(discriminant) <= kNoise * std::max(h * h, std::fabs(ac))) {
        add_scaled(-h / a), add_scaled(-h / a);
        return roots;
    }
    if (discriminant < 0) return roots;
    const double q = -(h + std::copysign(std::sqrt(discriminant), h));
    add_scaled(q / a), add_scaled(c / q);
    return roots;
}

// Any coefficients but all zero; the roots at zero are taken out first, exactly.
RealRoots roots_of_degree(Coefficients c, int degree);

// c[0] and c[3] are not zero; the largest magnitude is about one.
RealRoots cubic_roots(const Coefficients& c) {
    RealRoots roots;
    const double inflection = -c[2] / c[3] / 3;
    if (std::fabs(inflection) <= kFarthestRoot &&
        std::fabs(value(c, inflection)) <= value_noise(c, inflection) &&
        std::fabs(slope(c, inflection)) <= slope_noise(c, inflection)) {
        return {3, {inflection, inflection, inflection}, false};
    }

    // All roots lie within Fujiwara's bound; twice that leaves no doubt about the sign there.
    const double a2 = std::fabs(c[2] / c[3]), a1 = std::fabs(c[1] / c[3]), a0 = std::fabs(c[0] / c[3]);
    const double bound = std::min(4 * std::max({a2, std::sqrt(a1), std::cbrt(a0)}), kFarthestRoot);

    // Between critical points the cubic is monotone: one root where the signs differ, a double one where it
    // has none.
    const RealRoots critical = roots_of_degree({c[1], 2 * c[2], 3 * c[3], 0}, 2);
    if (critical.count == 2 && sign_of(c, critical.root[0]) == 0 && sign_of(c, critical.root[1]) == 0) {
        const double t = 0.5 * (critical.root[0] + critical.root[1]);
        return {3, {t, t, t}, false};
    }
    double from = -bound;
    int sign_from = sign_of(c, from);
    for (int i = 0; i <= critical.count; ++i) {
        const double to = i < critical.count ? critical.root[static_cast<std::size_t>(i)] : bound;
        const int sign_to = sign_of(c, to);
        if (sign_from * sign_to < 0) add(roots, root_between(c, from, to, sign_to));
        if (sign_to == 0 && i < critical.count) add(roots, to), add(roots, to);
        from = to, sign_from = sign_to;
    }
    return roots;
}

RealRoots roots_of_degree(Coefficients c, int degree) {
    RealRoots roots;
    while (degree > 0 && c[static_cast<std::size_t>(degree)] == 0) --degree;
    if (degree == 0) return roots;
    if (c[0] == 0) {
        roots = roots_of_degree({c[1], c[2], c[3], 0}, degree - 1);
        add(roots, 0.0);
        return roots;
    }
    if (degree == 1) {
        add(roots, -c[0] / c[1]);
        return roots;
    }
    return degree == 2 ? quadratic_roots(c[2], c[1], c[0]) : cubic_roots(c);
}

}  // namespace

RealRoots real_roots(const std::array<double, 4>& c) {
    double largest = 0;
    for (const double x : c) {
        if (!std::isfinite(x)) return {};
        largest = std::max(largest, std::fabs(x));
    }
    if (largest == 0) {
        RealRoots roots;
        roots.all = true;
        return roots;
    }
    // A power of two is exact and brings the largest coefficient to order one.
    const int shift = -std::ilogb(largest);
    return roots_of_degree(
        {std::ldexp(c[0], shift), std::ldexp(c[1], shift), std::ldexp(c[2], shift), std::ldexp(c[3], shift)},
        3);
}

}  // namespace trilens
