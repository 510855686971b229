// Leaves divided until what they show is predicted to lie where the exact paths show it.
#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <optional>

#include "base/util/parallel.h"
#include "paths/facets/divide_facet.h"
#include "paths/facets/path_build.h"

namespace trilens {
namespace {

constexpr std::size_t kLeavesPerTask = 16;
constexpr double kSure = 4;  // an estimate this many times below the limit will do

double largest(const Vec3& v) {
    return std::max({v.x, v.y, v.z});
}

/// One point of a leaf, seen along one of its histories.
struct LeafPoint {
    const ProbeContext& context;
    const PathNode& node;
    Id facet = kNone;  // of the node's mesh
    const PathProbe& probe;
    std::optional<PathProbe>& closer;  // the probe with those beside it, once some history wanted them
    std::size_t segment = 0;
    const DivideParams& params;

    double displacement(const Vec3& weights, const Ray& ray, const Hit& hit) const {
        if (!params.estimates) return predicted_displacement({context, probe, segment, ray, hit});
        const double estimate =
            estimated_displacement({node.mesh, facet, weights, probe.segments[segment].ray, hit});
        if (estimate <= params.max_error / kSure) return estimate;
        if (!closer) {
            closer = probe;  // others may look at the same
            probe_offsets(context, *closer);
        }
        return predicted_displacement({context, *closer, segment, ray, hit});
    }

    double predicted(const Vec3& weights) const {
        const PathSegment& exact = probe.segments[segment];
        const IdTriple& corner = node.mesh.facets[facet];
        const Ray ray = interpolated_ray(node.mesh, facet, weights);
        const Hit hit = params.objects->first_hit(ray);
        if (!node.ends[facet]) {
            double next = 0;
            for (int k = 0; k < 3; ++k) next += weights[k] * node.next[corner[static_cast<std::size_t>(k)]];
            if (!(hit.seen() && hit.t <= next)) return 0;
        }
        // What little light a side path carries counts for little.
        const double light = exact.principal ? 1 : std::min(1.0, largest(exact.weight));
        return light * displacement(weights, ray, hit);
    }
};

/// The most at any point; some number above the limit where one is above it.
double predicted_error(const PathBuild& build, const FittedLeaf& open) {
    const FacetPart& part = *open.part;
    double most = 0;
    std::array<std::optional<PathProbe>, kInsideWeights.size()> closer_inside;
    std::array<std::optional<PathProbe>, 3> closer_corner;
    for (std::size_t h = 0; h < part.histories.size() && !(most > build.in.params.max_error); ++h) {
        const PathNode& node = build.out.nodes[part.node[h]];
        const Id facet = part.node_facet[h];
        const IdTriple& corners = node.mesh.facets[facet];
        const auto probe_facet_point = [&](const PathProbe& probe, std::optional<PathProbe>& closer,
                                           const std::vector<std::size_t>& segment, Vec3 weights) {
            if (segment.empty()) return;
            for (std::size_t k = 0; k < 3; ++k)
                weights[static_cast<int>(k)] *=
                    part.corners[k].probe->screen.z / node.mesh.screen[corners[k]].z;
            const LeafPoint point{build.in.context, node, facet, probe, closer, segment[h], build.in.params};
            most = std::max(most, point.predicted(weights / (weights.x + weights.y + weights.z)));
        };
        for (std::size_t i = 0; i < part.inside.size(); ++i)
            probe_facet_point(*part.inside[i].at.probe, closer_inside[i], part.inside[i].segment,
                              kInsideWeights[i]);
        if (!build.in.params.fit) continue;
        for (std::size_t k = 0; k < 3; ++k) {
            Vec3 weights(0);
            weights[static_cast<int>(k)] = 1;
            probe_facet_point(*part.corners[k].probe, closer_corner[k], part.segment[k], weights);
        }
    }
    return most;
}

void divide_batch_by_error(PathBuild& build, std::vector<FittedLeaf> open) {
    std::deque<std::vector<DividedFacet>> levels;  // what later parts point into
    while (!open.empty()) {
        std::vector<double> error(open.size());
        std::vector<DividedFacet>& divided = levels.emplace_back(open.size());
        parallel_for(open.size(), kLeavesPerTask, [&](std::size_t from, std::size_t to) {
            for (std::size_t i = from; i < to; ++i) {
                error[i] = predicted_error(build, open[i]);
                if (error[i] > build.in.params.max_error)
                    divided[i] = divide_part(build.in.context, *open[i].part, build.in.params,
                                             build.out.probe_report.plan);
            }
        });
        set_ray_scales(build.in, divided);
        std::vector<FittedLeaf> next;
        for (std::size_t i = 0; i < open.size(); ++i) {
            const FittedLeaf& leaf = open[i];
            if (!(error[i] > build.in.params.max_error)) {
                if (!build.in.params.estimates) build.out.leaves[leaf.leaf].predicted = error[i];
                continue;
            }
            for (std::size_t h = 0; h < leaf.part->node.size(); ++h)
                build.out.nodes[leaf.part->node[h]].mesh.facets[leaf.part->node_facet[h]] = {kNone, kNone,
                                                                                             kNone};
            --build.out.projected_count;
            const Id first_leaf = static_cast<Id>(build.out.leaves.size());
            append_facet(build, build.out.leaves[leaf.leaf].facet, build.caches.leaf_cell[leaf.leaf],
                         divided[i]);
            for (std::size_t p = 0; p < divided[i].parts.size(); ++p) {
                if (divided[i].parts[p].method != LeafMethod::kProjected) continue;
                next.push_back({static_cast<Id>(first_leaf + p), &divided[i].parts[p]});
                if (build.in.params.fit) fit_alone(next.back(), build.out.nodes);
            }
        }
        open = std::move(next);
    }
}

}  // namespace

/// So many at a time, so that what was probed for their parts takes little room.
void divide_by_error(PathBuild& build, std::span<const FittedLeaf> open) {
    constexpr std::size_t kBatch = 1024;
    if (std::isinf(build.in.params.max_error)) return;
    for (std::size_t first = 0; first < open.size(); first += kBatch) {
        const auto batch = open.subspan(first, std::min(kBatch, open.size() - first));
        divide_batch_by_error(build, {batch.begin(), batch.end()});
    }
}

}  // namespace trilens
