// Which facets, and which parts of them, are worth probing: optimal stopping over their quadtree by
// dynamic programming (Bellman), in samples of the film.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <span>
#include <vector>

#include "base/raymesh/ray_mesh.h"
#include "paths/probe/path_probe.h"
#include "paths/trace/follow.h"

namespace trilens {

/// What probing facets costs and saves. The unit is following the paths of one sample: that takes as much
/// of a scene's own time as probing one point of a facet does, whatever the scene, so these are constants.
/// Measured, as docs/speed.md tells.
struct ProbeCosts {
    double corner = 1;   // a facet's share of the probes at the grid's corners
    double middle = 2;   // probes at the middles of a part's edges, its principal paths alone
    double inside = 10;  // all paths there and at the centre, the proof, the corner rays, the prediction
    double saved = 0.7;  // by each sample that is projected instead

    /// `per_pixel`: samples of a pixel; from two on what they see is shaded by fragments. `closed_form`: the
    /// optic is met in closed form, for less than proofs take.
    static ProbeCosts of(double per_pixel, bool closed_form);
};

/// Of the parts of facets on each level that were probed.
struct ProbeTally {
    static constexpr int kLevels = 8;  // deeper ones count with the last
    struct Level {
        std::size_t parts = 0;      // that are on the film
        std::size_t agree = 0;      // of them: may be projected, by their corners' principal paths
        std::size_t probed = 0;     // of these: were probed
        std::size_t projected = 0;  // of these: are projected
    };
    std::array<Level, kLevels> level{};

    Level& at(int depth) { return level[static_cast<std::size_t>(depth < kLevels ? depth : kLevels - 1)]; }
    void add(const ProbeTally& other);
};

/// Decides for one optic, by what was found at some of its facets.
class ProbePlan {
  public:
    /// All parts are probed.
    ProbePlan() = default;
    /// `per_pixel`: samples in a square pixel, > 0.
    ProbePlan(double per_pixel, const ProbeCosts& costs, const ProbeTally& survey);

    bool decides() const { return per_pixel_ > 0; }
    /// Samples in that many square pixels.
    double samples_in(double area) const;

    /// Whether a whole facet with so many samples is worth the probes at its corners.
    bool is_worth_corners(double samples) const;
    /// Whether a part whose corners agree is worth the probes inside.
    bool is_worth_inside(int level, double samples) const;
    /// Whether a part that is not projected is worth dividing. `probed`: it was.
    bool is_worth_dividing(int level, double samples, bool probed) const;

    /// The fewest samples of a facet whose corners are probed; infinite where none is worth it.
    double least_samples() const;

    const ProbeCosts& costs() const { return costs_; }

  private:
    struct Share {
        double agree = 1, projected = 1;
    };
    const Share& share(int level) const;
    double parts(int level, double samples) const;
    double inside(int level, double samples, double of_parts) const;
    double part(int level, double samples) const;

    double per_pixel_ = 0;  // 0: all parts are probed
    ProbeCosts costs_;
    std::array<Share, ProbeTally::kLevels> share_{};
};

// The paths over one optic's facets as data: a tree of parts, and a RayMesh for each history.

/// How a part of a facet is drawn: its corners' rays stand for all between them, or each sample's own rays
/// are followed.
enum class LeafMethod : std::uint8_t { kProjected, kTraced };

/// A part of a facet: the facet itself (level 0) or one of four parts of a part.
struct PathLeaf {
    Id facet = kNone;
    std::uint8_t level = 0;
    LeafMethod method = LeafMethod::kProjected;
    Vec3 centre{0};        // of kTraced: homogeneous screen position
    double predicted = 0;  // of kProjected: displacement in pixels, where an error is asked for
    bool layered = false;  // of kProjected: optics seen in this one lie over it as nested optics
    // Of kProjected: the most of each colour's light behind the first optic that no node carries, at any of
    // its corners: paths too faint to be followed, or so faint at the others that none stands for them.
    Vec3 faint{0};
    // The most of each colour's light, at any of its corners, that would go on after the last optic followed.
    Vec3 too_deep{0};
};

/// All rays of one history: its last step starts them.
struct PathNode {
    Id parent = kNone;  // of OpticPaths::nodes
    Step step;
    Path path = Path::kReflect;
    Colours colours = kAllColours;
    Id medium = kNone;
    std::uint16_t step_count = 1;
    bool unfolds = true;     // all steps are reflections, or pass, and the camera has an eye: see farther
    RayMesh mesh;            // a facet for each leaf that has the history
    std::vector<Id> leaves;  // per facet of the mesh: its leaf, ascending
    std::vector<char> ends;  // per facet: no other optic follows
    std::vector<char> principal;  // per facet: see PathSegment
    std::vector<char> touches;    // per facet: an object lies on the next optic, at its middle
    std::vector<char> rests;      // per facet: see rests_on_object
    std::vector<char> to_mirror;  // per facet: see PathSegment
    std::vector<char> has_start;  // per facet: see PathSegment
    std::vector<double> next;     // per corner: t of the next optic; infinity: none
    std::vector<Vec3> weight;     // per corner: see PathSegment::weight
    // Per corner: by how much its screen position is longer than the camera's, see farther() in path_probe.h;
    // empty: all are 1.
    std::vector<double> farther;

    /// The mesh's facet over a leaf; kNone: no rays of this history are there.
    Id facet_of(Id leaf) const;
};

/// A facet, or a part of one: it has four parts, or is a leaf.
struct PathCell {
    Id children = kNone;  // the first of four, of OpticPaths::cells
    Id leaf = kNone;      // of OpticPaths::leaves
};

/// How it was decided which facets are probed.
struct ProbeReport {
    std::size_t surveyed = 0;  // facets probed first
    ProbePlan plan;
    std::size_t not_worth = 0;  // facets, of those asked for, that are traced for what probes cost
};

/// A window of the film, in pixels, and how finely it is cut.
struct FilmWindow {
    Vec2 low{0}, high{0};
    int n = 0;         // squares along each side
    double depth = 1;  // about how far the surface is, along the view axis
    double reach = 0;  // the size of the surface, world units
};

/// What is known of the paths over one optic's facets for one camera; PathBuilder adds to it.
struct OpticPaths {
    std::vector<PathLeaf> leaves;
    std::vector<PathNode> nodes;
    std::vector<PathCell> cells;      // one per facet, then parts
    RayMesh outline;                  // the facets on the screen; its rays are not set
    FilmWindow window;                // of facets on the film; n = 0: they are a grid's
    CutPaths cut;                     // the most that was left out at any point probed
    std::size_t projected_count = 0;  // leaves that are projected, of the facets worked out
    std::size_t crowded_out = 0;      // facets that are traced for want of room (DivideParams::most_bytes)
    ProbeReport probe_report;

    bool is_on_film() const { return window.n > 0; }
    /// Whether the whole of a facet that is worked out is one leaf.
    bool is_whole(Id facet) const { return cells[facet].children == kNone; }
};

/// The leaf of a facet that is worked out for a point with these weights of the facet's corners.
Id leaf_at(const OpticPaths& paths, Id facet, const Vec3& weights);

/// The facet of the film at a place within the window; places outside count as on its border.
Id film_facet(const FilmWindow& window, const Vec2& pixel);

/// The nodes with parents before children, in an order that histories alone decide.
std::vector<Id> nodes_in_order(const OpticPaths& paths);

// Builds the paths over one optic's facets, facet by facet as they are asked for.

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
    // Samples in a square pixel, where facets and parts are probed that are worth it (above); 0:
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
