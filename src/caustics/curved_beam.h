// A beam as a quadratic triangle on a receiver's plane (isoparametric six-node element), in flat pieces.
#pragma once

#include <array>
#include <cmath>
#include <functional>
#include <optional>

#include "caustics/beams/quadratic.h"
#include "caustics/footprint.h"

namespace trilens {

using BeamEnds = std::array<const BeamEnd*, 3>;

/// The longest of its sides where it leaves the last optic.
double width_of(const BeamCorners& corners);

/// A beam on a plane: of its ends and then of the middles of its sides.
struct FallenCurve {
    std::array<Vec2, 6> at{};  // in the plane's coordinates
    std::array<Vec3, 6> light{};
};
using UsePiece = std::function<void(const BeamCorners&, const FallenBeam&)>;

/// A beam, or a part of one, with the exact rays at the middles of its sides, across from its ends.
struct CurvedBeam {
    BeamCorners corners;
    BeamEnds middle{};

    /// Where the ends and then the middles fall, in the plane's coordinates; none where one does not, or the
    /// plane lies so askew that a quadratic says nothing.
    std::optional<std::array<Vec2, 6>> fall(const ReceiverPlane& plane) const;

    /// Whether the ways from the last optic to a plane on which it falls are nearly alike, so that the optic
    /// hardly stands in the way of a part of it.
    bool falls_evenly(const ReceiverPlane& plane) const;

    /// Of the ends and then of the middles: times how much more of the light's film a unit of places is there
    /// than in the beam's mean, since pieces are equal in places.
    std::array<Vec3, 6> lights() const;

    /// Calls use(corners, fallen) for those of its sides x sides flat pieces that come to the square [-half,
    /// half]^2; places on the window are told of points only, where half is 0. `curve`: as fall() and
    /// lights() have it, in any coordinates. `sides`: 1, 2 or 4.
    template <typename Use>
    void for_each_piece(const FallenCurve& curve, double half, int sides, const Use& use) const;
};

/// The mean of the light that sides x sides pieces have.
Vec3 mean_light(const std::array<Vec3, 6>& light, int sides);

/// Of the mean light of a piece, one of `pieces` of a beam, how much falls around each of its corners, as the
/// quadratic has it.
std::array<double, 3> shares_of(const std::array<Vec2, 6>& at, const FallenBeam& piece, double pieces);

/// How far the farthest middle lies from that of its chord.
double bulge_on_plane(const std::array<Vec2, 6>& at);

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

/// The Bezier points of a quadratic triangle, whose hull holds it: the corners, then those across from them.
inline std::array<Vec2, 6> bezier_points(const std::array<Vec2, 6>& at) {
    std::array<Vec2, 6> points = at;
    for (std::size_t k = 0; k < 3; ++k)
        points[3 + k] = 2.0 * at[3 + k] - 0.5 * (at[(k + 1) % 3] + at[(k + 2) % 3]);
    return points;
}

/// Whether a line along one of the first three corners' sides parts the hull from the square [-half, half]^2
/// (separating axes), up to rounding.
template <std::size_t kCount>
bool is_apart(const std::array<Vec2, kCount>& hull, double half) {
    for (std::size_t k = 0; k < 3; ++k) {
        const Vec2 side = hull[(k + 1) % 3] - hull[k];
        const double reach = half * (std::fabs(side.x) + std::fabs(side.y));
        double low = cross(side, hull[0]), high = low;
        for (std::size_t i = 1; i < kCount; ++i) {
            const double at = cross(side, hull[i]);
            low = at < low ? at : low, high = at > high ? at : high;
        }
        if (low > reach || high < -reach) return true;
    }
    return false;
}

/// Which of the square's sides the point lies beyond, a bit each (Cohen and Sutherland's outcode).
inline unsigned sides_beyond(const Vec2& at, double half) {
    return static_cast<unsigned>(at.x > half) | static_cast<unsigned>(at.x < -half) << 1 |
           static_cast<unsigned>(at.y > half) << 2 | static_cast<unsigned>(at.y < -half) << 3;
}

/// The pieces of a curved beam, and their corners, row by row from the third corner's side.
struct PieceGrid {
    static constexpr int kMostSides = 4;
    static constexpr std::size_t kMostCorners = (kMostSides + 1) * (kMostSides + 2) / 2;
    std::size_t corners = 0, pieces = 0;
    std::array<Vec3, kMostCorners> weights;
    std::array<std::array<double, 6>, kMostCorners> quadratic;
    std::array<std::array<std::size_t, 3>, kMostSides * kMostSides> piece;
    // The quadratic weights of the pieces' corners once more, piece by piece; 0 of pieces that there are not.
    alignas(64) double of_piece[3][6][kMostSides * kMostSides] = {};

    explicit PieceGrid(int sides);
    static const PieceGrid& of(int sides);
};

/// What the square [-1/2, 1/2]^2 cuts out of each of a curved beam's flat pieces.
struct CutPieces {
    static constexpr std::size_t kMost = PieceGrid::kMostSides * PieceGrid::kMostSides;
    std::size_t count = 0;
    alignas(64) double share[kMost];      // of the piece: 1 where all of it is inside, whatever its area
    alignas(64) double weight[3][kMost];  // of its corners at the part's middle, where there is a part
};
/// `at`: of the ends and middles. Up to rounding as part_at_footprint() has it of each piece.
void cut_pieces(const std::array<Vec2, 6>& at, int sides, CutPieces& cut);

template <typename Use>
void CurvedBeam::for_each_piece(const FallenCurve& curve, double half, int sides, const Use& use) const {
    const std::array<Vec2, 6>& at = curve.at;
    if (half > 0) {
        const std::array<Vec2, 6> hull = bezier_points(at);
        if (is_beyond(hull, half, 0) || is_apart(hull, half)) return;
    } else if (is_beyond(at, half, bulge_on_plane(at))) {
        return;
    }
    const PieceGrid& grid = PieceGrid::of(sides);
    std::array<Vec2, PieceGrid::kMostCorners> corner;
    std::array<unsigned, PieceGrid::kMostCorners> beyond;
    for (std::size_t n = 0; n < grid.corners; ++n) {
        corner[n] = Vec2(0);
        for (std::size_t k = 0; k < 6; ++k) corner[n] += grid.quadratic[n][k] * at[k];
        beyond[n] = sides_beyond(corner[n], half);
    }
    for (std::size_t p = 0; p < grid.pieces; ++p) {
        const std::array<std::size_t, 3>& ends = grid.piece[p];
        if ((beyond[ends[0]] & beyond[ends[1]] & beyond[ends[2]]) != 0) continue;
        FallenBeam fallen;
        fallen.at = {corner[ends[0]], corner[ends[1]], corner[ends[2]]};
        if (half > 0 && is_apart(fallen.at, half)) continue;
        for (std::size_t k = 0; k < 3; ++k) {
            const std::size_t n = ends[k];
            const Vec3& w = fallen.weights[k] = grid.weights[n];
            fallen.light[k] = Vec3(0);
            for (std::size_t c = 0; c < 6; ++c) fallen.light[k] += grid.quadratic[n][c] * curve.light[c];
            if (half == 0)
                fallen.place[k] =
                    w.x * corners.end[0]->place + w.y * corners.end[1]->place + w.z * corners.end[2]->place;
        }
        if (half == 0) fallen.share = shares_of(at, fallen, static_cast<double>(grid.pieces));
        fallen.measure = corners.measure / static_cast<double>(grid.pieces);
        use(corners, fallen);
    }
}

}  // namespace trilens
