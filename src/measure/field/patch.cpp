#include "measure/field/patch.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>

namespace trilens {
namespace {

using Nodes = std::array<Vec3, 16>;

constexpr std::uint16_t kLastColumn = 0x8888, kAll = 0xffff;

bool has(std::uint16_t mask, int node) {
    return (mask >> node) & 1;
}
std::uint16_t bit(int node) {
    return static_cast<std::uint16_t>(1u << node);
}

// --- Which pixels belong ---

/// Bits of the nodes that may belong (and are in the field), and of those linked to the right and down.
struct Neighbourhood {
    std::uint16_t allowed = 0, right = 0, down = 0;
};

/// Links never leave an object; whether they may leave a triangle is the piece's choice.
Neighbourhood look_around(const PositionField& field, const PatchPlace& place, const SurfaceId& piece) {
    Neighbourhood around;
    const int left = place.column - 1, top = place.row - 1;
    const int first = std::max(0, -left), last = std::min(4, field.width - left);
    for (int b = std::max(0, -top); b < std::min(4, field.height - top); ++b) {
        const std::size_t row = static_cast<std::size_t>(top + b) * static_cast<std::size_t>(field.width);
        for (int a = first; a < last; ++a) {
            const std::size_t i = row + static_cast<std::size_t>(left + a);
            if (!field.shows_linked(i, piece)) continue;
            const std::uint16_t here = bit(a + 4 * b);
            around.allowed |= here;
            if (field.links[i] & PositionField::kRight) around.right |= here;
            if (field.links[i] & PositionField::kDown) around.down |= here;
        }
    }
    around.right &= static_cast<std::uint16_t>(~kLastColumn);
    return around;
}

/// All allowed nodes that links connect with `seeds`.
std::uint16_t flood(const Neighbourhood& around, std::uint16_t seeds) {
    unsigned piece = seeds & around.allowed, before = 0;
    while (piece != before) {
        before = piece;
        piece |= (piece & around.right) << 1 | (piece & around.down) << 4;
        piece |= (piece >> 1 & around.right) | (piece >> 4 & around.down);
        piece &= around.allowed;
    }
    return static_cast<std::uint16_t>(piece);
}

Nodes points_of(const PositionField& field, const PatchPlace& place, std::uint16_t mask) {
    Nodes points{};
    for (int node = 0; node < 16; ++node) {
        if (has(mask, node))
            points[static_cast<std::size_t>(node)] =
                field.point(field.index(place.column - 1 + node % 4, place.row - 1 + node / 4));
    }
    return points;
}

// --- Extrapolation ---

enum Kind { kNoEstimate, kConstant, kLinear, kParallelogram, kQuadratic };

/// The nodes one, two and three steps from a node in one direction; kOutside where they leave the patch.
using Ray = std::array<int, 3>;
constexpr int kOutside = -1;

constexpr int node_at(int a, int b) {
    return a >= 0 && a < 4 && b >= 0 && b < 4 ? a + 4 * b : kOutside;
}

/// What a node's estimates rest on: the rays right, left, down and up, and of each of the four cells round it
/// the neighbours across and along, and the corner opposite.
struct Surroundings {
    std::array<Ray, 4> rays{};
    std::array<Ray, 4> cells{};
};

constexpr std::array<Surroundings, 16> all_surroundings() {
    std::array<Surroundings, 16> all{};
    constexpr int kWays[4][2] = {{1, 0}, {-1, 0}, {0, 1}, {0, -1}};
    constexpr int kCells[4][2] = {{-1, -1}, {-1, 1}, {1, -1}, {1, 1}};
    for (int node = 0; node < 16; ++node) {
        const int a = node % 4, b = node / 4;
        Surroundings& here = all[static_cast<std::size_t>(node)];
        for (std::size_t k = 0; k < 4; ++k) {
            for (int step = 1; step <= 3; ++step)
                here.rays[k][static_cast<std::size_t>(step - 1)] =
                    node_at(a + step * kWays[k][0], b + step * kWays[k][1]);
            here.cells[k] = {node_at(a + kCells[k][0], b), node_at(a, b + kCells[k][1]),
                             node_at(a + kCells[k][0], b + kCells[k][1])};
        }
    }
    return all;
}
constexpr std::array<Surroundings, 16> kSurroundings = all_surroundings();

/// How many nodes of a ray are known before the first that is not.
int known_along(std::uint16_t known, const Ray& ray) {
    int steps = 0;
    while (steps < 3 && ray[static_cast<std::size_t>(steps)] != kOutside &&
           has(known, ray[static_cast<std::size_t>(steps)]))
        ++steps;
    return steps;
}

/// The mean of all estimates of the best kind.
struct Estimate {
    Kind kind = kNoEstimate;
    int count = 0;
    Vec3 sum{0};

