// What depends on a picture's camera and resolution: the camera's rays, and the RayMeshes that leave the
// optics.
#pragma once

#include <memory>
#include <vector>

#include "paths/corner_rays.h"
#include "render/camera_rays.h"
#include "render/film_grid.h"
#include "render/geometry.h"
#include "render/request.h"

namespace trilens {

/// One optic as facets that the camera sees. Facets of the RayMeshes are those of the grid, or, where there
/// is a film_grid, of that.
struct FramedOptic {
    std::shared_ptr<const OpticFacets> facets;
    std::vector<PathMesh> paths;                // those that the scene draws and the optic has
    std::shared_ptr<const FilmGrid> film_grid;  // of a camera that is not linear
    std::shared_ptr<const CameraModel> model;   // that camera's

    /// The RayMeshes' facet by which the film shows facet f of the grid at that place; kNone: none does.
    Id mesh_facet(Id f, const Vec2& at) const { return film_grid ? film_grid->facet_at(f, at, *model) : f; }
    /// The grid's facet that a facet of the RayMeshes is.
    Id grid_facet(Id f) const { return film_grid ? film_grid->original[f] : f; }
};

struct Frame {
    CameraRays camera;
    std::vector<FramedOptic> optics;  // as World::optics
};

/// Throws InputError where the optics together have too many facets to hold, or the camera cannot show them.
Frame make_frame(const World& world, const FrameParams& params, const Warn& warn);

/// The same for a camera's rays that no scene describes; `resolution` as in FrameParams.
Frame make_frame(const World& world, CameraRays camera, int resolution, const Warn& warn);

/// The mesh of this path, or null.
const RayMesh* find_path(const FramedOptic& optic, Path path);

}  // namespace trilens
