// Where an eye sees a point over one mirror after another, exactly: Newton's method on the eye's rays.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "base/raymesh/surface.h"
#include "intersect/limit_tracer.h"

namespace trilens {

/// A mirror as rays meet it; what is pointed to must live longer.
struct ChainMirror {
    const LimitTracer* tracer = nullptr;
    const Surface* surface = nullptr;
    bool own_normals = true;  // along du x dv; false where a normal field overrides them
};

/// Mirrors that an eye looks over, one after the other. Each is met as if it stood alone: nothing blocks the
/// way, but that a mirror is met where the ray meets it first.
struct MirrorChain {
    Vec3 eye{0};                       // world
    std::vector<ChainMirror> mirrors;  // one or more; a mirror may come again, but not twice in a row
};

/// A ray of the eye after the last mirror, and how it turns with the eye's.
struct ChainRay {
    Vec3 eye_direction{0};  // unit
    Ray ray;                // from the last mirror, unit
    Vec3 first{0};          // where it met the first mirror
    double first_way = 0;   // from the eye to there
    double way = 0;         // from the eye to the ray's origin
    // Derivatives of the ray by the angle that the eye's direction turns, in two directions at right angles
    // to it and to each other.
    std::array<Vec3, 2> turn{}, origin_along{}, direction_along{};

    /// The cube root of the solid angle that a bundle has at the eye over that on this ray (mathematics,
    /// section 6), within 1/50 and 50; 1 over flat mirrors.
    double ray_scale() const;
};

/// The ray that leaves the chain for a direction of the eye, any length; none where it misses a mirror.
std::optional<ChainRay> chain_ray(const MirrorChain& chain, const Vec3& eye_direction);

/// The eye's ray that the chain leads through `point` (world), by Newton's method from a direction near by;
/// none where the method ends elsewhere, or where the point lies behind the last mirror. Source: Fermat's
/// principle holds along every ray of the chain; the ray's distance from the point is what is driven to zero.
std::optional<ChainRay> image_over(const MirrorChain& chain, const Vec3& point, const Vec3& start);

// The images of a grid's points over a chain of mirrors: each found from its neighbour's.

/// Whether a ray of this direction may come to a facet from outside of the body that the grid bounds, by its
/// body_orientation(); true where it bounds none. From inside nothing is seen that stands outside.
inline bool may_face_outside(int orientation, const SurfaceGrid& grid, Id facet, const Vec3& direction) {
    return orientation == 0 || faces_front(grid, grid.facets[facet], direction) == (orientation > 0);
}

/// The eye's rays over the chain in these directions, but those that miss a mirror.
std::vector<ChainRay> rays_over(const MirrorChain& chain, std::span<const Vec3> towards);

/// Per point of the grid one image, where the search finds one: first from the ray of `starts` that passes it
/// at the smallest angle, then from point to point along facets. Where a point has several images, neighbours
/// have those that belong together. Of a grid that bounds a body points all of whose facets show their inside, and
/// that stand next to none that is not such, have none. The same for any number of threads.
std::vector<std::optional<ChainRay>> grid_images(const MirrorChain& chain, std::span<const ChainRay> starts,
                                                 const SurfaceGrid& grid);

}  // namespace trilens
