// Where world points appear: directly, and by every optic; first through its facets, then on the exact
// surface.
#pragma once

#include <span>
#include <vector>

#include "cli/world.h"

namespace trilens {

enum class LightPath { kDirect, kReflect, kRefract };

/// One place where a point appears.
struct WorldImage {
    LightPath path = LightPath::kDirect;
    Id optic = kNone;      // index into World::optics; none for the direct path
    Id facet = kNone;      // of the optic's grid (of the camera's mesh for a rayMesh camera)
    Vec2 pixel{0};         // from the film's top left; a pixel's centre is at .5
    double t = 0;          // along the last ray, in units of its direction (direct: depth)
    double length = 0;     // the same in scene units
    bool inside = false;   // on the film
    bool visible = false;  // nothing lies between the eye, the optic and the point
    bool refined = false;  // on the exact surface; else the facets' image
};

struct ProjectRequest {
    std::size_t camera = 0;
    bool refine = true;
    bool visibility = true;  // else `visible` stays false
};

/// All images of every point, through all facets of all optics (thesis chapter 3), each then refined on the
/// exact surface by Newton where there is an exact image near it. Images that the optic itself hides from the
/// camera (the back of a closed body) are left out. Exact images that no facet has are not looked for: raise
/// the resolution.
std::vector<std::vector<WorldImage>> project_points(const World& world, const ProjectRequest& request,
                                                    std::span<const Vec3> points);

}  // namespace trilens
