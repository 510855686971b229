// The patch of a piece of surface in plain code: a second answer beside make_patch's.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "measure/field/patch.h"

namespace trilens_test::plain {

using namespace trilens;

using Nodes = std::array<Vec3, 16>;

inline constexpr std::uint16_t kLastColumn = 0x8888, kAll = 0xffff;

inline bool has(std::uint16_t mask, int node) {
    return (mask >> node) & 1;
}
inline std::uint16_t bit(int node) {
    return static_cast<std::uint16_t>(1u << node);
}

// --- Which pixels belong ---

/// Bits of the nodes that may belong (and are in the field), and of those linked to the right and down.
struct Neighbourhood {
    std::uint16_t allowed = 0, right = 0, down = 0;
};

/// Links never leave an object; whether they may leave a triangle is the piece's choice.
inline Neighbourhood look_around(const PositionField& field, const PatchPlace& place,
                                 const SurfaceId& piece) {
    Neighbourhood around;
    for (int node = 0; node < 16; ++node) {
        const int x = place.column - 1 + node % 4, y = place.row - 1 + node / 4;
        if (!field.contains(x, y)) continue;
        const std::size_t i = field.index(x, y);
        if (!field.shows(i, piece)) continue;
        around.allowed |= bit(node);
        if (field.links[i] & PositionField::kRight) around.right |= bit(node);
        if (field.links[i] & PositionField::kDown) around.down |= bit(node);
    }
    around.right &= static_cast<std::uint16_t>(~kLastColumn);
    return around;
}

/// All allowed nodes that links connect with `seeds`.
inline std::uint16_t flood(const Neighbourhood& around, std::uint16_t seeds) {
    unsigned piece = seeds & around.allowed, before = 0;
    while (piece != before) {
        before = piece;
        piece |= (piece & around.right) << 1 | (piece & around.down) << 4;
        piece |= (piece >> 1 & around.right) | (piece >> 4 & around.down);
        piece &= around.allowed;
    }
    return static_cast<std::uint16_t>(piece);
}

inline Nodes points_of(const PositionField& field, const PatchPlace& place, std::uint16_t mask) {
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

/// The mean of all estimates of the best kind.
struct Estimate {
    Kind kind = kNoEstimate;
    int count = 0;
    Vec3 sum{0};

    void add(Kind of_kind, const Vec3& value) {
        if (of_kind < kind) return;
        if (of_kind > kind) *this = {of_kind, 0, Vec3(0)};
        ++count;
        sum += value;
    }
};

inline Estimate estimate(const Nodes& nodes, std::uint16_t known, int a, int b) {
    Estimate result;
    const auto is_known = [&](int i, int j) {
        return i >= 0 && i < 4 && j >= 0 && j < 4 && has(known, i + 4 * j);
    };
    const auto at = [&](int i, int j) -> const Vec3& { return nodes[static_cast<std::size_t>(i + 4 * j)]; };
    for (const auto& [da, db] : {std::array{1, 0}, std::array{-1, 0}, std::array{0, 1}, std::array{0, -1}}) {
        if (!is_known(a + da, b + db)) continue;
        const Vec3& p = at(a + da, b + db);
        if (!is_known(a + 2 * da, b + 2 * db)) {
            result.add(kConstant, p);
            continue;
        }
        const Vec3& q = at(a + 2 * da, b + 2 * db);
        if (is_known(a + 3 * da, b + 3 * db))
            result.add(kQuadratic, 3.0 * (p - q) + at(a + 3 * da, b + 3 * db));
        else
            result.add(kLinear, 2.0 * p - q);
    }
    for (const int da : {-1, 1}) {
        for (const int db : {-1, 1}) {
            if (is_known(a + da, b) && is_known(a, b + db) && is_known(a + da, b + db))
                result.add(kParallelogram, at(a + da, b) + at(a, b + db) - at(a + da, b + db));
        }
    }
    return result;
}

/// Fills the nodes of `wanted` that are not `known`, ring by ring outward, by estimates of kind `worst` or
/// better.
inline void extrapolate(Nodes& nodes, std::uint16_t& known, std::uint16_t wanted, Kind worst) {
    for (int pass = 0; pass < 4 && (known & wanted) != wanted; ++pass) {
        Nodes next = nodes;
        std::uint16_t next_known = known;
        for (int node = 0; node < 16; ++node) {
            if (has(known, node) || !has(wanted, node)) continue;
            const Estimate found = estimate(nodes, known, node % 4, node / 4);
            if (found.kind < worst) continue;
            next[static_cast<std::size_t>(node)] = found.sum / static_cast<double>(found.count);
            next_known |= bit(node);
        }
        if (next_known == known) return;
        nodes = next;
        known = next_known;
    }
}

/// Continues the patch to pixels where the other image sees the piece: there the difference of the two images
/// is extrapolated, which is small and smooth where they nearly agree, however much the seen points
/// themselves bend.
inline void extend_alongside(const PositionField& other, const PatchPlace& place, const SurfaceId& piece,
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

inline std::optional<Patch> plain_patch(const PositionField& field, const PositionField& other,
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

}  // namespace trilens_test::plain
