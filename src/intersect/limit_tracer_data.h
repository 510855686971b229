// What finds where rays meet one surface. Internal to this room.
#pragma once

#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/util/parallel.h"
#include "intersect/box_tree.h"
#include "intersect/convex_polyhedron.h"
#include "intersect/limit_tracer.h"
#include "intersect/part_tree.h"
#include "intersect/patch_tree.h"
#include "intersect/ray_patches.h"

namespace trilens {

struct LimitTracer::Data {
    static constexpr double kUnbounded = std::numeric_limits<double>::infinity();

    const Surface& surface;
    std::vector<RayPatch> patches;
    std::unique_ptr<PartPatches> by_part;  // else these, where the tree is one of parts
    double largest_patch = 0;              // of `patches`: none is longer along any ray, its stray included
    double size = 0;                       // half diagonal of a box about every face's corners and middle
    Box around;                            // holds every hit
    BoxTree tree;
    std::vector<Box> part_boxes;
    Lazy<PartTree> part_tree;  // once segments ask
    std::optional<ConvexPolyhedron> polyhedron = ConvexPolyhedron::of(surface);

    Data(const Surface& exact, const SurfaceGrid& fine, const std::string& isa);
    Data(const Surface& exact, const Parts& fine, const std::string& isa);

    const RayPatch& patch(Id number) const { return by_part ? by_part->patch(number) : patches[number]; }

    /// A patch that the ray may meet.
    struct Candidate {
        double t_near = 0, t_far = 0;  // it meets none before and none after these
        bool is_crossed = false;       // it goes through the facet itself
        bool is_met = false;           // it surely meets the patch, after t_near and before t_far
        Id patch = kNone;
        Vec3 weights{0};                              // of the facet's point nearest to the ray
        int nearest_corner = 0, farthest_corner = 0;  // along the ray
    };

    /// Candidates from near to far, and up to which t_near all of them are there.
    struct Candidates {
        std::vector<Candidate> found;
        double complete_to = kUnbounded;
    };

    /// Which candidates are looked for: all, or those that may come before the first facet that the ray goes
    /// straight through, behind which it seldom goes on without a hit; or all before some t, or only one that
    /// is surely met before it.
    enum class Reach { kToFirst, kAll, kAnyBefore };

    /// What is met so far behind t, at most, is met at the same place.
    static double tie_behind(const RayFrame& frame, double t, double cosine);
    /// Whether the one is met before the other: of two at the same place the one whose turn it is (see
    /// first_hit), whichever is nearer by rounding.
    static bool is_met_before(const RayFrame& frame, const SurfaceHit& one, const SurfaceHit& other);
    static std::optional<Candidate> candidate(const RayFrame& frame, const RayPatch& patch, double t_min);
    struct Query {
        const Ray& ray;
        const RayFrame& frame;
        double t_min = 0, t_max = kUnbounded;

        RayStretch stretch() const {
            return {frame.origin, frame.z, t_min * frame.speed, t_max * frame.speed};
        }
        /// Whether the candidate's patch is surely met on the way.
        bool surely_meets(const Candidate& one) const {
            return one.is_met && one.t_near > t_min && one.t_far < t_max;
        }
    };
    Candidates candidates(const Query& query, Reach reach) const;
    bool meets(const Ray& ray, double t_min, double t_max, Id& blocker) const;
    bool meets_some(const Query& query, std::span<const Candidate> candidates) const;
    bool meets_parts(const Query& query, std::span<const PartTree::Open> parts) const;
    Segments::Bits find_occluded(const Segments& segments, Segments::Bits asked) const;
    template <typename Use>
    void for_each_hit(const Ray& ray, const RayFrame& frame, const Candidate& candidate, Use&& use) const;
};

}  // namespace trilens
