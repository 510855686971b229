// Which points a patch may show.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "measure/field/patch.h"

namespace trilens {
namespace {

struct Tangents {
    Vec3 value, du, dv;
};

using Nodes = std::array<Vec3, 16>;

double square(const Vec3& v) {
    return dot(v, v);
}

/// The flat cell.
Tangents bilinear(const Nodes& n, const Vec2& uv) {
    const Vec3 &p00 = n[5], &p10 = n[6], &p01 = n[9], &p11 = n[10];
    const Vec3 twist = p11 - p10 - p01 + p00, du = p10 - p00, dv = p01 - p00;
    return {p00 + uv.x * du + uv.y * dv + uv.x * uv.y * twist, du + uv.y * twist, dv + uv.x * twist};
}

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
        if (k % 4 < 3) tangent.x = std::max(tangent.x, square(hull.points[k + 1] - hull.points[k]));
        if (k < 12) tangent.y = std::max(tangent.y, square(hull.points[k + 4] - hull.points[k]));
    }
    hull.tangent = 3 / (kTo - kFrom) * std::sqrt(std::min(tangent.x, tangent.y));
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
    double bend = 0;  // squared
    for (const std::size_t along : {std::size_t{1}, std::size_t{4}})
        for (std::size_t line = 0; line < 4; ++line)
            for (const std::size_t i : {line * (5 - along), line * (5 - along) + along})
                bend = std::max(bend, square(n[i] - 2.0 * n[i + along] + n[i + 2 * along]));
    return std::sqrt(bend);
}

void include(PatchHull& all, const Hull& hull, double margin) {
    for (std::size_t i = 0; i < hull.count; ++i) all.points[all.count++] = hull.points[i];
    all.around = std::max(all.around, margin + kTangentShare * hull.tangent);
}

}  // namespace

PatchHull hull_of(const Patch& patch) {
    double size = 0;
    for (const Vec3& node : patch.nodes) size = std::max(size, square(node));
    size = std::sqrt(size);
    // What a patch shows lies within a few times its own distance from the origin.
    const double margin = kBendShare * largest_bend(patch.nodes) + 8 * kRounding * size;

    // Relative to a point, nodes round differently: where that could decide whether they are smooth, both.
    bool may_be_smooth = true, may_be_rough = false;
    for (const auto& [step, third] : line_steps(patch.nodes)) {
        const double error_bound = 1e-6 * step + 1e-20 * size * size;
        may_be_smooth = may_be_smooth && third <= kSmoothThird * step + error_bound;
        may_be_rough = may_be_rough || third >= kSmoothThird * step - error_bound;
    }
    PatchHull hull;
    if (may_be_smooth) include(hull, cubic_hull(patch.nodes), margin);
    if (may_be_rough) include(hull, cell_hull(patch.nodes), margin);
    return hull;
}

Box reach_of(const Patch& patch) {
    const PatchHull hull = hull_of(patch);
    Box box;
    for (std::size_t i = 0; i < hull.count; ++i) {
        box.include(hull.points[i] - Vec3(hull.around));
        box.include(hull.points[i] + Vec3(hull.around));
    }
    return box;
}

}  // namespace trilens
