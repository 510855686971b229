// Finds where a patch shows a point, and which points it may show.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

#include "measure/patch.h"

namespace trilens {
namespace {

struct Tangents {
    Vec3 value, du, dv;
};

/// Nodes relative to the point that is looked for, so that its own size costs no digits.
using Nodes = std::array<Vec3, 16>;

Tangents bilinear(const Nodes& n, const Vec2& uv) {
    const Vec3 &p00 = n[5], &p10 = n[6], &p01 = n[9], &p11 = n[10];
    const Vec3 twist = p11 - p10 - p01 + p00, du = p10 - p00, dv = p01 - p00;
    return {p00 + uv.x * du + uv.y * dv + uv.x * uv.y * twist, du + uv.y * twist, dv + uv.x * twist};
}

/// The cubic through values at -1, 0, 1, 2 (Lagrange): weights and their derivatives.
struct Cubic {
    std::array<double, 4> weight, slope;
};

Cubic cubic_at(double s) {
    const double a = s + 1, b = s, c = s - 1, d = s - 2;
    return {{-b * c * d / 6, a * c * d / 2, -a * b * d / 2, a * b * c / 6},
            {-(c * d + b * d + b * c) / 6, (c * d + a * d + a * c) / 2, -(b * d + a * d + a * b) / 2,
             (b * c + a * c + a * b) / 6}};
}

Tangents bicubic(const Nodes& n, const Vec2& uv) {
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
double gauss_newton(const Surface& surface, int steps, Vec2& uv) {
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
double extrapolated_share(const Patch& patch, const Vec2& uv) {
    const std::array<double, 4> weight = {(1 - uv.x) * (1 - uv.y), uv.x * (1 - uv.y), (1 - uv.x) * uv.y,
                                          uv.x * uv.y};
    double share = 0;
    for (std::size_t corner = 0; corner < 4; ++corner)
        if (!((patch.supported >> kCellCorner[corner]) & 1)) share += std::abs(weight[corner]);
    return share;
}
constexpr double kMostExtrapolated = 0.25;

constexpr int kMostSteps = 12;
constexpr double kArrived = 1e-4;  // pixels

/// Of the lines of nodes in one direction, squared: their longest step and their largest third difference.
struct LineSteps {
    double step = 0, third = 0;
};

std::array<LineSteps, 2> line_steps(const Nodes& n) {
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

/// Whether steps along the lines change so little that a cubic through them means something: a third
/// difference is at most a quarter of the longest step. A jump at a patch's end gives 1, a crease of 25 %
/// gives a quarter.
constexpr double kSmoothThird = 1.0 / 16;  // squared

bool is_smooth(const Nodes& n) {
    const auto lines = line_steps(n);
    return lines[0].third <= kSmoothThird * lines[0].step && lines[1].third <= kSmoothThird * lines[1].step;
}

double outside_of(const Vec2& uv) {
    return std::max({-uv.x, uv.x - 1, -uv.y, uv.y - 1, 0.0});
}

constexpr double kBendShare = 0.5, kTangentShare = 0.05;                   // of what is left over
constexpr double kRounding = 4.0 * std::numeric_limits<float>::epsilon();  // of the point's distance

/// Whether the origin lies on the surface at uv, where the surface comes closest to it. What is left is along
/// the normal; it may be as large as the surface's own bends between pixels (a crease, facets as small as
/// pixels), a twentieth of the shorter tangent, and the rounding of float positions.
bool lies_on(const Nodes& n, const Tangents& at, double rounding) {
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

// --- Which points a patch may show
// -------------------------------------------------------------------------------------

constexpr double kFrom = -kOvershoot, kTo = 1 + kOvershoot;  // of u and v

/// Row i: the i-th Bernstein coefficient on kFrom .. kTo of the cubic through values at -1, 0, 1, 2, which is
/// its polar form (blossom) at i times kTo and 3 - i times kFrom: the mean over all orders of the roots.
constexpr std::array<std::array<double, 4>, 4> bernstein_of_nodes() {
    std::array<std::array<double, 4>, 4> weights{};
    for (std::size_t i = 0; i < 4; ++i) {
        const double x = i > 2 ? kTo : kFrom, y = i > 1 ? kTo : kFrom, z = i > 0 ? kTo : kFrom;
        for (std::size_t a = 0; a < 4; ++a) {
            std::array<double, 3> root{};
            double scale = 1;
            for (std::size_t b = 0, k = 0; b < 4; ++b) {
                if (b == a) continue;
                root[k++] = static_cast<double>(b) - 1;
                scale *= static_cast<double>(a) - static_cast<double>(b);
            }
            const auto [p, q, r] = root;
            weights[i][a] =
                ((x - p) * (y - q) * (z - r) + (x - p) * (y - r) * (z - q) + (x - q) * (y - p) * (z - r) +
                 (x - q) * (y - r) * (z - p) + (x - r) * (y - p) * (z - q) + (x - r) * (y - q) * (z - p)) /
                (6 * scale);
        }
    }
    return weights;
}

/// Points whose hull holds a surface over the cell and kOvershoot around it, and a bound of the shorter of
/// its tangents there.
struct Hull {
    std::array<Vec3, 16> points{};
    std::size_t count = 0;
    double tangent = 0;
};

Hull cubic_hull(const Nodes& n) {
    static constexpr auto kWeights = bernstein_of_nodes();
    std::array<Vec3, 16> along_u{};
    Hull hull;
    hull.count = 16;
    for (std::size_t line = 0; line < 4; ++line)
        for (std::size_t i = 0; i < 4; ++i)
            for (std::size_t a = 0; a < 4; ++a) along_u[i + 4 * line] += kWeights[i][a] * n[a + 4 * line];
    for (std::size_t line = 0; line < 4; ++line)
        for (std::size_t i = 0; i < 4; ++i)
            for (std::size_t a = 0; a < 4; ++a)
                hull.points[line + 4 * i] += kWeights[i][a] * along_u[line + 4 * a];

    Vec2 tangent(0);
    for (std::size_t k = 0; k < 16; ++k) {
        if (k % 4 < 3) tangent.x = std::max(tangent.x, length(hull.points[k + 1] - hull.points[k]));
        if (k < 12) tangent.y = std::max(tangent.y, length(hull.points[k + 4] - hull.points[k]));
    }
    hull.tangent = 3 / (kTo - kFrom) * std::min(tangent.x, tangent.y);
    return hull;
}

Hull cell_hull(const Nodes& n) {
    Hull hull;
    Vec2 tangent(0);
    for (const double u : {kFrom, kTo})
        for (const double v : {kFrom, kTo}) {
            const Tangents corner = bilinear(n, {u, v});
            hull.points[hull.count++] = corner.value;
            tangent = glm::max(tangent, Vec2(length(corner.du), length(corner.dv)));
        }
    hull.tangent = std::min(tangent.x, tangent.y);
    return hull;
}

/// What lies_on may take for the bend of a surface, whatever its normal.
double largest_bend(const Nodes& n) {
    double bend = 0;
    for (const std::size_t along : {std::size_t{1}, std::size_t{4}})
        for (std::size_t line = 0; line < 4; ++line)
            for (const std::size_t i : {line * (5 - along), line * (5 - along) + along})
                bend = std::max(bend, length(n[i] - 2.0 * n[i + along] + n[i + 2 * along]));
    return bend;
}

void include(Box& box, const Hull& hull, double margin) {
    const Vec3 around(margin + kTangentShare * hull.tangent);
    for (std::size_t i = 0; i < hull.count; ++i) {
        box.include(hull.points[i] - around);
        box.include(hull.points[i] + around);
    }
}

}  // namespace

Box reach_of(const Patch& patch) {
    double size = 0;
    for (const Vec3& node : patch.nodes) size = std::max(size, length(node));
    // What a patch shows lies within a few times its own distance from the origin.
    const double margin = kBendShare * largest_bend(patch.nodes) + 8 * kRounding * size;

    // Relative to a point, nodes round differently: where that could decide whether they are smooth, both.
    bool may_be_smooth = true, may_be_rough = false;
    for (const auto& [step, third] : line_steps(patch.nodes)) {
        const double doubt = 1e-6 * step + 1e-20 * size * size;
        may_be_smooth = may_be_smooth && third <= kSmoothThird * step + doubt;
        may_be_rough = may_be_rough || third >= kSmoothThird * step - doubt;
    }
    Box box;
    if (may_be_smooth) include(box, cubic_hull(patch.nodes), margin);
    if (may_be_rough) include(box, cell_hull(patch.nodes), margin);
    return box;
}

std::optional<PatchHit> invert_patch(const Patch& patch, const Vec3& point, const Vec2& start) {
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

}  // namespace trilens
