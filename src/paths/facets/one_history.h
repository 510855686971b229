// A beam: the rays of a facet between those at its corners, bounded conservatively (beam tracing: Heckbert
// and Hanrahan 1984; the hull of a quadratic by its Bernstein coefficients, Farin).
#pragma once

#include <array>
#include <functional>
#include <optional>
#include <vector>

#include "base/math/box.h"
#include "base/raymesh/ray_mesh.h"
#include "paths/facets/divide_facet.h"

namespace trilens {

/// An interval of numbers.
struct Interval {
    double low = 0, high = 0;
    double size() const { return high - low; }
    bool meets(const Interval& other) const { return low <= other.high && other.low <= high; }
};

/// Samples of a quantity over a facet: at its corners, at the middles of its edges (opposite to the corners)
/// and at its centre, where they are known.
template <typename T>
struct PartSamples {
    std::array<T, 3> corner;
    std::optional<std::array<T, 3>> middle;  // all or none
    std::optional<T> centre;
};

/// All values that a quantity takes over the facet: exact where it is quadratic, with room in proportion to
/// what it is not. Without middles, with room for a share of the corners' range.
Interval hull_of(const PartSamples<double>& samples);

/// The beam in a frame of its own: z along its axis, from the middle of its origins.
class Beam {
  public:
    /// Rays with directions of any length. None where they fan out too far for one axis.
    static std::optional<Beam> around(const PartSamples<Ray>& rays);

    /// Whether some ray of the beam may touch the box, before `far` along the axis.
    bool may_touch(const Box& box, double far) const;

    /// A triangle or, with two equal corners, a segment, widened by `stray`.
    struct Piece {
        std::array<Vec3, 3> corner;
        double stray = 0;
    };
    bool may_touch(const Piece& piece, double far) const;

    double along(const Vec3& point) const { return dot(point - origin_, axis_[2]); }
    const Vec3& axis() const { return axis_[2]; }
    /// No unit direction of the beam differs by more from the axis.
    double turn() const { return turn_; }
    /// About how wide the beam is where it starts.
    double width() const { return width_; }

    /// The side of a nearly flat piece of surface that each ray starts or ends on: height of a point over a
    /// plane, along the axis, and how far the rays' own points may lie from that plane.
    struct Plane {
        Vec3 slope{0};  // height(p) = dot(slope, p) + offset; its part along the axis is 1
        double offset = 0;
        double room = 0;
        double height(const Vec3& point) const { return dot(slope, point) + offset; }
    };
    Plane plane_through(const PartSamples<Vec3>& points) const;

  private:
    static constexpr std::size_t kDirections = 4, kMostRays = 6;
    Interval across(std::size_t direction, const Interval& along) const;
    template <typename Extent>
    bool overlaps(const Extent& extent, double far) const;

    Vec3 origin_{0};
    std::array<Vec3, 3> axis_{};
    std::array<Vec3, kDirections> lateral_{};  // unit, at right angles to the axis
    double start_ = 0, turn_ = 0, width_ = 0;
    // Per direction and ray of the hull, which may be there twice: where it is at z = 0, and how fast it
    // moves with z.
    std::array<std::array<double, kMostRays>, kDirections> ray_at_{}, ray_moves_{};
    std::array<Vec2, kDirections> room_{};  // at z = 0, and per z
};

// Whether all rays of a facet have one history: beams against the patches of all optics, conservatively.

/// What is asked about a part of a facet.
struct HistoryProof {
    const ProbeContext& context;
    const FacetPart& part;  // projected: with its histories, corners and what was probed inside
    /// Whether an optic that the first reflection may meet is drawn over it, wherever it is met. Unset: none
    /// is.
    std::function<bool(Id optic)> drawn_over = {};
    /// Whether the camera's own rays are to be proven to meet the optic too, in one sheet: facets on the
    /// film.
    bool from_camera = false;
};

/// Proof that every ray between those that were probed has the part's histories: between one optic and the
/// next each beam, from the hull of its rays, touches no patch of any optic but those where it starts and
/// where its history has it arrive; there it crosses no silhouette (the cone of normals against that of
/// directions), no crease and no border; and no refraction passes the critical angle. False where that cannot
/// be shown.
///
/// Optics without patches (PathOptic::patches) are not asked. What is proven is proven for rays that change
/// between the samples as Beam allows. Paths too faint to be matched are not asked either.
bool has_one_history(const HistoryProof& proof);

/// Whether all rays of a part that were probed come, after its history h, to where an optic lies on an
/// object: that is what they see, whatever follows. False where its centre was not probed.
bool rests_on_object(const FacetPart& part, std::size_t h);

}  // namespace trilens
