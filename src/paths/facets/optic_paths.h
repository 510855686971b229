// The paths over one optic's facets as data: a tree of parts, and a RayMesh for each history.
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "base/raymesh/ray_mesh.h"
#include "paths/facets/probe_plan.h"
#include "paths/trace/follow.h"

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

}  // namespace trilens
