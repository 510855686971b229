// The state of PathBuilder, and the steps that work on it.
#pragma once

#include <array>
#include <map>
#include <memory>
#include <span>
#include <tuple>
#include <unordered_map>
#include <vector>

#include "paths/facets/divide_facet.h"
#include "paths/facets/fit_nodes.h"
#include "paths/facets/optic_paths.h"

namespace trilens {

/// What the paths are built of; nothing of it changes once it is set.
struct PathInputs {
    ProbeContext context;
    const SurfaceGrid* grid = nullptr;  // null on the film
    DivideParams params;
    std::vector<Vec3> incident;  // per corner of the grid: the camera's ray there
    std::vector<Place> places;   // per corner; on the film the point alone: the facet's
    bool ends_first = false;     // paths end after the first optic: all is known from the beginning
};

/// What was probed, kept for facets that are asked for later.
struct PathCaches {
    std::vector<std::unique_ptr<PathProbe>> corner_probes;  // per grid corner and side, where asked for
    std::unordered_map<Id, std::unique_ptr<DividedFacet>> surveyed;  // facets of the survey, until asked for
    std::map<std::tuple<Id, Id, Event, Colours, Id>, Id> node_by_step;
    std::vector<std::unordered_map<Id, Id>> corner_of_node;  // per node: shared corner -> corner of its mesh
    std::vector<Id> leaf_cell;                               // per leaf
};

/// Which facets are worked out, and what is decided of all.
struct PathProgress {
    std::vector<char> prepared;         // one per facet
    std::vector<char> fitted;           // one per facet: with those all around
    std::vector<char> has_room;         // one per facet, once they are counted
    std::array<bool, 2> side_fitted{};  // back, front
    bool is_surveyed = false;
};

struct PathBuild {
    PathInputs in;
    OpticPaths out;
    PathCaches caches;
    PathProgress progress;
};

// Facets and their corners.

bool shows_front(const PathBuild& build, Id facet);
std::array<Vec3, 3> screen_corners(const OpticPaths& paths, Id facet);
bool is_on_film(const PathBuild& build, Id facet);
/// Whether the camera's ray through a corner of the grid comes to it: neither an optic nor an object is in
/// its way.
bool is_in_sight(const PathBuild& build, Id corner);
/// Probes the corners of these facets that were not probed before.
void probe_corners(PathBuild& build, std::span<const Id> facets);
/// At the corners of those parts alone that need it: see append_facet().
void set_ray_scales(const PathInputs& in, std::span<const DividedFacet> divided);
FacetToDivide facet_to_divide(const PathBuild& build, Id facet);

// Which facets are worked out.

/// Those of `facets` that are not known, and those that are fitted with them: these first, for a fit's sums
/// must not depend on what else is asked for; each ascending.
std::vector<Id> wanted_facets(PathBuild& build, std::span<const Id> facets);
/// Which facets' paths there is room for, by what the probes at some corners take: the same whatever is asked
/// for first. A facet has four probes of its own and half a corner.
void keep_room(PathBuild& build);
/// Probes some facets, the same whatever is asked for first, and makes the plan for all others: a survey
/// (systematic sample) of what probing all of them is likely to bring.
void survey_facets(PathBuild& build);
/// Whether a facet is probed at all.
bool is_worth_probing(const PathBuild& build, Id facet);

// Parts become leaves, and their histories nodes.

/// Cell 0 of `divided` becomes `cell`, the others stand at the end.
void append_facet(PathBuild& build, Id facet, Id cell, DividedFacet& divided);
/// The node of a step after `parent` (kNone: the first), made if there is none.
Id node_of(PathBuild& build, Id parent, const PathSegment& segment);
/// Whether a leaf's corner rays are fitted for itself and not with those all around.
bool fits_alone(const PathBuild& build, Id leaf);
/// Divides leaves until what they show is predicted to lie where the exact paths show it.
void divide_by_error(PathBuild& build, std::span<const FittedLeaf> open);

}  // namespace trilens
