#include "paths/facets/fit_nodes.h"

#include <algorithm>
#include <cmath>

#include "base/util/parallel.h"

namespace trilens {
namespace {

constexpr double kEdgeOn = 1e-9;  // a facet seen from the side: its samples' measures vanish
constexpr double kAtCorner = 1.0 / 20, kAtMiddle = 2.0 / 15, kAtCentre = 9.0 / 20;

FitValue value_of(const Ray& ray, double next) {
    const Vec3 &o = ray.origin, &d = ray.direction;
    return {o.x, o.y, o.z, d.x, d.y, d.z, std::isfinite(next) ? next : 0};
}

/// One facet of one node.
struct NodeFacet {
    const PathNode& node;
    const FacetPart& part;
    std::size_t history = 0;
    IdTriple corners;

    const PathSegment& at_corner(std::size_t k) const {
        return part.corners[k].probe->segments[part.segment[k][history]];
    }
    bool is_first_reflection() const { return node.parent == kNone && node.step.event == Event::kReflect; }

    /// Screen area that belongs to a unit of the facet's weights there.
    double density(const Vec3& weights) const {
        std::array<Vec3, 3> screen;
        double w = 0;
        for (std::size_t k = 0; k < 3; ++k) {
            screen[k] = part.corners[k].probe->screen;
            w += weights[static_cast<int>(k)] * screen[k].z;
        }
        return std::fabs(triple(screen[0], screen[1], screen[2])) / (w * w * w);
    }

    /// The weights of the node's facet on the screen where the facet itself has these.
    Vec3 of_node(const Vec3& weights) const {
        Vec3 own;
        for (std::size_t k = 0; k < 3; ++k)
            own[static_cast<int>(k)] = weights[static_cast<int>(k)] * part.corners[k].probe->screen.z /
                                       node.mesh.screen[corners[k]].z;
        return own / (own.x + own.y + own.z);
    }

    double ray_scale(const Vec3& own) const {
        double sum = 0;
        for (std::size_t k = 0; k < 3; ++k) {
            const PathProbe& probe = *part.corners[k].probe;
            const double plain = length(probe.incident) * farther(probe, at_corner(k), node.unfolds);
            sum += own[static_cast<int>(k)] * length(node.mesh.rays[corners[k]].direction) / plain;
        }
        return sum;
    }

    void append(std::vector<FitSample>& samples) const {
        for (std::size_t k = 0; k < 3; ++k) {
            Vec3 weights(0);
            weights[static_cast<int>(k)] = 1;
            samples.push_back({corners, weights, kAtCorner * density(weights),
                               value_of(node.mesh.rays[corners[k]], node.next[corners[k]])});
        }
        for (std::size_t i = 0; i < part.inside.size(); ++i) {
            const PartInside& inside = part.inside[i];
            if (inside.segment.empty()) continue;
            const PathProbe& probe = *inside.at.probe;
            const PathSegment& segment = probe.segments[inside.segment[history]];
            const Vec3 own = of_node(kInsideWeights[i]);
            const NodeCorner exact = is_first_reflection()
                                         ? first_reflection(probe, &segment)
                                         : later_corner(probe, segment, ray_scale(own), node.unfolds);
            samples.push_back({corners, own, (i < 3 ? kAtMiddle : kAtCentre) * density(kInsideWeights[i]),
                               value_of(exact.ray, exact.next)});
        }
    }
};

bool takes_part(const FacetPart& part) {
    return std::all_of(part.corners.begin(), part.corners.end(), [](const PartCorner& corner) {
        return corner.probe->state == ProbeState::kSeen && corner.probe->screen.z > 0;
    });
}

void fit_node(std::vector<FitSample>& samples, PathNode& node, double unit) {
    std::vector<FitValue> values;
    values.reserve(node.mesh.rays.size());
    for (std::size_t c = 0; c < node.mesh.rays.size(); ++c)
        values.push_back(value_of(node.mesh.rays[c], node.next[c]));
    even_out(samples, values, unit);
    fit_linear(samples, values);
    for (std::size_t c = 0; c < values.size(); ++c) {
        const FitValue& v = values[c];
        node.mesh.rays[c] = {{v[0], v[1], v[2]}, {v[3], v[4], v[5]}};
        if (std::isfinite(node.next[c])) node.next[c] = v[6];
    }
}

/// The same for one facet by itself: three corners, one system of three equations.
void fit_facet(const std::vector<FitSample>& samples, PathNode& node) {
    Mat3 mass(0);
    std::array<Vec3, kFitParts> right{};
    for (const FitSample& sample : samples) {
        mass += sample.measure * glm::outerProduct(sample.weights, sample.weights);
        for (std::size_t p = 0; p < kFitParts; ++p)
            right[p] += sample.measure * sample.value[p] * sample.weights;
    }
    const double whole = mass[0][0] + mass[1][1] + mass[2][2];
    if (!(glm::determinant(mass) > kEdgeOn * whole * whole * whole)) return;
    const Mat3 inverse = glm::inverse(mass);
    std::array<Vec3, kFitParts> fitted;
    for (std::size_t p = 0; p < kFitParts; ++p) fitted[p] = inverse * right[p];
    for (std::size_t k = 0; k < 3; ++k) {
        const Id corner = samples.front().corners[k];
        const auto part = [&](std::size_t p) { return fitted[p][static_cast<int>(k)]; };
        node.mesh.rays[corner] = {{part(0), part(1), part(2)}, {part(3), part(4), part(5)}};
        if (std::isfinite(node.next[corner])) node.next[corner] = part(6);
    }
}

}  // namespace

void fit_alone(const FittedLeaf& leaf, std::vector<PathNode>& nodes) {
    if (!takes_part(*leaf.part)) return;
    std::vector<FitSample> samples;
    for (std::size_t h = 0; h < leaf.part->histories.size(); ++h) {
        PathNode& node = nodes[leaf.part->node[h]];
        samples.clear();
        NodeFacet{node, *leaf.part, h, node.mesh.facets[leaf.part->node_facet[h]]}.append(samples);
        fit_facet(samples, node);
    }
}

void fit_nodes(std::span<const FittedLeaf> leaves, std::vector<PathNode>& nodes, double unit) {
    std::vector<std::vector<FitSample>> samples(nodes.size());
    for (const FittedLeaf& one : leaves) {
        if (!takes_part(*one.part)) continue;
        for (std::size_t h = 0; h < one.part->histories.size(); ++h) {
            const Id n = one.part->node[h];
            NodeFacet{nodes[n], *one.part, h, nodes[n].mesh.facets[one.part->node_facet[h]]}.append(
                samples[n]);
        }
    }
    for (std::size_t n = 0; n < nodes.size(); ++n)
        if (!samples[n].empty()) fit_node(samples[n], nodes[n], unit);
}

}  // namespace trilens
