// What all rays over a square of the screen see, by bounds: beams of rays that vary linearly, and the
// Bernstein coefficients of edge conics over the square. After: Hanrahan and Heckbert, Beam Tracing Polygonal
// Objects, SIGGRAPH 1984; mathematics, section 2.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "projector/exact/exact_hit.h"
#include "projector/scene/prepared_scene.h"

namespace trilens {

/// The rays of one facet over a square of the screen, closed; extrapolated where it reaches beyond the facet.
class SquareRays {
  public:
    /// `low`, `high`: opposite corners, pixels from the film's top left.
    SquareRays(const FacetRays& facet, const Vec2& low, const Vec2& high);

    /// Whether all of its rays lie in front of the facet's horizon; nothing else is to be asked where they do
    /// not.
    bool has_rays() const { return has_rays_; }

    /// Whether a ray of the square may meet the box, whose corners are measured from the facet's centre.
    bool may_meet(const Vec3& low, const Vec3& high) const;

    /// Whether its middle ray meets the triangle, whose corners are measured from the facet's centre.
    bool middle_meets(const std::array<Vec3, 3>& corner) const;

  private:
    friend struct SquareMeeting;
    struct Side {
        Vec3 normal{0};
        double offset = 0;  // the beam has normal . x >= offset
        double size = 0;    // the normal's length
    };

    void add_side(const Vec3& normal);
    /// Whether a triangle, from `shift_`, lies beyond one of the beam's sides. `size`: of what its corners
    /// are made.
    bool is_outside(const std::array<Vec3, 3>& corner, double size) const;

    Vec3 shift_{0};  // from the facet's centre to where the middle ray starts; what follows counts from there
    // Of the rays at the corners, in a ring: times their weights.
    std::array<Vec3, 4> origin_{}, direction_{};
    std::array<double, 4> weight_{};
    // The polar forms of the lines' Pluecker coordinates, of all pairs of corners.
    std::array<Vec3, 10> line_direction_{}, line_moment_{};
    double largest_direction_ = 0, largest_moment_ = 0, largest_step_ = 0;
    SampleRay middle_ray_;  // from the facet's centre
    Vec3 middle_{0};        // its direction
    std::array<Side, 5> sides_{};
    std::size_t side_count_ = 0;
    bool has_rays_ = false;
};

/// How a triangle lies to a square's rays.
struct SquareMeeting {
    enum class State : std::uint8_t { kMissed, kPartly, kWhole };

    State state = State::kMissed;
    double low = 0, high = 0;     // its t lies between, in units of the rays' directions, wherever it is met
    std::int8_t orientation = 0;  // the sign of normal . direction; 0: not one
    std::uint8_t open = 0;        // bit e: the line of edge e, from corner e to the next, passes the square
    bool clipped = false;         // some of it may lie before the rays' start, or beyond their reach

    SquareMeeting() = default;
    /// `corner`: from the facet's centre. `reach`: t up to which the rays see.
    SquareMeeting(const SquareRays& rays, const std::array<Vec3, 3>& corner, double reach);
};

/// A triangle that rays of a square may see, and whose it is: any number of the caller's but kNone.
struct SquareTriangle {
    std::array<Vec3, 3> corner;  // from the facet's centre; equal corners have equal bits
    Id surface = kNone;
};

/// What rays of a square see first.
struct SquareSight {
    bool is_sure = false;    // all of them see `surface`
    Id surface = kNone;      // kNone: nothing
    bool is_closed = false;  // all of them see something
};

/// Appends those triangles of the scene that rays of the square may meet. `surface_of`: by its number in the
/// scene. `centre`: the facet's.
void collect_triangles(const PreparedScene& scene, const Vec3& centre, const SquareRays& rays,
                       const std::function<Id(Id triangle)>& surface_of,
                       std::vector<SquareTriangle>& triangles);

/// What is seen of these, and appends to `kept` (another list) those that may be seen. Neighbours that share
/// an edge by its bits cover its image together, so that a mesh is seen whole where none of its triangles is.
/// `reach`: t up to which the rays see.
SquareSight see_first(const SquareRays& rays, double reach, std::span<const SquareTriangle> triangles,
                      std::vector<SquareTriangle>& kept);

/// An edge of a picture's part, from one point to another.
using OpenEdge = std::array<Vec3, 2>;

/// Whether each has its counterpart, which runs the other way.
bool are_paired(std::span<const OpenEdge> edges);

}  // namespace trilens
