// What depends on a picture's camera and resolution: the camera's rays, and optics as facets that it sees.
#pragma once

#include <memory>
#include <vector>

#include "paths/facets/path_builder.h"
#include "paths/first/corner_rays.h"
#include "paths/nested/nested_optics.h"
#include "render/frame/camera_media.h"
#include "render/frame/camera_rays.h"
#include "render/frame/film_grid.h"
#include "render/frame/request.h"
#include "render/world/geometry.h"
#include "render/world/world.h"

namespace trilens {

/// One optic as facets that the camera sees. Facets of the RayMeshes are those of the grid, or, where there
/// is a film_grid, of that.
struct FramedOptic {
    std::shared_ptr<const OpticFacets> facets;
    int resolution = 0;
    GridKind grid = GridKind::kSurface;  // where its facets for whole paths lie
    std::vector<PathMesh> paths;  // those that the scene draws and the optic has, up to the first optic
    std::shared_ptr<const FilmGrid> film_grid;  // of a camera that is not linear
    std::shared_ptr<const CameraModel> model;   // that camera's

    /// The RayMeshes' facet by which the film shows facet f of the grid at that place; kNone: none does.
    Id mesh_facet(Id f, const Vec2& at) const { return film_grid ? film_grid->facet_at(f, at, *model) : f; }
    /// The grid's facet that a facet of the RayMeshes is.
    Id grid_facet(Id f) const { return film_grid ? film_grid->original[f] : f; }
    CornerRays rays = CornerRays::kInterpolated;
    bool layered = false;  // optics seen in it are nested optics where they can be
};

struct Frame {
    CameraRays camera;
    CameraMedia camera_media;         // of the camera
    std::vector<FramedOptic> optics;  // as World::optics
    double max_error = 0;             // as RenderSettings, or kAnyError
    FacetUse facets = FacetUse::kAll;
    bool fit_all = false;  // see DivideParams; for lines that run on from facet to facet
};

/// Throws InputError where the optics together have too many facets to hold, or the camera cannot show them.
Frame make_frame(const World& world, const FrameParams& params, const Warn& warn);

/// The same for a camera's rays that no scene describes; FrameParams::camera is not asked.
Frame make_frame(const World& world, CameraRays camera, const FrameParams& params, const Warn& warn);

/// The rays that an optic's corners are asked to have.
CornerRays optic_rays(const World& world, std::size_t optic, const FrameParams& params);

/// The camera as facets ask it. `camera` must live longer. `depth`: of a camera that is not linear, about how
/// far what it looks at is.
PathCamera path_camera(const LinearCamera& camera);
PathCamera path_camera(const CameraRays& camera, double depth);

/// The paths over an optic's facets, as far as the scene has them followed, or `followed`, another
/// path_world. The frame must live longer, and `nested optics`: what is seen in the optic as nested optics;
/// null: nothing.
PathBuilder make_optic_paths(const World& world, const Frame& frame, std::size_t optic,
                             const NestedOptics* nested = nullptr, const PathWorld* followed = nullptr);

/// What all nested optics of this camera have in common; none where it has no eye in air.
std::optional<NestedStage> make_nested_stage(const World& world, const Frame& frame);

/// What is seen in an optic, as nested optics; null where it has none: it is glass, or alone, its facets lie
/// on the film, an error is asked for, or it is not to have them. `stage` must live longer.
std::unique_ptr<NestedOptics> make_nested_optics(const World& world, const Frame& frame,
                                                 const NestedStage& stage, std::size_t optic);

/// The paths as one of the usual approximations has them: kEnvironment or kPlanar.
PathBuilder make_approximate_paths(const World& world, const Frame& frame, std::size_t optic, Engine engine);

/// The mesh of this path, or null.
const RayMesh* find_path(const FramedOptic& optic, Path path);

/// Throws UsageError for a camera that the scene does not have, a resolution beyond 1..1024 (0: none is asked
/// for), or a largest error beyond 0..kMostMaxError.
void check_frame(const World& world, const FrameParams& frame);

}  // namespace trilens
