// The inversion of a patch one point at a time, in plain code: a second answer beside patch_batch's.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>

#include "measure/field/patch.h"

namespace trilens_test {

using namespace trilens;

struct Tangents {
    Vec3 value, du, dv;
};

/// Nodes relative to the point that is looked for, so that its own size costs no digits.
using Nodes = std::array<Vec3, 16>;

inline Tangents bilinear(const Nodes& n, const Vec2& uv) {
    const Vec3 &p00 = n[5], &p10 = n[6], &p01 = n[9], &p11 = n[10];
    const Vec3 twist = p11 - p10 - p01 + p00, du = p10 - p00, dv = p01 - p00;
    return {p00 + uv.x * du + uv.y * dv + uv.x * uv.y * twist, du + uv.y * twist, dv + uv.x * twist};
}

/// The cubic through values at -1, 0, 1, 2 (Lagrange): weights and their derivatives.
struct Cubic {
    std::array<double, 4> weight, slope;
};

inline Cubic cubic_at(double s) {
    const double a = s + 1, b = s, c = s - 1, d = s - 2;
    return {{-b * c * d / 6, a * c * d / 2, -a * b * d / 2, a * b * c / 6},
            {-(c * d + b * d + b * c) / 6, (c * d + a * d + a * c) / 2, -(b * d + a * d + a * b) / 2,
             (b * c + a * c + a * b) / 6}};
}

inline Tangents bicubic(const Nodes& n, const Vec2& uv) {
    const Cubic u = cubic_at(uv.x), v = cubic_at(uv.y);
    Tangents result{Vec3(0), Vec3(0), Vec3(0)};
    for (std::size_t b = 0; b < 4; ++b) {
        Vec3 value(0), slope(0);
        for (std::size_t a = 0; a < 4; ++a) {
            value += u.weight[a] * n[a + 4 * b];
            slope += u.slope[a] * n[a + 4 * b];
        }
        result.value += v.weight[b] * value;
        result.du += v.weight[b] * slope;
        result.dv += v.slope[b] * value;
    }
    return result;
}

/// Moves uv to where `surface` comes closest to the origin, and returns the length of the last move: small
/// where it arrived. Moves are at most half a cell; a direction in which the surface stands still is not
/// followed.
template <typename Surface>
inline double gauss_newton(const Surface& surface, int steps, Vec2& uv) {
    double size = 0;
    for (int step = 0; step < steps; ++step) {
        const Tangents t = surface(uv);
        const double g0 = dot(t.du, t.value), g1 = dot(t.dv, t.value);
        double a = dot(t.du, t.du), d = dot(t.dv, t.dv);
        const double b = dot(t.du, t.dv), damping = 1e-14 * (a + d);
        if (!(a + d > 0)) return 0;
        a += damping;
        d += damping;
        Vec2 move = Vec2(b * g1 - d * g0, b * g0 - a * g1) / (a * d - b * b);
        size = glm::length(move);
        if (size > 0.5) move *= 0.5 / size;
        uv = glm::clamp(uv + move, Vec2(-1), Vec2(2));
        if (!(size > 1e-10)) return size;
    }
    return size;
}

/// How much the flat cell's value at uv rests on corners that are mere extrapolation.
inline double extrapolated_share(const Patch& patch, const Vec2& uv) {
    const std::array<double, 4> weight = {(1 - uv.x) * (1 - uv.y), uv.x * (1 - uv.y), (1 - uv.x) * uv.y,
                                          uv.x * uv.y};
    double share = 0;
    for (std::size_t corner = 0; corner < 4; ++corner)
        if (!((patch.supported >> kCellCorner[corner]) & 1)) share += std::abs(weight[corner]);
    return share;
}
inline constexpr double kMostExtrapolated = 0.25;

inline constexpr int kMostSteps = 12;
inline constexpr double kArrived = 1e-4;  // pixels

/// Of the lines of nodes in one direction, squared: their longest step and their largest third difference.
struct LineSteps {
    double step = 0, third = 0;
};

inline std::array<LineSteps, 2> line_steps(const Nodes& n) {
    std::array<LineSteps, 2> result;
    for (const std::size_t along : {std::size_t{1}, std::size_t{4}}) {
        auto& [step, third] = result[along / 4];
        for (std::size_t line = 0; line < 4; ++line) {
            const std::size_t i = line * (5 - along);
            const Vec3 a = n[i + along] - n[i], b = n[i + 2 * along] - n[i + along];
            const Vec3 c = n[i + 3 * along] - n[i + 2 * along], d3 = c - 2.0 * b + a;
            step = std::max({step, dot(a, a), dot(b, b), dot(c, c)});
            third = std::max(third, dot(d3, d3));
        }
    }
    return result;
}

inline bool is_smooth(const Nodes& n) {
    const auto lines = line_steps(n);
    return lines[0].third <= kSmoothThird * lines[0].step && lines[1].third <= kSmoothThird * lines[1].step;
}

inline double outside_of(const Vec2& uv) {
    return std::max({-uv.x, uv.x - 1, -uv.y, uv.y - 1, 0.0});
}

/// Whether the origin lies on the surface at uv, where the surface comes closest to it. What is left is along
/// the normal; it may be as large as the surface's own bends between pixels (a crease, facets as small as
/// pixels), a twentieth of the shorter tangent, and the rounding of float positions.
inline bool lies_on(const Nodes& n, const Tangents& at, double rounding) {
    const Vec3 normal = normalize_or_zero(cross(at.du, at.dv));
    std::array<double, 16> height{};
    for (std::size_t i = 0; i < 16; ++i) height[i] = dot(normal, n[i]);
    double bend = 0;
    for (const std::size_t along : {std::size_t{1}, std::size_t{4}}) {
        for (std::size_t line = 0; line < 4; ++line) {
            const double* h = &height[line * (5 - along)];
            bend = std::max({bend, std::abs(h[0] - 2 * h[along] + h[2 * along]),
                             std::abs(h[along] - 2 * h[2 * along] + h[3 * along])});
        }
    }
    const double tangent = std::sqrt(std::min(dot(at.du, at.du), dot(at.dv, at.dv)));
    return length(at.value) <= kBendShare * bend + kTangentShare * tangent + rounding;
}

inline std::optional<PatchHit> plain_inversion(const Patch& patch, const Vec3& point, const Vec2& start) {
    Nodes nodes;
    for (std::size_t i = 0; i < 16; ++i) nodes[i] = patch.nodes[i] - point;
    const bool smooth = is_smooth(nodes);

    // The flat cell leads near; a point far outside it is not in the curved one either.
    Vec2 uv = start;
    const auto cell = [&](const Vec2& at) { return bilinear(nodes, at); };
    const auto cubic = [&](const Vec2& at) { return bicubic(nodes, at); };
    double last_move = gauss_newton(cell, smooth ? 4 : kMostSteps, uv);
    if (outside_of(uv) > 2 * kOvershoot) return std::nullopt;
    if (smooth) last_move = gauss_newton(cubic, kMostSteps, uv);

    const PatchHit hit{uv, outside_of(uv)};
    if (hit.overshoot > kOvershoot || !(last_move <= kArrived)) return std::nullopt;
    if (!smooth && extrapolated_share(patch, uv) > kMostExtrapolated) return std::nullopt;
    const Tangents there = smooth ? cubic(uv) : cell(uv);
    const double rounding = kRounding * length(point);
    if (!lies_on(nodes, there, rounding)) return std::nullopt;
    return hit;
}

}  // namespace trilens_test
