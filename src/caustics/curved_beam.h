// A beam as a quadratic triangle on a receiver's plane (isoparametric six-node element), in flat pieces.
#pragma once

#include <array>
#include <functional>
#include <optional>

#include "caustics/footprint.h"

namespace trilens {

using BeamEnds = std::array<const BeamEnd*, 3>;
using UsePiece = std::function<void(const BeamCorners&, const FallenBeam&)>;

/// A beam, or a part of one, with the exact rays at the middles of its sides, across from its ends.
struct CurvedBeam {
    BeamCorners corners;
    BeamEnds middle{};

    /// Where the ends and then the middles fall, in the plane's coordinates; none where one does not, or the
    /// plane lies so askew that a quadratic says nothing.
    std::optional<std::array<Vec2, 6>> fall(const ReceiverPlane& plane) const;

    /// Calls use for those of its sides x sides flat pieces that come to the square [-half, half]^2. `at`: as
    /// fall() has it, in any coordinates. `sides`: 1, 2 or 4.
    template <typename Use>
    void for_each_piece(const std::array<Vec2, 6>& at, double half, int sides, const Use& use) const;

    /// The mean of the light that the pieces have.
    Vec3 mean_light(int sides) const;
};

/// How far the farthest middle lies from that of its chord.
double bulge_on_plane(const std::array<Vec2, 6>& at);

/// Quadratic Lagrange weights of the corners and of the middles across from them.
inline std::array<double, 6> quadratic_weights(const Vec3& w) {
    return {w.x * (2 * w.x - 1), w.y * (2 * w.y - 1), w.z * (2 * w.z - 1),
            4 * w.y * w.z,       4 * w.z * w.x,       4 * w.x * w.y};
}

/// Whether the triangles' hull lies outside of the square [-half, half]^2 by more than `room`.
template <std::size_t kCount>
bool is_beyond(const std::array<Vec2, kCount>& at, double half, double room) {
    for (int c = 0; c < 2; ++c) {
        double low = at[0][c], high = low;
        for (const Vec2& one : at) low = one[c] < low ? one[c] : low, high = one[c] > high ? one[c] : high;
        if (low - room > half || high + room < -half) return true;
    }
    return false;
}

/// The pieces of a curved beam, and their corners, row by row from the third corner's side.
struct PieceGrid {
    static constexpr int kMostSides = 4;
    static constexpr std::size_t kMostCorners = (kMostSides + 1) * (kMostSides + 2) / 2;
    std::size_t corners = 0, pieces = 0;
    std::array<Vec3, kMostCorners> weights;
    std::array<std::array<double, 6>, kMostCorners> quadratic;
    std::array<std::array<std::size_t, 3>, kMostSides * kMostSides> piece;

    explicit PieceGrid(int sides);
    static const PieceGrid& of(int sides);
};

template <typename Use>
void CurvedBeam::for_each_piece(const std::array<Vec2, 6>& at, double half, int sides, const Use& use) const {
    if (is_beyond(at, half, bulge_on_plane(at))) return;
    const PieceGrid& grid = PieceGrid::of(sides);
    std::array<Vec2, PieceGrid::kMostCorners> corner;
    for (std::size_t n = 0; n < grid.corners; ++n) {
        corner[n] = Vec2(0);
        for (std::size_t k = 0; k < 6; ++k) corner[n] += grid.quadratic[n][k] * at[k];
    }
    for (std::size_t p = 0; p < grid.pieces; ++p) {
        FallenBeam fallen;
        for (std::size_t k = 0; k < 3; ++k) fallen.at[k] = corner[grid.piece[p][k]];
        if (is_beyond(fallen.at, half, 0)) continue;
        for (std::size_t k = 0; k < 3; ++k) {
            const std::size_t n = grid.piece[p][k];
            const Vec3& w = fallen.weights[k] = grid.weights[n];
            const std::array<double, 6>& q = grid.quadratic[n];
            fallen.light[k] = Vec3(0);
            for (std::size_t c = 0; c < 3; ++c)
                fallen.light[k] += q[c] * corners.end[c]->light + q[3 + c] * middle[c]->light;
            fallen.place[k] =
                w.x * corners.end[0]->place + w.y * corners.end[1]->place + w.z * corners.end[2]->place;
        }
        fallen.measure = corners.measure / static_cast<double>(grid.pieces);
        use(corners, fallen);
    }
}

}  // namespace trilens
