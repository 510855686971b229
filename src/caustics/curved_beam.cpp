#include "caustics/curved_beam.h"

#include <algorithm>
#include <cmath>

namespace trilens {
namespace {

/// How much longer one of a beam's rays to a plane may be than another for a quadratic to be its image, and by
/// how many times the beam's width: the tree's bulge_of counts on both.
constexpr double kMostUneven = 5.0 / 3, kMostLonger = 3;
/// And where it is called nearly alike.
constexpr double kHardlyLonger = 1.0 / 3;

double length_to(const ReceiverPlane& plane, const BeamEnd& end) {
    return dot(end.origin - plane.point, plane.normal) / -dot(end.direction, plane.normal);
}

}  // namespace

double width_of(const BeamCorners& corners) {
    double wide = 0;
    for (std::size_t k = 0; k < 3; ++k)
        wide = std::max(wide, length(corners.end[k]->origin - corners.end[(k + 1) % 3]->origin));
    return wide;
}

std::optional<std::array<Vec2, 6>> CurvedBeam::fall(const ReceiverPlane& plane) const {
    std::array<Vec2, 6> at;
    double shortest = INFINITY, longest = 0;
    for (std::size_t k = 0; k < 6; ++k) {
        const BeamEnd& end = k < 3 ? *corners.end[k] : *middle[k - 3];
        if (!(-dot(end.direction, plane.normal) > kGrazingFall)) return std::nullopt;
        const double t = length_to(plane, end);
        if (!(t >= 0)) return std::nullopt;
        at[k] = plane.at(end.origin + t * end.direction);
        shortest = std::min(shortest, t), longest = std::max(longest, t);
    }
    if (longest > kMostUneven * shortest + kMostLonger * width_of(corners)) return std::nullopt;
    return at;
}

bool CurvedBeam::falls_evenly(const ReceiverPlane& plane) const {
    double shortest = INFINITY, longest = 0;
    for (const BeamEnd* end : corners.end) {
        const double way = length_to(plane, *end);
        shortest = std::min(shortest, way), longest = std::max(longest, way);
    }
    return longest <= kMostUneven * shortest + kHardlyLonger * width_of(corners);
}

std::array<double, 3> shares_of(const std::array<Vec2, 6>& at, const FallenBeam& piece, double pieces) {
    const double area = pieces * std::fabs(cross(piece.at[1] - piece.at[0], piece.at[2] - piece.at[0]));
    std::array<double, 3> share;
    for (std::size_t k = 0; k < 3; ++k) share[k] = area / std::fabs(quadratic_spread(at, piece.weights[k]));
    keep_light(share);
    return share;
}

double bulge_on_plane(const std::array<Vec2, 6>& at) {
    double bulge = 0;
    for (std::size_t k = 0; k < 3; ++k)
        bulge = std::max(bulge, length(at[3 + k] - 0.5 * (at[(k + 1) % 3] + at[(k + 2) % 3])));
    return bulge;
}

std::array<Vec3, 6> CurvedBeam::lights() const {
    const auto& end = corners.end;
    const double area = 0.5 * std::fabs(cross(end[1]->place - end[0]->place, end[2]->place - end[0]->place));
    const double per_film = corners.measure > 0 ? area / corners.measure : 0;
    std::array<Vec3, 6> light;
    for (std::size_t k = 0; k < 3; ++k) {
        light[k] = end[k]->film * per_film * end[k]->light;
        light[3 + k] = middle[k]->film * per_film * middle[k]->light;
    }
    return light;
}

Vec3 mean_light(const std::array<Vec3, 6>& light, int sides) {
    const PieceGrid& grid = PieceGrid::of(sides);
    Vec3 sum(0);
    for (std::size_t p = 0; p < grid.pieces; ++p)
        for (const std::size_t n : grid.piece[p])
            for (std::size_t c = 0; c < 6; ++c) sum += grid.quadratic[n][c] * light[c];
    return sum / (3.0 * static_cast<double>(grid.pieces));
}

PieceGrid::PieceGrid(int sides) {
    const auto at = [&](int i, int j) {
        return static_cast<std::size_t>(j * (sides + 1) - j * (j - 1) / 2 + i);
    };
    for (int j = 0; j <= sides; ++j)
        for (int i = 0; i + j <= sides; ++i) {
            const std::size_t n = corners++;
            weights[n] = Vec3(sides - i - j, i, j) / static_cast<double>(sides);
            quadratic[n] = quadratic_weights(weights[n]);
        }
    for (int j = 0; j < sides; ++j)
        for (int i = 0; i + j < sides; ++i) {
            piece[pieces++] = {at(i, j), at(i + 1, j), at(i, j + 1)};
            if (i + j + 1 < sides) piece[pieces++] = {at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)};
        }
    for (std::size_t p = 0; p < pieces; ++p)
        for (std::size_t k = 0; k < 3; ++k)
            for (std::size_t c = 0; c < 6; ++c) of_piece[k][c][p] = quadratic[piece[p][k]][c];
}

const PieceGrid& PieceGrid::of(int sides) {
    static const PieceGrid one(1), two(2), four(4);
    return sides == 1 ? one : sides == 2 ? two : four;
}

}  // namespace trilens
