#include "measure/field/patch.h"

#include <algorithm>
#include <bit>
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

}  // namespace trilens
