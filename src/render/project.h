// Where world points appear: directly, and by every optic on the exact surface.
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

/// All images of one point.
struct PointProjection {
    std::vector<WorldImage> images;
    bool complete = false;  // proven: no optic has another one
};

/// kComplete: every part of the exact surfaces is searched or excluded. kFacets: images through the facets
/// are starting points of Newton's method, so that images which no facet has are missed; several times
/// faster.
enum class ImageSearch { kComplete, kFacets };

struct ProjectRequest {
    FrameParams frame;
    ImageSearch search = ImageSearch::kComplete;
    bool refine = true;      // kFacets: else images are left as the facets have them
    bool visibility = true;  // else `visible` stays false
};

/// The images of every point: direct, and after one event at each optic. Images that the optic itself hides
/// from the camera (the back of a closed body) are left out. A list that is not complete (points near a
/// caustic, overridden normals, kFacets) holds what the facets lead to as well.
std::vector<PointProjection> project_points(const World& world, const ProjectRequest& request,
                                            std::span<const Vec3> points);

}  // namespace trilens
