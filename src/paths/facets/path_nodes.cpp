// Parts of facets become leaves, and their histories nodes with the rays of their corners.
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

#include "paths/facets/one_history.h"
#include "paths/facets/path_build.h"

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

/// By the exact path at the part's middle.
bool touches_object(const PathInputs& in, const FacetPart& part, std::size_t history) {
    constexpr double kTouching = 1e-8;  // of the way
    if (!in.params.objects || part.histories[history].ends || part.inside.empty()) return false;
    const PartInside& middle = part.inside.back();
    if (middle.segment.empty()) return false;
    const PathSegment& exact = middle.at.probe->segments[middle.segment[history]];
    const Hit hit = in.params.objects->first_hit(exact.ray);
    return hit.seen() && std::fabs(hit.t - exact.next) <= kTouching * exact.next;
}

void append_part(PathBuild& build, Id leaf, FacetPart& part) {
    std::vector<Id>& node_index = part.node;
    node_index.assign(part.histories.size(), kNone);
    part.node_facet.assign(part.histories.size(), kNone);
    const bool alone = fits_alone(build, leaf);
    for (std::size_t h = 0; h < part.histories.size(); ++h) {
        const PathSegment& history = part.histories[h];
        node_index[h] = node_of(build, history.parent == kNone ? kNone : node_index[history.parent], history);
        PathNode& node = build.out.nodes[node_index[h]];
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
                const auto found = build.caches.corner_of_node[node_index[h]].find(shared);
                if (found != build.caches.corner_of_node[node_index[h]].end()) {
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
            if (shared != kNone) build.caches.corner_of_node[node_index[h]].insert({shared, facet[k]});
        }
        part.node_facet[h] = static_cast<Id>(node.mesh.facets.size());
        node.mesh.facets.push_back(facet);
        node.leaves.push_back(leaf);
        node.ends.push_back(history.ends);
        node.principal.push_back(history.principal);
        node.touches.push_back(touches_object(build.in, part, h));
        node.rests.push_back(rests_on_object(part, h));
        node.to_mirror.push_back(history.to_mirror);
        node.has_start.push_back(history.has_start);
    }
}

}  // namespace

void append_facet(PathBuild& build, Id facet, Id cell, DividedFacet& divided) {
    const Id first_leaf = static_cast<Id>(build.out.leaves.size()),
             behind = static_cast<Id>(build.out.cells.size()) - 1;
    const auto number = [&](std::size_t c) { return c == 0 ? cell : behind + static_cast<Id>(c); };
    build.out.cells.resize(build.out.cells.size() + divided.cells.size() - 1);
    build.caches.leaf_cell.resize(build.out.leaves.size() + divided.parts.size(), kNone);
    for (std::size_t c = 0; c < divided.cells.size(); ++c) {
        const DividedFacet::Cell& from = divided.cells[c];
        build.out.cells[number(c)] = {from.children == kNone ? kNone : number(from.children),
                                      from.part == kNone ? kNone : first_leaf + from.part};
        if (from.part != kNone) build.caches.leaf_cell[first_leaf + from.part] = number(c);
    }
    for (FacetPart& part : divided.parts) {
        build.out.leaves.push_back({facet, part.level, part.method, part.centre, 0, part.layered,
                                    faint_light(part), deep_light(part)});
        if (part.method != LeafMethod::kProjected) continue;
        ++build.out.projected_count;
        append_part(build, static_cast<Id>(build.out.leaves.size() - 1), part);
    }
    build.out.cut = most_cut(build.out.cut, divided.cut);
}

Id node_of(PathBuild& build, Id parent, const PathSegment& segment) {
    const auto [found, added] = build.caches.node_by_step.insert(
        {{parent, segment.step.optic, segment.step.event, segment.colours, segment.medium},
         static_cast<Id>(build.out.nodes.size())});
    if (!added) return found->second;
    PathNode node;
    node.parent = parent;
    node.step = segment.step;
    node.path = segment.path;
    node.colours = segment.colours;
    node.medium = segment.medium;
    node.unfolds = segment.step.event != Event::kTransmit && !build.in.context.camera.parallel;
    if (parent != kNone) {
        node.unfolds = node.unfolds && build.out.nodes[parent].unfolds;
        node.step_count = static_cast<std::uint16_t>(build.out.nodes[parent].step_count + 1);
    }
    build.out.nodes.push_back(std::move(node));
    build.caches.corner_of_node.emplace_back();
    return found->second;
}

bool fits_alone(const PathBuild& build, Id leaf) {
    return build.in.params.fit &&
           (build.out.leaves[leaf].level > 0 || !build.progress.fitted[build.out.leaves[leaf].facet]);
}

}  // namespace trilens
