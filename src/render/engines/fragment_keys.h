// Visibility of one history after the other, as keys of fragments.
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "base/raymesh/sample_grid.h"
#include "paths/facets/optic_paths.h"
#include "paths/nested/nested_optics.h"
#include "projector/projector.h"
#include "render/engines/rim_samples.h"
#include "render/frame/frame.h"
#include "render/frame/views.h"
#include "render/world/world.h"

namespace trilens {

/// What histories are drawn of; all must live longer.
struct DrawnSamples {
    const OpticPaths& paths;
    const SampleGrid& grid;
    const std::vector<Id>& leaf;  // per sample; kNone: it is not drawn
};

/// How a path fares whose end lies within bounds: it ends at what it sees, it goes on to the next optic, or
/// the bounds do not tell.
enum class Fate : std::uint8_t { kEnds, kGoesOn, kUnknown };

/// `next`: t of the next optic.
Fate fate_before_next(const Visible& seen, double next, bool touches);

/// What is seen first of all surfaces: the optic and its facet, or (kNone) an object's triangle.
struct FirstSeen {
    Visible seen;
    Id optic = kNone;
};

/// Whether the one is surely nearer.
bool surely_before(const Visible& one, const Visible& other);

/// Per sample the node's facet, if its path came as far as this node. `came`: per sample, whether its path
/// goes on from the node's parent; empty: none does. Not asked where the node has no parent.
std::vector<Id> owners_of_node(const PathNode& node, const std::vector<Id>& leaf, std::span<const char> came);

/// Finds what each sample sees at the end of each history, by bounds of where that lies.
class HistoryKeys {
  public:
    explicit HistoryKeys(const DrawnSamples& drawn) : drawn_(drawn), goes_on_(drawn.paths.nodes.size()) {}

    /// Joins the node and what is seen to the keys of the samples that end there; of samples for which bounds
    /// do not tell, kAlone. Parents first.
    void join(const PreparedScene& objects, Id node, std::span<FragmentKey> keys);

  private:
    void join_facet(Id node, std::size_t facet, std::span<const Id> samples, std::span<FragmentKey> keys);

    const DrawnSamples drawn_;
    std::vector<std::vector<char>> goes_on_;  // per node and sample
    std::vector<Visible> visible_;            // per sample, of the node
};

// Visibility of many samples without their records: which triangles they see by which histories, as keys.
// After: Burns and Hunt, The Visibility Buffer: A Cache-Friendly Approach to Deferred Shading, JCGT 2013.

/// What a facet viewer of a projecting engine is made of.
struct FragmentKeysParams {
    const World& world;
    const Frame& frame;
    const std::vector<SampleGrid>& windows;                    // where each optic may be seen
    std::vector<PathBuilder>& paths;                           // per optic
    const std::vector<std::unique_ptr<NestedOptics>>& nested;  // per optic; null: it has none
    const OpticRims& rims;
};

/// The key of every pixel of the grid's window, in rows: what find_fragment_keys() gives for all its samples,
/// where that is surely one; else kAlone. `grid`: with all its samples, several in a pixel. Works out facets
/// as find_fragment_keys() does.
void find_pixel_keys(const FragmentKeysParams& params, const SampleGrid& grid, std::span<FragmentKey> keys);

/// The key of every sample of the grid: fragment_key() of the view that the exact projector's viewer has of
/// it, or kAlone where bounds do not decide it, or its paths are traced or lead over nested optics. Works out
/// the facets that are seen and were not before. `grid`: in lattice order.
void find_fragment_keys(const FragmentKeysParams& params, const SampleGrid& grid,
                        std::span<FragmentKey> keys);

}  // namespace trilens
