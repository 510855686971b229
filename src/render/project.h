// Where world points appear: directly, and by every optic; first through its facets, then on the exact
// surface.
#pragma once

#include <span>
#include <vector>

#include "base/vec.h"
#include "paths/path.h"
#include "render/request.h"

namespace trilens {

struct World;

/// One place where a point appears.
struct WorldImage {
    Path path = Path::kDirect;
    Id optic = kNone;      // which of the scene's optics, counted in scene order; none for the direct path
    Id object = kNone;     // its index in Scene::meshes
    Id facet = kNone;      // of the optic's grid (of the camera's mesh for a rayMesh camera)
    Vec2 pixel{0};         // from the film's top left; a pixel's centre is at .5
    double t = 0;          // along the last ray, in units of its direction (direct: depth)
    double length = 0;     // the same in scene units
    bool inside = false;   // on the film
    bool visible = false;  // nothing lies between the eye, the optic and the point
    bool refined = false;  // on the exact surface; else the facets' image
};

struct ProjectRequest {
    FrameParams frame;
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
