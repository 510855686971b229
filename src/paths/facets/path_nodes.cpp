// Parts of facets become leaves, and their histories nodes with the rays of their corners.
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

#include "paths/facets/divide_facet.h"
#include "paths/facets/facet_paths.h"
#include "paths/facets/node_corner.h"
#include "paths/facets/one_history.h"

namespace trilens {
namespace {

/// What a part's histories leave out of the light behind the first optic. Nested optics have their own.
Vec3 faint_light(const FacetPart& part) {
    Vec3 most(0);
    if (part.method != LeafMethod::kProjected || part.layered) return most;
    for (std::size_t k = 0; k < 3; ++k) {
        if (part.segment[k].empty()) continue;
        const PathProbe& probe = *part.corners[k].probe;
        std::vector<char> carried(probe.segments.size(), 0);
        for (const std::size_t s : part.segment[k]) carried[s] = 1;
        std::array<Vec3, 2> left{probe.cut.faint_behind, probe.cut.faint_behind};  // by the first event
        for (std::size_t s = 0; s < probe.segments.size(); ++s) {
            const PathSegment& segment = probe.segments[s];
            if (!carried[s] && (segment.parent == kNone || carried[segment.parent]))
                left[segment.path == Path::kRefract] += segment.weight;
        }
        most = glm::max(most, glm::max(left[0], left[1]));
    }
    return most;
}

Vec3 deep_light(const FacetPart& part) {
    Vec3 most(0);
    if (part.method != LeafMethod::kProjected) return most;
    for (const PartCorner& corner : part.corners) most = glm::max(most, corner.probe->cut.too_deep);
    return most;
}

}  // namespace

Id PathNode::facet_of(Id leaf) const {
    const auto found = std::lower_bound(leaves.begin(), leaves.end(), leaf);
    if (found == leaves.end() || *found != leaf) return kNone;
    const Id facet = static_cast<Id>(found - leaves.begin());
    return mesh.has_rays(facet) ? facet : kNone;
}

/// Cell 0 of `divided` becomes `cell`, the others stand at the end.
void OpticPaths::append(Id facet, Id cell, DividedFacet& divided) {
    const Id first_leaf = static_cast<Id>(leaves_.size()), behind = static_cast<Id>(cells_.size()) - 1;
    const auto number = [&](std::size_t c) { return c == 0 ? cell : behind + static_cast<Id>(c); };
    cells_.resize(cells_.size() + divided.cells.size() - 1);
    leaf_cell_.resize(leaves_.size() + divided.parts.size(), kNone);
    for (std::size_t c = 0; c < divided.cells.size(); ++c) {
        const DividedFacet::Cell& from = divided.cells[c];
        cells_[number(c)] = {from.children == kNone ? kNone : number(from.children),
                             from.part == kNone ? kNone : first_leaf + from.part};
        if (from.part != kNone) leaf_cell_[first_leaf + from.part] = number(c);
    }
    for (FacetPart& part : divided.parts) {
        leaves_.push_back({facet, part.level, part.method, part.centre, 0, part.layered, faint_light(part),
                           deep_light(part)});
        if (part.method != LeafMethod::kProjected) continue;
        ++projected_count_;
        append_part(static_cast<Id>(leaves_.size() - 1), part);
    }
    cut_ = most_cut(cut_, divided.cut);
}

Id OpticPaths::node_of(Id parent, const PathSegment& segment) {
    const auto [found, added] = node_by_step_.insert(
        {{parent, segment.step.optic, segment.step.event, segment.colours, segment.medium},
         static_cast<Id>(nodes_.size())});
    if (!added) return found->second;
    PathNode node;
    node.parent = parent;
    node.step = segment.step;
    node.path = segment.path;
    node.colours = segment.colours;
    node.medium = segment.medium;
    node.unfolds = segment.step.event != Event::kTransmit && !context_.camera.parallel;
    if (parent != kNone) {
        node.unfolds = node.unfolds && nodes_[parent].unfolds;
        node.step_count = static_cast<std::uint16_t>(nodes_[parent].step_count + 1);
    }
    nodes_.push_back(std::move(node));
    corner_of_node_.emplace_back();
    return found->second;
}

/// Whether a leaf's corner rays are fitted for itself and not with those all around.
bool OpticPaths::fits_alone(Id leaf) const {
    return params_.fit && (leaves_[leaf].level > 0 || !fitted_[leaves_[leaf].facet]);
}

void OpticPaths::append_part(Id leaf, FacetPart& part) {
    std::vector<Id>& node_index = part.node;
    node_index.assign(part.histories.size(), kNone);
    part.node_facet.assign(part.histories.size(), kNone);
    const bool alone = fits_alone(leaf);
    for (std::size_t h = 0; h < part.histories.size(); ++h) {
        const PathSegment& history = part.histories[h];
        node_index[h] = node_of(history.parent == kNone ? kNone : node_index[history.parent], history);
        PathNode& node = nodes_[node_index[h]];
        const bool first = node.parent == kNone && node.step.event == Event::kReflect;

        // the ray scale of corners where it is not known: the others' mean.
        std::array<double, 3> ray_scale{0, 0, 0};
        double sum = 0, known = 0;
        for (std::size_t k = 0; k < 3 && !first; ++k) {
            ray_scale[k] = part.corners[k].probe->ray_scale[part.segment[k][h]];
            sum += ray_scale[k];
            known += ray_scale[k] > 0;
        }
        IdTriple facet{};
        for (std::size_t k = 0; k < 3; ++k) {
            const PathProbe& probe = *part.corners[k].probe;
            const bool seen = !part.segment[k].empty();
            const PathSegment* segment = seen ? &probe.segments[part.segment[k][h]] : nullptr;
            const bool guessed = !first && ray_scale[k] == 0;
            const Id shared = guessed || alone ? kNone : part.corners[k].shared;
            if (shared != kNone) {
                const auto found = corner_of_node_[node_index[h]].find(shared);
                if (found != corner_of_node_[node_index[h]].end()) {
                    facet[k] = found->second;
                    continue;
                }
            }
            const double mean = known > 0 ? sum / known : 1;
            const NodeCorner corner =
                first ? first_reflection(probe, segment)
                      : later_corner(probe, *segment, guessed ? mean : ray_scale[k], node.unfolds);
            facet[k] = static_cast<Id>(node.mesh.rays.size());
            node.mesh.rays.push_back(corner.ray);
            node.mesh.screen.push_back(corner.screen);
            node.next.push_back(corner.next);
            node.weight.push_back(corner.weight);
            node.farther.push_back(first ? 1 : farther(probe, *segment, node.unfolds));
            if (shared != kNone) corner_of_node_[node_index[h]].insert({shared, facet[k]});
        }
        part.node_facet[h] = static_cast<Id>(node.mesh.facets.size());
        node.mesh.facets.push_back(facet);
        node.leaves.push_back(leaf);
        node.ends.push_back(history.ends);
        node.principal.push_back(history.principal);
        node.touches.push_back(touches_object(part, h));
        node.rests.push_back(rests_on_object(part, h));
    }
}

/// By the exact path at the part's middle.
bool OpticPaths::touches_object(const FacetPart& part, std::size_t history) const {
    constexpr double kTouching = 1e-8;  // of the way
    if (!params_.objects || part.histories[history].ends || part.inside.empty()) return false;
    const PartInside& middle = part.inside.back();
    if (middle.segment.empty()) return false;
    const PathSegment& exact = middle.at.probe->segments[middle.segment[history]];
    const Hit hit = params_.objects->first_hit(exact.ray);
    return hit.seen() && std::fabs(hit.t - exact.next) <= kTouching * exact.next;
}

Id OpticPaths::leaf_at(Id facet, const Vec3& weights) const {
    Cell cell = cells_[facet];
    Vec3 local = weights;
    while (cell.children != kNone) {
        const int child = child_of(local);
        local = child_weights(local, child);
        cell = cells_[cell.children + static_cast<Id>(child)];
    }
    return cell.leaf;
}

std::vector<Id> OpticPaths::nodes_in_order() const {
    std::vector<Id> order;
    const auto key = [&](Id n) {
        return std::tuple(nodes_[n].step.optic, nodes_[n].step.event, nodes_[n].colours, nodes_[n].medium);
    };
    const std::function<void(Id)> visit = [&](Id parent) {
        std::vector<Id> children;
        for (std::size_t n = 0; n < nodes_.size(); ++n)
            if (nodes_[n].parent == parent) children.push_back(static_cast<Id>(n));
        std::sort(children.begin(), children.end(), [&](Id a, Id b) { return key(a) < key(b); });
        for (const Id child : children) {
            order.push_back(child);
            visit(child);
        }
    };
    visit(kNone);
    return order;
}

}  // namespace trilens
