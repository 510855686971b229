// The RayMeshes that leave an optic: one for each history of the paths over it.
#pragma once

#include <array>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <span>
#include <tuple>
#include <unordered_map>
#include <vector>

#include "base/raymesh/linear_camera.h"
#include "base/raymesh/ray_mesh.h"
#include "paths/facets/probe_plan.h"
#include "paths/probe/path_probe.h"

namespace trilens {

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
    std::vector<double> next;     // per corner: t of the next optic; infinity: none
    std::vector<Vec3> weight;     // per corner: see PathSegment::weight
    // Per corner: by how much its screen position is longer than the camera's, see node_corner.h; empty: all
    // are 1.
    std::vector<double> farther;

    /// The mesh's facet over a leaf; kNone: no rays of this history are there.
    Id facet_of(Id leaf) const;
};

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

struct DividedFacet;
struct FacetPart;
struct FacetToDivide;
struct FittedLeaf;

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

/// The paths over one optic up to that optic itself: their meshes, whose facets are the grid's, or null where
/// not asked for; and how the camera sees each corner. All must live while the paths are made; the grid
/// longer.
struct FirstPaths {
    const SurfaceGrid* grid = nullptr;
    std::span<const CornerView> views;
    const RayMesh* reflection = nullptr;
    const RayMesh* refraction = nullptr;
};

/// The paths over one optic's facets for one camera. Facets are worked out when they are first asked for.
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
class OpticPaths {
  public:
    /// `grid` must live longer.
    OpticPaths(ProbeContext context, const SurfaceGrid& grid, DivideParams params);

    /// The same where it is known how the camera sees each corner of the grid. Facets with a corner of w = 0
    /// have no image and may not be asked for.
    OpticPaths(ProbeContext context, const SurfaceGrid& grid, std::span<const CornerView> views,
               DivideParams params);

    /// Facets on the film instead (thesis 7.2.2): n x n squares of two facets each over a window, whose
    /// corner rays are the camera's exact ones, whatever the surface. A sample's facet is then the one that
    /// it lies in: film_facet.
    OpticPaths(ProbeContext context, const FilmWindow& window, DivideParams params);

    /// The facet of the film at a place within the window; places outside count as on its border.
    Id film_facet(const Vec2& pixel) const;
    bool is_on_film() const { return window_.n > 0; }

    /// Paths that end after the first optic (thesis 7.2.1, 7.3.1). No exact ray is followed.
    OpticPaths(ProbeContext context, const FirstPaths& first);
    ~OpticPaths();

    /// Works out these facets, those that are known already among them. Same leaves, rays and histories
    /// whatever was asked before; only their numbers differ.
    void prepare(std::span<const Id> facets);

    /// The leaf of a prepared facet for a point with these weights of the facet's corners.
    Id leaf_at(Id facet, const Vec3& weights) const;
    /// Whether the whole of a prepared facet is one leaf, and which.
    bool is_whole(Id facet) const { return cells_[facet].children == kNone; }

    const std::vector<PathLeaf>& leaves() const { return leaves_; }
    const std::vector<PathNode>& nodes() const { return nodes_; }
    /// The nodes with parents before children, in an order that histories alone decide.
    std::vector<Id> nodes_in_order() const;
    /// The grid's facets on the screen; its rays are not set.
    const RayMesh& outline() const { return outline_; }
    /// The most that was left out at any point probed.
    const CutPaths& cut() const { return cut_; }
    /// Leaves that are projected, of the facets worked out.
    std::size_t projected_count() const { return projected_count_; }
    /// Facets that are traced for want of room (DivideParams::most_bytes).
    std::size_t crowded_out() const { return crowded_out_; }
    const ProbeReport& probe_report() const { return probe_report_; }
    const ProbeContext& context() const { return context_; }

  private:
    struct Cell {
        Id children = kNone;  // the first of four
        Id leaf = kNone;
    };
    void set_places(const SurfaceGrid& grid);
    bool shows_front(Id facet) const;
    std::array<Vec3, 3> screen_corners(Id facet) const;
    bool on_film(Id facet) const;
    bool is_in_sight(Id corner) const;
    std::vector<Id> fitted_together(bool front) const;
    std::vector<Id> wanted_facets(std::span<const Id> facets);
    void set_film_corner(Id corner, const Vec2& pixel);
    void probe_corners(std::span<const Id> facets);
    void set_ray_scales(std::span<const DividedFacet> divided) const;
    void append(Id facet, Id cell, DividedFacet& divided);
    bool fits_alone(Id leaf) const;
    void append_part(Id leaf, FacetPart& part);
    void keep_room();
    void survey();
    bool is_worth_probing(Id facet) const;
    FacetToDivide facet_to_divide(Id facet) const;
    void divide_by_error(std::span<const FittedLeaf> open);
    void divide_batch_by_error(std::vector<FittedLeaf> open);
    double predicted(const FittedLeaf& open) const;
    Id node_of(Id parent, const PathSegment& segment);
    bool touches_object(const FacetPart& part, std::size_t history) const;

    ProbeContext context_;
    const SurfaceGrid* grid_ = nullptr;  // null on the film
    FilmWindow window_;
    DivideParams params_;
    RayMesh outline_;
    std::vector<Vec3> incident_;  // per corner of the grid: the camera's ray there
    std::vector<Place> places_;   // per corner; on the film the point alone: the facet's
    std::vector<std::unique_ptr<PathProbe>> corner_probes_;  // per grid corner and side, where asked for
    std::vector<Cell> cells_;                                // one per facet, then parts
    std::vector<char> has_room_;                             // one per facet, once they are counted
    std::size_t crowded_out_ = 0;
    ProbeReport probe_report_;
    std::unordered_map<Id, std::unique_ptr<DividedFacet>> surveyed_;  // facets of the survey, until asked for
    bool is_surveyed_ = false;
    std::vector<char> prepared_;
    std::vector<char> fitted_;  // one per facet: with those all around
    std::vector<PathLeaf> leaves_;
    std::vector<PathNode> nodes_;
    std::map<std::tuple<Id, Id, Event, Colours, Id>, Id> node_by_step_;
    std::vector<std::unordered_map<Id, Id>> corner_of_node_;  // per node: shared corner -> corner of its mesh
    std::array<bool, 2> side_fitted_{};                       // back, front
    std::vector<Id> leaf_cell_;                               // per leaf
    bool ends_first_ = false;  // paths end after the first optic: all is known from the beginning
    std::size_t projected_count_ = 0;
    CutPaths cut_;
};

}  // namespace trilens
