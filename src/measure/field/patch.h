// A patch of a position field: 4 x 4 pixels of one piece of surface round a cell, and its
// inversion.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "base/math/box.h"
#include "base/math/vec.h"
#include "measure/field/position_field.h"

namespace trilens {

/// The cell of pixel centres (column, row) .. (column + 1, row + 1), both from -1, seen from one of its
/// corners.
struct PatchPlace {
    int column = 0, row = 0;
    int corner = 0;  // 0..3: (0, 0), (1, 0), (0, 1), (1, 1)
};

/// Node (a, b) of a patch, a, b = 0..3, is pixel (column - 1 + a, row - 1 + b); bit a + 4 b stands for it.
struct Patch {
    std::array<Vec3, 16> nodes{};  // seen points, world frame
    std::uint16_t measured = 0;    // pixels of the field that belong to the piece
    std::uint16_t supported =
        0;  // measured, or continued alongside the other field; the rest is extrapolated
};

/// The corners of the cell as bits of a patch.
inline constexpr std::array<int, 4> kCellCorner = {5, 6, 9, 10};

/// The patch of the piece of surface at the corner of a cell: pixels of `field` that show `piece` and are
/// linked with the corner inside the patch. What is missing is continued, first alongside `other` (a linked
/// field of the same size, nearly the same picture), then by extrapolation; as the corner is measured, the
/// cell reaches at most one pixel beyond the piece. Nothing where the corner does not show the piece, or the
/// piece is too thin to have a slope.
std::optional<Patch> make_patch(const PositionField& field, const PositionField& other,
                                const PatchPlace& place, const SurfaceId& piece);

/// Where a patch shows a point.
struct PatchHit {
    Vec2 uv{0};            // 0..1 inside the cell, from its pixel (0, 0)
    double overshoot = 0;  // how far uv lies outside the cell, at most kOvershoot
};
inline constexpr double kOvershoot = 0.25;

/// Solves patch(uv) = point by Gauss-Newton from `start`: first on the bilinear cell, then, where the patch
/// is smooth, on the tensor cubic through all its nodes. Nothing where no uv comes close: the point is seen
/// elsewhere; nor where the answer would rest on extrapolating a patch that is not smooth.
std::optional<PatchHit> invert_patch(const Patch& patch, const Vec3& point, const Vec2& start);

/// Points, world frame: invert_patch has no answer, wherever it starts, for a point farther than `around`
/// from their convex hull.
struct PatchHull {
    std::array<Vec3, 20> points{};
    std::size_t count = 0;
    double around = 0;
};
PatchHull hull_of(const Patch& patch);

/// A box about the hull and what is as near to it.
Box reach_of(const Patch& patch);

/// Steps along the lines of a patch change so little that a cubic through them means something where a third
/// difference is at most a quarter of the longest step (this is squared). A jump at a patch's end gives 1, a
/// crease of 25 % gives a quarter.
inline constexpr double kSmoothThird = 1.0 / 16;

/// What may be left over where a patch comes closest to a point that lies on it: shares of the patch's own
/// bends and of its shorter tangent, and the rounding of float positions, of the point's distance.
inline constexpr double kBendShare = 0.5, kTangentShare = 0.05;
inline constexpr double kRounding = 4.0 * std::numeric_limits<float>::epsilon();

// Several patches inverted side by side, one in each lane of a vector.

inline constexpr std::size_t kPatchLanes = 8;

/// Questions of invert_patch, and their answers. Lanes do not see each other: an answer has the same bits in
/// any lane, with any neighbours, and with any instruction set.
struct PatchBatch {
    struct Lane {
        double lane[kPatchLanes] = {};
    };

    alignas(64) Lane nodes[16][3];     // x, y, z, relative to the point that is looked for
    alignas(64) Lane start[2];         // u, v
    alignas(64) Lane size;             // the point's distance from the origin
    alignas(64) Lane extrapolated[4];  // 1 where that corner of the cell is mere extrapolation, else 0
    std::size_t count = 0;             // lanes 0 .. count - 1 are asked

    alignas(64) Lane u, v, overshoot;  // PatchHit, of the lanes that have one
    std::uint32_t hits = 0;            // bit i: lane i has one

    /// Asks where the patch shows the point. `supported` as Patch has it.
    void ask(std::size_t lane, const Vec3& point, const Vec2& from, std::uint16_t supported);
    void set_node(std::size_t lane, std::size_t node, const Vec3& relative) {
        for (int k = 0; k < 3; ++k) nodes[node][k].lane[lane] = relative[k];
    }
    bool has_hit(std::size_t lane) const { return hits >> lane & 1; }
};

/// Fills in the answers.
void invert_patches(PatchBatch& batch);

}  // namespace trilens
