#include "caustics/beam_tree.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace trilens {
namespace {
constexpr std::uint32_t kBeamsPerLeaf = 4;
constexpr double kLooseCone = 1e-9;

/// How far beside the hull of a beam's six rays a quadratic through them may lie, at distance t along the
/// rays: room + t slope.
struct Bulge {
    double room = 0, slope = 0;
};

/// A quadratic leaves the hull by at most a quarter of d, the way from a side's chord to its middle. With
/// rays o + t v that is do + t dv but for what their lengths to the plane differ, S, times how their
/// directions do; S is at most 2/3 of the shortest and three times the beam's width (CurvedBeam::fall).
/// Rounded up.
Bulge bulge_of(const std::array<const BeamEnd*, 3>& end, const std::array<const BeamEnd*, 3>& middle) {
    const Vec3 mean = (end[0]->direction + end[1]->direction + end[2]->direction) / 3.0;
    double origins = 0, directions = 0, wide = 0, apart = 0;
    for (std::size_t k = 0; k < 3; ++k) {
        const BeamEnd &a = *end[(k + 1) % 3], &b = *end[(k + 2) % 3], &m = *middle[k];
        origins = std::max(origins, length(m.origin - 0.5 * (a.origin + b.origin)));
        directions = std::max(directions, length(m.direction - 0.5 * (a.direction + b.direction)));
        wide = std::max(wide, length(a.origin - b.origin));
        apart = std::max({apart, length(a.direction - mean), length(m.direction - mean)});
    }
    return {0.5 * origins + 2.5 * wide * (apart + directions), 0.5 * (apart + directions)};
}

}  // namespace

struct BeamTree::Build {
    const Beams& beams;
    const Middles& middles;
    std::vector<Vec2> place;   // of each beam's middle
    std::vector<Bulge> bulge;  // of each beam
};

bool BeamTree::Node::holds(const Vec3& point, double reach) const {
    if (sine > 1) return true;
    const Vec3 way = point - center;
    const double along = dot(way, axis);
    const double across = std::sqrt(std::max(0.0, dot(way, way) - along * along));
    // The ball that comes nearest: of the one at the apex behind it.
    const double room = radius + reach;
    if (along * cosine + across * sine < 0) return along * along + across * across <= room * room;
    return across * cosine - along * sine <= room;
}

BeamTree::BeamTree(const Beams& beams, const Middles& middles) {
    Build of{beams, middles, {}, {}};
    for (const LightBeam& beam : beams.beams) {
        Vec2 middle(0);
        for (const Id end : beam.end) middle += beams.ends[end].place / 3.0;
        of.place.push_back(middle);
        of.bulge.push_back(
            bulge_of(corners_of(beams, beam).end, middles(static_cast<Id>(&beam - beams.beams.data()))));
    }
    order_.resize(beams.beams.size());
    std::iota(order_.begin(), order_.end(), Id{0});
    std::stable_sort(order_.begin(), order_.end(),
                     [&](Id a, Id b) { return beams.beams[a].history < beams.beams[b].history; });
    for (std::uint32_t first = 0; first < order_.size();) {
        std::uint32_t end = first;
        while (end < order_.size() && beams.beams[order_[end]].history == beams.beams[order_[first]].history)
            ++end;
        build(of, first, end);
        first = end;
    }
}

void BeamTree::build(const Build& of, std::uint32_t first, std::uint32_t end) {
    const auto at = static_cast<std::uint32_t>(nodes_.size());
    nodes_.emplace_back();
    const auto for_each_end = [&](const auto& use) {
        for (std::uint32_t i = first; i < end; ++i) {
            for (const Id e : of.beams.beams[order_[i]].end) use(of.beams.ends[e]);
            for (const BeamEnd* middle : of.middles(order_[i])) use(*middle);
        }
    };
    Node node;
    Vec3 axis(0), center(0);
    for_each_end([&](const BeamEnd& ray) { axis += ray.direction, center += ray.origin; });
    node.axis = normalize_or_zero(axis);
    node.center = center / (6.0 * (end - first));
    double least = 1;
    for_each_end([&](const BeamEnd& ray) { least = std::min(least, dot(node.axis, ray.direction)); });
    if (least > 0.01) {
        Bulge most;
        for (std::uint32_t i = first; i < end; ++i) {
            const Bulge& one = of.bulge[order_[i]];
            most = {std::max(most.room, one.room), std::max(most.slope, one.slope)};
        }
        node.sine = std::sqrt(std::max(0.0, 1 - least * least)) + most.slope + kLooseCone;
        node.cosine = std::sqrt(std::max(0.0, 1 - node.sine * node.sine));
        double around = 0;
        for_each_end(
            [&](const BeamEnd& ray) { around = std::max(around, length(ray.origin - node.center)); });
        node.radius = (most.room + around) * (1 + kLooseCone);
    }
    if (end - first <= kBeamsPerLeaf) {
        node.first = first, node.end = end;
        node.skip = at + 1;
        nodes_[at] = node;
        return;
    }
    Vec2 low(INFINITY), high(-INFINITY);
    for (std::uint32_t i = first; i < end; ++i)
        low = glm::min(low, of.place[order_[i]]), high = glm::max(high, of.place[order_[i]]);
    const int k = high.x - low.x > high.y - low.y ? 0 : 1;
    const std::uint32_t middle = first + (end - first) / 2;
    std::nth_element(order_.begin() + first, order_.begin() + middle, order_.begin() + end, [&](Id a, Id b) {
        return of.place[a][k] != of.place[b][k] ? of.place[a][k] < of.place[b][k] : a < b;
    });
    build(of, first, middle);
    build(of, middle, end);
    node.skip = static_cast<std::uint32_t>(nodes_.size());
    nodes_[at] = node;
}

}  // namespace trilens
