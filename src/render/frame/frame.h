// Which facet of a grid holds a parameter position.
#pragma once

#include <atomic>
#include <cstddef>
#include <memory>
#include <vector>

#include "base/raymesh/ray_mesh.h"
#include "base/raymesh/surface.h"
#include "base/util/check.h"
#include "base/util/error.h"
#include "camera/model/camera_model.h"
#include "paths/facets/optic_paths.h"
#include "paths/first/corner_rays.h"
#include "paths/nested/nested_optics.h"
#include "render/frame/camera_rays.h"
#include "render/frame/request.h"
#include "render/world/world.h"

namespace trilens {

/// Every face's parameters in bins that know the facets which reach into them. The grid must live longer.
class FacetLookup {
  public:
    FacetLookup(const SurfaceGrid& grid, std::size_t faces);

    /// The first of the grid's facets that holds the position of the face; kNone where rounding leaves it in
    /// none.
    Id at(Id face, const Vec2& uv) const;

  private:
    struct FaceBins {
        std::size_t first = 0;  // of its side * side bins, row by row
        std::size_t side = 1;
    };
    template <typename Body>
    void for_each_bin(std::size_t facet, const Body& body) const;
    std::size_t cell_of(double x, const FaceBins& bins) const;

    const SurfaceGrid& grid_;
    std::vector<FaceBins> faces_;
    std::vector<std::size_t> begin_;  // per bin, and one more: into facets_
    std::vector<Id> facets_;          // ascending in each bin
};

// An optic's grid on the film of a camera that is not linear: where its facets appear, perhaps several times.

/// The grid's facets once for each place at which a branch of the camera shows them (twice where they lie
/// across a panorama's seam), with affine screens. Facets that no film place can show are left out.
struct FilmGrid {
    SurfaceGrid grid;               // facets in their places; points are those of the original
    std::vector<CornerView> views;  // per corner of `grid`
    std::vector<Id> original;       // per facet of `grid`: the facet it is
    std::vector<std::size_t> first,
        placed;                       // original facet f is at placed[first[f]] .. placed[first[f+1]-1]
    std::vector<std::size_t> branch;  // per facet of `grid`
    std::vector<Vec2> middle;         // likewise, pixels
    std::vector<double> reach;        // how far from its middle the film may show it, pixels
    std::size_t lost = 0;  // facets with a corner on the film and none to be placed: across a pole, or partly
                           // where the camera has no image

    /// The facet of `grid` by which the film shows original facet f at that place: the nearest of the branch
    /// that the film shows there; where that has none, the nearest of another that reaches so far (branches
    /// go on smoothly). kNone where none does.
    Id facet_at(Id f, const Vec2& at, const CameraModel& model) const;
};

FilmGrid make_film_grid(const SurfaceGrid& grid, const CameraModel& model, const FilmSize& film);

// What depends on a picture's camera and resolution: the camera's rays, and optics as facets that it sees.

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
    Id grid_facet(Id f) const {
        if (!film_grid) return f;
        TRILENS_CHECK(f < film_grid->original.size(), "a facet of the RayMeshes, not of the film");
        return film_grid->original[f];
    }
    CornerRays rays = CornerRays::kInterpolated;
    bool layered = false;  // optics seen in it are nested optics where they can be
};

struct Frame {
    CameraRays camera;
    CameraMedia camera_media;         // of the camera
    std::vector<FramedOptic> optics;  // as World::optics
    double max_error = 0;             // as RenderSettings, or kAnyError
    FacetUse facets = FacetUse::kAll;
    bool certify = false;                       // as FrameParams
    bool fit_all = false;                       // see DivideParams; for lines that run on from facet to facet
    const std::atomic<bool>* cancel = nullptr;  // Progress::cancel of what is drawn

    void stop_if_cancelled() const {
        if (cancel && cancel->load(std::memory_order_relaxed)) throw Interrupted();
    }
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

// Conservative screen bounds of an optic.

/// The pixels of the film that the optic's facets may cover. All of them where its corners do not say: the
/// camera is not linear, or some lie behind it.
SampleGrid optic_window(const FramedOptic& optic, const CameraRays& camera);

/// The part of a grid in a window's pixels, with the grid's own samples; of size 0 where they share none.
SampleGrid part_in(const SampleGrid& grid, const SampleGrid& window);

}  // namespace trilens
