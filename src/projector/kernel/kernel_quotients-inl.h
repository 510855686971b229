// A triangle over a tile as quotients of polynomials, and a bound of what they and place() differ by.
// Included once per instruction set.
#if defined(TRILENS_KERNEL_QUOTIENTS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef TRILENS_KERNEL_QUOTIENTS_INL_H
#undef TRILENS_KERNEL_QUOTIENTS_INL_H
#else
#define TRILENS_KERNEL_QUOTIENTS_INL_H
#endif

#include <algorithm>
#include <cmath>

#include "projector/kernel/kernel_placed-inl.h"

HWY_BEFORE_NAMESPACE();
namespace trilens {
namespace HWY_NAMESPACE {

// At a sample, let W, O and D be its ray's weight, origin and direction, s = W c - O, A = n . D, B = n . s,
// Q = e . (D x s) with e = -e2 or e1, and P = W A: place() says t = B / A = B W / P, and Q / P for the
// weights b of the second and the third corner. Both ways sum products of the same numbers. A sum of products
// in which no term meets more than m roundings is off by at most m u (u = 2^-53, rounded up a little) times
// the sum of its terms' absolute values, here called sizes: w, d and s of a component of W, D and s, |n| d of
// A, |n| s of B, 2 |e| d s of Q, w |n| d of P, with |n| and |e| sums of absolute components, and with the
// offset from the facet's screen as what it is summed of. Roundings:
//
// In place(): the offset 1; W, O, D 4; s 6; A 7, B 9; D x s 12, Q 15; P 12; B W 13.
//
// Here, in coefficients: the first line's offset 4; parts of W, O, D 7; s 9; A 10, B 12; Q, summed as
// (e x D) . s, 22: 9 and 9 of its factors, 3 of their products' sums, 1 of a mixed term. Horner's rule adds 3
// to a linear and 5 to a quadratic function: W 10, A 13, B 15, Q 27; P 24, B W 26.
//
// Let p be the least |P| over the tile. As Q_1 / P_1 - Q_2 / P_2 = (Q_1 - Q_2) / P_1 + (Q_2 / P_2) (P_2 -
// P_1) / P_1 and b is at most 1.01, b's two values differ by at most (42 size(Q) + 36.4 size(P)) u / p, and
// those of t, which is at most size(B) w / p, by (39 + 36 size(P) / p) u size(B) w / p. The weight of the
// first corner is 1 - b_1 - b_2 there, off by 4 u, by 6.1 u for what b_1 and b_2 round relative to
// themselves, and for each of them by 15 size(Q) and 12.2 size(P); here it is (P - Q_1 - Q_2) / P, off by
// 29 size(Q) for each, by 26 size(P), and by 24.3 size(P) for the denominator.
//
// All are less than kQuotientDoubt (size(P) + size(Q_1) + size(Q_2)) / p, and for t than
// kQuotientDoubt (1 + size(P) / p) size(B) w / p. What is relative to the values is below kQuotientRound: the
// roundings of 1 / P and of the products with it, 3 u each way, and those of the ends.
inline constexpr double kQuotientDoubt = 96 * 0x1p-53;
// The reciprocal is right to 2^-21 before one step of Newton's method squares that.
inline constexpr double kQuotientRound = 0x1p-40;
// No quotient is made of what is off by more than this: then b is at most 1.01 wherever its float is at
// most 1.
inline constexpr double kMostQuotientDoubt = 0x1p-12;

inline constexpr std::size_t kFirstPart[kMonomials] = {0, 0, 0, 1, 1, 2, 0, 0},
                             kSecondPart[kMonomials] = {0, 1, 2, 1, 2, 2, 0, 0};
// A square is half of what a mixed product is.
alignas(64) inline constexpr double kShare[kMonomials] = {0.5, 1, 1, 0.5, 1, 0.5, 0, 0};

/// No more than the least absolute value, over the tile, of a linear function whose terms' sum is `size`.
HWY_INLINE double least_linear(const double* part, const RayParts& parts, double size) {
    const double middle = part[0] + parts.middle[0] * part[1] + parts.middle[1] * part[2];
    return std::fabs(middle) - parts.middle[0] * std::fabs(part[1]) - parts.middle[1] * std::fabs(part[2]) -
           0x1p-48 * size;
}

HWY_NOINLINE void put_ray_parts(const TilePlacing& tile, RayParts& parts) {
    const AffineRays& rays = tile.facet.rays;
    const TileSpots& spots = tile.spots;
    const double step = 1.0 / spots.side;
    double from[2], size[3] = {1, 0, 0};
    for (std::size_t a = 0; a < 2; ++a) {
        parts.middle[a] = static_cast<double>(spots.middle[a]);
        const double position = spots.start[a] + (spots.first[a] + 0.5) * step,
                     last = 2 * parts.middle[a] * step;
        from[a] = position - spots.screen[a];
        size[a + 1] = std::fabs(from[a]) + last;
        // What positions are summed of, where they are not whole numbers and halves.
        if (spots.side > 1) size[a + 1] += 1 + std::abs(spots.start[a]) + std::fabs(position) + last;
    }
    const auto moved = [&](double c0, double c1, double c2, std::size_t part) {
        return part == 0 ? c0 + from[0] * c1 + from[1] * c2 : step * (part == 1 ? c1 : c2);
    };
    const auto terms = [&](double c0, double c1, double c2) {
        return std::fabs(c0) + size[1] * std::fabs(c1) + size[2] * std::fabs(c2);
    };
    const auto spread = [](const double(&part)[3], double(&first)[kMonomials], double(&second)[kMonomials]) {
        for (std::size_t k = 0; k < kMonomials; ++k) {
            first[k] = part[kFirstPart[k]];
            second[k] = part[kSecondPart[k]];
        }
    };
    parts.origin_size = parts.direction_size = 0;
    for (int a = 0; a < 3; ++a) {
        const std::array<Vec3, 3>&o = rays.origin, &d = rays.direction;
        double origin[3], direction[3];
        for (std::size_t p = 0; p < 3; ++p) {
            origin[p] = moved(o[0][a], o[1][a], o[2][a], p);
            direction[p] = moved(d[0][a], d[1][a], d[2][a], p);
        }
        spread(origin, parts.origin[0][a], parts.origin[1][a]);
        spread(direction, parts.direction[0][a], parts.direction[1][a]);
        parts.origin_size = std::max(parts.origin_size, terms(o[0][a], o[1][a], o[2][a]));
        parts.direction_size = std::max(parts.direction_size, terms(d[0][a], d[1][a], d[2][a]));
    }
    double weight[3];
    for (std::size_t p = 0; p < 3; ++p) weight[p] = moved(rays.weight[0], rays.weight[1], rays.weight[2], p);
    spread(weight, parts.weight[0], parts.weight[1]);
    parts.weight_size = terms(rays.weight[0], rays.weight[1], rays.weight[2]);
    parts.least_weight = least_linear(weight, parts, parts.weight_size);
}

/// e . (D x s) by monomials, of parts from `at` on.
HWY_INLINE Double product_lanes(const Vector3& e, const Vector3 (&direction)[2], const Vector3 (&from)[2],
                                const Double& share) {
    return hn::Mul(share,
                   hn::Add(inner(outer(e, direction[0]), from[1]), inner(outer(e, direction[1]), from[0])));
}

/// The triangle's coefficients.
HWY_INLINE void put_coefficients(const CachedFrame& cached, const RayParts& parts, Quotient& to) {
    const FrameLanes frame = broadcast(cached.frame);
    for (std::size_t at = 0; at < kMonomials; at += kDoubles) {
        Vector3 direction[2], from[2];
        Double weight[2];
        for (int side = 0; side < 2; ++side) {
            const auto part = [&](const double(&of)[3][kMonomials]) HWY_ATTR {
                return Vector3{hn::Load(kDouble, of[0] + at), hn::Load(kDouble, of[1] + at),
                               hn::Load(kDouble, of[2] + at)};
            };
            direction[side] = part(parts.direction[side]);
            weight[side] = hn::Load(kDouble, parts.weight[side] + at);
            from[side] = minus(times(weight[side], frame.corner), part(parts.origin[side]));
        }
        const Double share = hn::Load(kDouble, kShare + at);
        const Double along[2] = {inner(frame.normal, direction[0]), inner(frame.normal, direction[1])};
        const Double of[2] = {product_lanes(frame.turned, direction, from, share),
                              product_lanes(frame.e1, direction, from, share)};
        const auto corner = [&](std::size_t sorted) HWY_ATTR {
            if (sorted > 0) return of[sorted - 1];
            const Double all =
                hn::Mul(share, hn::Add(hn::Mul(weight[0], along[1]), hn::Mul(weight[1], along[0])));
            return hn::Sub(hn::Sub(all, of[0]), of[1]);
        };
        hn::Store(corner(cached.second), kDouble, to.second + at);
        hn::Store(corner(cached.third), kDouble, to.third + at);
        hn::Store(along[1], kDouble, to.along + at);
        hn::Store(inner(frame.normal, from[1]), kDouble, to.above + at);
    }
}

HWY_INLINE double sum_of_parts(const Vec3& v) {
    return std::fabs(v.x) + std::fabs(v.y) + std::fabs(v.z);
}

/// `largest`: coordinate of a direction, or more.
HWY_NOINLINE void make_quotient(const CachedFrame& cached, const RayParts& parts, double largest,
                                Quotient& to) {
    constexpr double kLeast = 0x1p-100, kMost = 0x1p100;  // that are floats too
    const TriangleFrame& frame = cached.frame;
    to.triangle = cached.triangle;
    put_coefficients(cached, parts, to);
    const double normal = sum_of_parts(frame.normal);
    const double from = parts.weight_size * trilens::largest_part(frame.corner) + parts.origin_size;
    const double along_size = normal * parts.direction_size, size = along_size * parts.weight_size;
    const double weight_sizes =
        size + 2 * (sum_of_parts(frame.e1) + sum_of_parts(frame.turned)) * parts.direction_size * from;
    const double least_along = least_linear(to.along, parts, along_size),
                 least = least_along * parts.least_weight;
    to.weight_doubt = kQuotientDoubt * weight_sizes / least;
    to.time_doubt = kQuotientDoubt * (normal * from * parts.weight_size) * (1 + size / least) / least;
    to.holds = parts.least_weight > 0 && least_along >= 2 * kLeastDeterminant * (largest * frame.size) &&
               least > kLeast && size < kMost && to.weight_doubt <= kMostQuotientDoubt &&
               std::isfinite(to.time_doubt);
}

/// Of the tile that the cache is of.
HWY_INLINE const Quotient& cached_quotient(const TilePlacing& tile, Id triangle, FrameCache& frames,
                                           QuotientCache& cache) {
    const std::size_t at = triangle % kCachedFrames;
    if (cache.triangle[at] != triangle) {
        make_quotient(cached_frame(tile.scene, tile.facet.centre, triangle, frames), cache.parts,
                      tile.spots.largest, cache.quotient[at]);
        cache.triangle[at] = triangle;
    }
    return cache.quotient[at];
}

}  // namespace HWY_NAMESPACE
}  // namespace trilens
HWY_AFTER_NAMESPACE();

#endif
