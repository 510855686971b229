// Where a beam falls on a receiver's plane, and how much of that lies in a footprint.
#pragma once

#include <array>
#include <optional>
#include <span>

#include "caustics/beams/beams.h"
#include "shade/receiver.h"

namespace trilens {

/// Coordinates of a receiver's plane in which its footprint is the square [-1/2, 1/2]^2; of a receiver
/// without one orthonormal ones about the point.
struct ReceiverPlane {
    explicit ReceiverPlane(const Receiver& receiver, double largest_side);

    Vec3 point{0}, normal{0};
    Vec3 side_s{0}, side_t{0};
    Vec3 dual_s{0}, dual_t{0};
    std::span<const Vec2> outline;  // the receiver's: what lies beside it is no footprint
    double unit_area = 1;           // world area of the unit square
    double mean_area = 1;           // and of the footprint
    double reach = 0;      // of the footprint around the point
    bool has_footprint = false;

    Vec3 place(const Vec2& at) const { return point + at.x * side_s + at.y * side_t; }
    Vec2 at(const Vec3& place) const {
        const Vec3 way = place - point;
        return {dot(way, dual_s), dot(way, dual_t)};
    }
};

/// Rays this nearly along a plane bring no light to it.
inline constexpr double kGrazingFall = 1e-4;

/// Where a ray falls, in the plane's coordinates; none where it starts behind the plane or goes away from it.
std::optional<Vec2> place_on(const ReceiverPlane& plane, const BeamEnd& end);

/// A triangle of a beam on a plane.
struct FallenBeam {
    std::array<Vec2, 3> at{};              // in the plane's coordinates
    std::array<Vec3, 3> light{};           // at its corners
    std::array<double, 3> share{1, 1, 1};  // of the mean light, how much falls around each corner
    std::array<Vec3, 3> weights{Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1)};  // of the beam's ends
    std::array<Vec2, 3> place{};                                               // on the light's window
    double measure = 0;                                                        // of the light's film
};

/// Scaled so that the triangle's light stays what it is; where corners differ by much, as at folds, by no
/// more than says anything.
void keep_light(std::array<double, 3>& share);

/// The triangles, at most three, that a beam makes on the side of the plane that its rays come to; fewer
/// parts where some of its rays go away from the plane, or start behind it.
struct FallenBeams {
    std::array<FallenBeam, 3> part;
    std::size_t count = 0;
};
/// Those that lie wholly farther from the footprint than `reach`, in its own coordinates along either, may be
/// left out.
FallenBeams fall(const BeamCorners& beam, const ReceiverPlane& plane, double reach = 0);

/// What of a triangle is at the footprint.
struct FootprintPart {
    double density = 0;  // of the light's film per unit of the plane's coordinates, times the part inside
    Vec3 weights{0};     // of the triangle's corners, at the part's middle
    std::optional<Vec2> middle = {};  // in the plane's coordinates, where that is known
};
std::optional<FootprintPart> part_at_footprint(const FallenBeam& fallen, const ReceiverPlane& plane);

}  // namespace trilens
