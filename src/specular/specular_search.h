// Finds all reflections or refractions of a point; reports whether the list is proven complete.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "base/raymesh/surface.h"
#include "specular/cell_bvh.h"
#include "specular/specular_point.h"

namespace trilens {

struct SearchLimits {
    double smallest_cell = 0x1p-20;    // side of the smallest cells, in a face's parameters; > 0
    std::size_t most_cells = 100'000;  // looked at for one query; the rest is then undecided
    int starts = 8;         // surfaces without bounds: refined from regular_starts(surface, starts), >= 1
    bool asks_rays = true;  // what a surface hides of itself is asked of rays, which pays with many points

    bool operator==(const SearchLimits&) const = default;
};

/// What a search found.
struct SpecularSearch {
    std::vector<SpecularPoint> images;  // each once, by ascending t
    bool complete = false;              // proven: there are no others
    std::size_t cells = 0;              // looked at
    std::size_t undecided = 0;  // of them neither excluded nor proven to hold one zero of the law at most
};

/// Searches one surface for the images of many points. Thread-safe to read; the surface must live longer.
///
/// A branch and bound search over the faces' parameters. Cells whose bounds allow no image are excluded; one
/// where interval Newton proves at most one zero of the law is settled by Newton's method; others are halved.
/// Cells that are undecided at the smallest size make the list incomplete: points on a caustic (where two
/// images merge, so that no cell has one zero), points or eyes on the surface itself, images within the last
/// 2^-10 of a face around an extraordinary vertex. Images that refining finds from undecided cells are
/// listed, too. "Proven" is up to rounding: radii hold the rounding of evaluation, but the arithmetic on them
/// does not round outward.
///
/// Surfaces that give no bounds and queries with overridden normals are searched from regular starts, of
/// overridden normals on the faces that NormalCones does not exclude; such a list is never complete.
class SpecularSearcher {
  public:
    /// With `first_hit`, of rays with the surface, what a closed surface surely hides from the query's eye is
    /// not searched: images there are not listed, and leave no list incomplete.
    explicit SpecularSearcher(const Surface& surface, Occluder first_hit = {});
    ~SpecularSearcher();

    /// The images that the query asks for, with the query's indices for both sides of the surface.
    SpecularSearch find(const SpecularQuery& query, const SearchLimits& limits = {}) const;

    /// Refraction into or out of a body: a camera that sees the surface's front lies in the medium
    /// `eye_index` and the point in `point_index`; one that sees its back, inside the body, the other way
    /// round. Both sides are searched and the images of both listed: which of them the body itself hides is
    /// for a tracer to say, as for any occlusion.
    SpecularSearch find_in_body(const SpecularQuery& query, const SearchLimits& limits = {}) const;

    /// For each of `points` what find (find_in_body) lists for the query with that point, and whether it is
    /// complete: the same images to the last bit, in the time of a few where the points lie close together.
    /// What the points have in common is excluded once, and each search begins where its neighbour's ended;
    /// `cells` counts what was looked at for the point alone.
    std::vector<SpecularSearch> find_each(const SpecularQuery& query, std::span<const Vec3> points,
                                          const SearchLimits& limits = {}) const;
    std::vector<SpecularSearch> find_each_in_body(const SpecularQuery& query, std::span<const Vec3> points,
                                                  const SearchLimits& limits = {}) const;

  private:
    struct Impl;
    const std::unique_ptr<Impl> impl_;
};

}  // namespace trilens
