#include "render/engines/history_keys.h"

#include "base/util/parallel.h"
#include "render/engines/history_drawer.h"

namespace trilens {
namespace {

/// How a path fares whose end lies within bounds: it ends at what it sees, it goes on to the next optic, or
/// the bounds do not tell.
enum class Fate : std::uint8_t { kEnds, kGoesOn, kUnknown };

Fate fate_before_next(const Visible& seen, double next, bool touches) {
    if (!seen.seen()) return Fate::kGoesOn;
    if (seen.t_high <= next * (1 + kTouch)) return Fate::kEnds;
    if (touches) return seen.t_high <= next * (1 + kNearTouch) ? Fate::kEnds : Fate::kUnknown;
    return seen.t_low > next * (1 + kTouch) ? Fate::kGoesOn : Fate::kUnknown;
}

}  // namespace

std::vector<Id> owners_of_node(const PathNode& node, const std::vector<Id>& leaf,
                               std::span<const char> came) {
    std::vector<Id> owner(leaf.size(), kNone);
    if (node.parent != kNone && came.empty()) return owner;
    Id of_leaf = kNone, facet = kNone;  // the sample's before
    for (std::size_t s = 0; s < owner.size(); ++s) {
        if (leaf[s] == kNone || (node.parent != kNone && !came[s])) continue;
        if (leaf[s] != of_leaf) {
            of_leaf = leaf[s];
            facet = node.facet_of(of_leaf);
        }
        owner[s] = facet;
    }
    return owner;
}

void HistoryKeys::join_facet(Id index, std::size_t facet, std::span<const Id> samples,
                             std::span<FragmentKey> keys) {
    const PathNode& node = drawn_.paths.nodes[index];
    const FacetWeights weights = facet_weights(node.mesh, facet);
    if (weights.edge_on) return;
    const IdTriple& corner = node.mesh.facets[facet];
    for (const Id s : samples) {
        if (keys[s] == kAlone) continue;
        Fate fate = Fate::kEnds;
        if (!node.ends[facet]) {
            const Vec2 at = drawn_.grid.position(s);
            const Vec3 e = weights.unnormalised(at.x, at.y), share = e / (e.x + e.y + e.z);
            double next = 0;
            for (int k = 0; k < 3; ++k) next += share[k] * node.next[corner[static_cast<std::size_t>(k)]];
            fate = fate_before_next(visible_[s], next, node.touches[facet]);
        }
        if (fate == Fate::kEnds)
            keys[s] = joined(keys[s], index, visible_[s].triangle);
        else if (fate == Fate::kUnknown)
            keys[s] = kAlone;
        else
            goes_on_[index][s] = 1;
    }
}

void HistoryKeys::join(const PreparedScene& objects, Id index, std::span<FragmentKey> keys) {
    const PathNode& node = drawn_.paths.nodes[index];
    const std::span<const char> came =
        node.parent == kNone ? std::span<const char>() : std::span<const char>(goes_on_[node.parent]);
    const FacetSamples owned =
        group_by_facet(owners_of_node(node, drawn_.leaf, came), node.mesh.facets.size());
    if (owned.sample.empty()) return;
    visible_.assign(drawn_.grid.size(), Visible());
    find_visible(objects, node.mesh, owned, drawn_.grid, visible_);
    goes_on_[index].assign(drawn_.grid.size(), 0);
    parallel_for(node.mesh.facets.size(), 64, [&](std::size_t from, std::size_t to) {
        for (std::size_t f = from; f < to; ++f)
            if (!owned.of(f).empty()) join_facet(index, f, owned.of(f), keys);
    });
}

}  // namespace trilens
