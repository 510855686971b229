// Watertight ray/triangle intersection by exact signs, on the rays that a facet interpolates between its corners.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "base/raymesh/ray_mesh.h"
#include "base/raymesh/triangle_scene.h"
#include "trilinear/facet/scene_edge.h"

namespace trilens {

// The rays of one facet over the screen: one family of coefficients that every engine starts from, bit for
// bit.

/// One facet and its weights on the screen.
struct FacetOnScreen {
    const RayMesh& mesh;
    std::size_t facet;
    FacetWeights weights;
};

/// The ray of one sample, times its weight: origin and direction are those of the ray times `weight`.
struct SampleRay {
    Vec3 origin{0}, direction{0};
    double weight = 1;
};

inline double largest_part(const Vec3& v) {
    return std::max(std::fabs(v.x), std::max(std::fabs(v.y), std::fabs(v.z)));
}

/// Depends on the facet alone, not on its samples. Positions in the world are measured from `centre`, one of
/// the facet's corner rays' origins, so that scenes far from the world's origin lose nothing; positions on
/// the screen from `screen`, a corner of the facet, so that the weights do not cancel.
struct FacetRays {
    Vec2 screen{0};   // pixels from the film's top left
    Vec3 centre{0};   // world frame
    AffineRays rays;  // over the offset from `screen`, in pixels

    /// The ray through a position of the screen. Its bits decide what a sample sees.
    SampleRay at(const Vec2& position) const {
        const Vec2 from = position - screen;
        return {rays.origin_at(from.x, from.y), rays.direction_at(from.x, from.y),
                rays.weight_at(from.x, from.y)};
    }
};

/// The facet has rays and is not edge-on.
FacetRays make_facet_rays(const FacetOnScreen& facet);

// Watertight ray/triangle intersection by exact signs, where on the triangle the ray passes, and the first of
// several hits: the decisions that all engines share, bit for bit.

/// A line meets a triangle.
struct LineHit {
    double t = 0;         // any sign, or not a number
    Vec2 barycentric{0};  // weights of the second and third corner
};

/// What hit_point() takes of a triangle: its first corner c, the edges e1 and e2 from there, and their
/// product.
struct TriangleFrame {
    Vec3 corner{0}, e1{0}, turned{0};  // turned: -e2
    Vec3 normal{0};                    // e1 x e2
    double size = 0;                   // of e1 times that of e2, in the largest coordinate
};

/// `corner`: from the facet's centre.
TriangleFrame triangle_frame(const std::array<Vec3, 3>& corner);

/// Below this share of what it is made of, the denominator is not trusted: a sliver, or a triangle seen
/// edge-on.
inline constexpr double kLeastDeterminant = 0x1p-30;

/// Where the ray passes: with s = W c - origin' and the ray times its weight W (origin' and direction',
/// mathematics section 2), t = n . s / n . direction', and the weights of the second and third corner are
/// -e2 . K and e1 . K, over W n . direction', with K = direction' x s (Moeller and Trumbore, Fast, Minimum
/// Storage Ray/Triangle Intersection, 1997, around the normal). None where the value is not trusted, or is
/// outside the triangle by its rounding. hit_points-inl.h repeats the operations, bit for bit.
std::optional<LineHit> hit_point(const SampleRay& ray, const TriangleFrame& triangle);

/// An edge conic (trilinear/facet/edge_conic.h) further from zero than this share of its terms has the sign
/// of the decision. With p = weight corner - origin', the conic is direction' . (p_a x p_b) / weight.
/// Counting roundings, each half a unit in the last place: 24 in the corners' positions on the ray's screen,
/// 20 in the conic, 16 where coefficients are moved from the facet's corner to another reference, 8 in the
/// ray.
inline constexpr double kDecisionErrorBound = 128 * 2.220446049250313e-16;

/// Whether the ray's line meets the triangle, by exact signs: the corners are projected along the ray on the
/// plane of two axes, where the ray is the origin. Every triangle with a corner gets the same projection of
/// it, so the rounded picture is still a mesh without gaps (Woop, Benthin, Wald, Watertight Ray/Triangle
/// Intersection, JCGT 2(1), 2013). `corner`: from the facet's centre. Where it lies: as hit_point() says;
/// where that says nothing, from the projection, as convex combinations: never outside the triangle, however
/// thin it is.
std::optional<LineHit> exact_hit(const SampleRay& ray, const std::array<Vec3, 3>& corner);

/// Among the triangles whose t is within kDepthTie of the smallest, the one with the smallest rank. A rival
/// may leave that band after it has driven out another that stays; `order_mattered` then asks for a second
/// pass over the same triangles, which starts with the smallest t known and so is exact.
class FirstHit {
  public:
    /// No triangle beyond this t can change the hit.
    double limit() const { return nearest_ * (1 + kDepthTie); }

    void offer(const LineHit& hit, Id triangle, Id rank) {
        if (!(hit.t >= 0 && hit.t <= limit() && hit.t < kFar)) return;
        if (hit.t < nearest_) nearest_ = hit.t;
        if (winner_ != kNone && hit_.t <= limit()) {
            contested_ = true;
            if (rank_ < rank) return;
        } else if (contested_) {
            order_mattered_ = true;
        }
        winner_ = triangle;
        rank_ = rank;
        hit_ = hit;
    }

    bool order_mattered() const { return order_mattered_; }
    void begin_second_pass() {
        winner_ = kNone;
        contested_ = order_mattered_ = false;
    }

    Id winner() const { return winner_; }  // kNone: nothing is hit
    const LineHit& hit() const { return hit_; }

  private:
    static constexpr double kFar = std::numeric_limits<double>::infinity();

    double nearest_ = kFar;  // the smallest t
    Id winner_ = kNone, rank_ = 0;
    LineHit hit_;
    bool contested_ = false;  // a triangle within the band of its time was turned away
    bool order_mattered_ = false;
};

}  // namespace trilens