    void add(const Vec3& value) {
        ++count;
        sum += value;
    }
};

Estimate estimate(const Nodes& nodes, std::uint16_t known, int node) {
    const Surroundings& around = kSurroundings[static_cast<std::size_t>(node)];
    const auto at = [&](int i) -> const Vec3& { return nodes[static_cast<std::size_t>(i)]; };
    std::array<int, 4> steps{};
    int most = 0;
    for (std::size_t k = 0; k < 4; ++k) most = std::max(most, steps[k] = known_along(known, around.rays[k]));

    Estimate result;
    if (most == 3) {
        result.kind = kQuadratic;
        for (std::size_t k = 0; k < 4; ++k) {
            const auto [p, q, r] = around.rays[k];
            if (steps[k] == 3) result.add(3.0 * (at(p) - at(q)) + at(r));
        }
        return result;
    }
    for (const auto& [across, along, corner] : around.cells) {
        if (corner == kOutside || !has(known, across) || !has(known, along) || !has(known, corner)) continue;
        result.kind = kParallelogram;
        result.add(at(across) + at(along) - at(corner));
    }
    if (result.kind == kParallelogram || most == 0) return result;
    result.kind = most == 2 ? kLinear : kConstant;
    for (std::size_t k = 0; k < 4; ++k) {
        const auto [p, q, r] = around.rays[k];
        if (steps[k] == most) result.add(most == 2 ? 2.0 * at(p) - at(q) : at(p));
    }
    return result;
}

/// Fills the nodes of `wanted` that are not `known`, ring by ring outward, by estimates of kind `worst` or
/// better.
void extrapolate(Nodes& nodes, std::uint16_t& known, std::uint16_t wanted, Kind worst) {
    for (int pass = 0; pass < 4 && (known & wanted) != wanted; ++pass) {
        std::uint16_t found = 0;
        Nodes ring;
        for (unsigned left = wanted & ~known; left; left &= left - 1) {
            const int node = std::countr_zero(left);
            const Estimate one = estimate(nodes, known, node);
            if (one.kind < worst) continue;
            ring[static_cast<std::size_t>(node)] = one.sum / static_cast<double>(one.count);
            found |= bit(node);
        }
        if (!found) return;
        for (unsigned left = found; left; left &= left - 1) {
            const std::size_t node = static_cast<std::size_t>(std::countr_zero(left));
            nodes[node] = ring[node];
        }
        known |= found;
    }
}

/// Continues the patch to pixels where the other image sees the piece: there the difference of the two images
/// is extrapolated, which is small and smooth where they nearly agree, however much the seen points
/// themselves bend.
void extend_alongside(const PositionField& other, const PatchPlace& place, const SurfaceId& piece,
                      Patch& patch) {
    const std::uint16_t sees = flood(look_around(other, place, piece), patch.measured);
    std::uint16_t known = patch.measured & sees;
    if (known == 0 || (sees & ~patch.measured) == 0) return;
    const Nodes points = points_of(other, place, sees);
    Nodes difference{};
    for (std::size_t i = 0; i < 16; ++i) difference[i] = patch.nodes[i] - points[i];
    extrapolate(difference, known, sees, kConstant);
    for (int node = 0; node < 16; ++node) {
        const std::size_t i = static_cast<std::size_t>(node);
        if (has(known, node) && !has(patch.measured, node)) patch.nodes[i] = points[i] + difference[i];
    }
    patch.supported |= known;
}

}  // namespace

std::optional<Patch> make_patch(const PositionField& field, const PositionField& other,
                                const PatchPlace& place, const SurfaceId& piece) {
    const int seed = kCellCorner[static_cast<std::size_t>(place.corner)];
    Patch patch;
    patch.measured = flood(look_around(field, place, piece), bit(seed));
    if (patch.measured == 0) return std::nullopt;
    patch.nodes = points_of(field, place, patch.measured);
    patch.supported = patch.measured;
    if (patch.measured != kAll) extend_alongside(other, place, piece, patch);
    std::uint16_t known = patch.supported;
    extrapolate(patch.nodes, known, kAll, kLinear);
    if (known != kAll) return std::nullopt;
    return patch;
}

// --- Which points a patch may show ---

namespace {

struct Tangents {
    Vec3 value, du, dv;
};

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
