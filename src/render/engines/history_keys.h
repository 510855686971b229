// Visibility of one history after the other, as keys of fragments.
#pragma once

#include <span>
#include <vector>

#include "base/raymesh/sample_grid.h"
#include "paths/facets/optic_paths.h"
#include "projector/projector.h"
#include "render/frame/fragment_key.h"

namespace trilens {

/// What histories are drawn of; all must live longer.
struct DrawnSamples {
    const OpticPaths& paths;
    const SampleGrid& grid;
    const std::vector<Id>& leaf;  // per sample; kNone: it is not drawn
};

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

}  // namespace trilens
