// Builds the paths over one optic's facets, facet by facet as they are asked for.
#pragma once

#include <functional>
#include <limits>
#include <memory>
#include <span>

#include "base/raymesh/linear_camera.h"
#include "paths/facets/optic_paths.h"
#include "paths/probe/path_probe.h"

namespace trilens {

/// How finely facets are divided whose corners do not tell the truth about the rays between them.
struct DivideParams {
    double least_area = 8;  // square pixels: parts below this are traced
    double plain_area = 0;  // square pixels: of facets below this the corners alone are probed
    int most_levels = 6;
    // Pixels: parts whose predicted displacement is more are divided too; infinity: whatever it is.
    double max_error = std::numeric_limits<double>::infinity();
    bool estimates = true;  // few are: predicted only where an estimate says that they may be
    // About what the paths over one optic's facets may take: where all would take more, the last of them are
    // traced.
    std::size_t most_bytes = std::size_t{4} << 30;
    const Tracer* objects = nullptr;  // for the prediction: what is seen
    bool fit = false;                 // corner rays of whole facets are fitted
    bool fit_all = false;             // hidden ones among them, and those of less than a pixel
    // Of a mirror: whether a pixel from which the exact path goes on to optic `next` (kNone: to none) shows
    // that optic as nested. Facets on which it does are not divided. Unset: there are no nested optics.
    std::function<bool(const Vec2& pixel, Id next)> nested_agree = {};
    // Of a mirror with nested optics: whether that optic is drawn as a nested optic somewhere within these
    // bounds on the film, in pixels.
    std::function<bool(Id optic, const Vec2& low, const Vec2& high)> nested_covers = {};
    // Samples in a square pixel, where facets and parts are probed that are worth it (probe_plan.h); 0:
    // all are.
    double per_pixel = 0;
};

/// The paths over one optic up to that optic itself: their meshes, whose facets are the grid's, or null where
/// not asked for; and how the camera sees each corner. All must live while the paths are made; the grid
/// longer.
struct FirstPaths {
    const SurfaceGrid* grid = nullptr;
    std::span<const CornerView> views;
    const RayMesh* reflection = nullptr;
    const RayMesh* refraction = nullptr;
};

struct PathBuild;

/// Works out the paths over one optic's facets when they are first asked for.
///
/// A facet stands for the rays between its corners where the exact paths from its corners, the middles of its
/// edges and its centre have the same histories, and it is proven that all between them have those, too
/// (one_history.h); else it is divided on the screen, in four, and what is left at the smallest size is
/// traced. Parts of a facet lie on the facet's own plane, so no gaps open; a corner
/// ray of a part is the camera's exact ray through that point.
///
/// Fitted rays depend on the facets all around, so with DivideParams::fit the first facet of a side that is
/// asked for has all facets of that side worked out that are on the film, have a corner in sight and are not
/// smaller than a pixel: no crop changes them. Of the others those that are asked for are fitted alone, as
/// parts are.
class PathBuilder {
  public:
    explicit PathBuilder(std::unique_ptr<PathBuild> build);
    PathBuilder(PathBuilder&&) noexcept;
    PathBuilder& operator=(PathBuilder&&) noexcept;
    ~PathBuilder();

    /// Works out these facets, those that are known already among them. Same leaves, rays and histories
    /// whatever was asked before; only their numbers differ.
    void prepare(std::span<const Id> facets);

    /// What is known by now: the same object as long as the builder lives, wherever it is moved.
    const OpticPaths& paths() const;
    const ProbeContext& context() const;

  private:
    std::unique_ptr<PathBuild> build_;
};

/// The facets of a surface. `grid` must live longer.
PathBuilder paths_over_grid(ProbeContext context, const SurfaceGrid& grid, DivideParams params);

/// The same where it is known how the camera sees each corner of the grid. Facets with a corner of w = 0 have
/// no image and may not be asked for.
PathBuilder paths_over_views(ProbeContext context, const SurfaceGrid& grid, std::span<const CornerView> views,
                             DivideParams params);

/// Facets on the film instead (thesis 7.2.2): n x n squares of two facets each over a window, whose corner
/// rays are the camera's exact ones, whatever the surface. A sample's facet is then the one that it lies in:
/// film_facet().
PathBuilder paths_over_film(ProbeContext context, const FilmWindow& window, DivideParams params);

/// Paths that end after the first optic (thesis 7.2.1, 7.3.1). No exact ray is followed.
PathBuilder first_optic_paths(ProbeContext context, const FirstPaths& first);

}  // namespace trilens
