#include "caustics/plane_beams.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <memory>
#include <numeric>

#include "base/util/parallel.h"

namespace trilens {
namespace {

constexpr std::uint32_t kPerLeaf = 4;
ReceiverPlane plane_of(const ReceiverFace& face, const Vec3& normal) {
    Receiver receiver;
    receiver.point = face.center;
    receiver.normal = normal;
    ReceiverPlane plane(receiver, 0);
    plane.dual_s = face.along, plane.dual_t = cross(normal, face.along);
    return plane;
}

}  // namespace

Way way_to(const BeamEnds& ends, const ReceiverPlane& plane, double same_place) {
    int free = 0, stopped = 0;
    for (const BeamEnd* end : ends) {
        const double fall = -dot(end->direction, plane.normal);
        const double t = dot(end->origin - plane.point, plane.normal) / fall;
        if (!(fall > 0)) return Way::kUnknown;
        if (std::fabs(end->object - t) <= same_place / fall) ++free;
        if (end->optic < t) ++stopped;
    }
    return free == 3 ? Way::kFree : stopped == 3 ? Way::kStopped : Way::kUnknown;
}

PlaneBeams::PlaneBeams(const Source& source, const ReceiverFace& face, const Vec3& normal,
                       const PlaneBeamsParams& params, const Progress& progress)
    : plane_(plane_of(face, normal)) {
    std::vector<Id> near;
    source.tree.for_each_near(face.center, face.radius + params.reach,
                              [&](Id beam) { near.push_back(beam); });
    const Vec2 half = face.half + params.reach;
    const Target target{source, plane_, params, half, progress};
    std::vector<Parts> made(near.size());
    LoopProgress done(progress, static_cast<double>(near.size()));
    parallel_for(near.size(), 32, [&](std::size_t from, std::size_t to) {
        for (std::size_t i = from; i < to; ++i) made[i] = parts_of(target, near[i]);
        done.add(static_cast<double>(to - from));
    });
    for (Parts& one : made) {
        std::move(one.ends.begin(), one.ends.end(), std::back_inserter(ends_));
        curved_.insert(curved_.end(), one.curved.begin(), one.curved.end());
        flat_.insert(flat_.end(), one.flat.begin(), one.flat.end());
    }
    order_.resize(curved_.size() + flat_.size());
    std::iota(order_.begin(), order_.end(), std::uint32_t{0});
    bounds_.reserve(order_.size());
    for (const std::uint32_t entry : order_) bounds_.push_back(bounds_of(entry));
    if (!order_.empty()) build(0, static_cast<std::uint32_t>(order_.size()));
    std::vector<Bounds> in_order;
    in_order.reserve(order_.size());
    for (const std::uint32_t entry : order_) in_order.push_back(bounds_[entry]);
    bounds_ = std::move(in_order);
}

PlaneBeams::Box2 PlaneBeams::hull_box(const std::array<Vec2, 6>& at) {
    Box2 box;
    for (const Vec2& point : bezier_points(at)) box.include(point);
    return box;
}

std::array<Vec2, 6> PlaneBeams::fallen_on(const Curved& one, const Map& map) {
    std::array<Vec2, 6> at;
    for (std::size_t k = 0; k < 6; ++k) at[k] = map(one.curve.at[k]);
    return at;
}

bool PlaneBeams::is_inside(const std::array<Vec2, 6>& at) {
    const Box2 box = hull_box(at);
    return std::max({-box.low.x, -box.low.y, box.high.x, box.high.y}) <= 0.5;
}

/// Its strips are those of its first three corners' sides' directions, which all of it lies in: they part it
/// from what is beside (separating axes).
template <std::size_t kCount>
PlaneBeams::Bounds PlaneBeams::bounds_of(const std::array<Vec2, kCount>& hull) {
    Bounds bounds;
    for (const Vec2& point : hull) bounds.box.include(point);
    for (std::size_t k = 0; k < 3; ++k) {
        const Vec2 side = hull[(k + 1) % 3] - hull[k];
        const Vec2 normal(-side.y, side.x);
        Strip& strip = bounds.strips[k] = {normal, INFINITY, -INFINITY};
        for (const Vec2& point : hull) {
            strip.low = std::min(strip.low, dot(normal, point));
            strip.high = std::max(strip.high, dot(normal, point));
        }
    }
    return bounds;
}

PlaneBeams::Bounds PlaneBeams::bounds_of(std::uint32_t entry) const {
    if (entry < curved_.size()) return bounds_of(bezier_points(curved_[entry].curve.at));
    return bounds_of(flat_[entry - curved_.size()].fallen.at);
}

/// All that comes to the footprint, times its part of the film.
Vec3 PlaneBeams::light_of(const Curved& one, const std::array<Vec2, 6>& at) {
    const double measure = one.corners.measure;
    if (is_inside(at)) return measure * one.mean_light;
    const PieceGrid& grid = PieceGrid::of(one.sides);
    CutPieces cut;
    cut_pieces(at, one.sides, cut);
    std::array<double, 6> weights{};  // of the light at the beam's ends and middles
    for (std::size_t p = 0; p < grid.pieces; ++p) {
        if (!(cut.share[p] > 0)) continue;
        for (std::size_t k = 0; k < 3; ++k) {
            const double weight = cut.share[p] * cut.weight[k][p];
            const std::array<double, 6>& quadratic = grid.quadratic[grid.piece[p][k]];
            for (std::size_t c = 0; c < 6; ++c) weights[c] += weight * quadratic[c];
        }
    }
    Vec3 light(0);
    for (std::size_t c = 0; c < 6; ++c) light += weights[c] * one.curve.light[c];
    return measure / static_cast<double>(grid.pieces) * light;
}

PlaneBeams::Map PlaneBeams::map_to(const ReceiverPlane& footprint) const {
    Map map;
    map.origin = footprint.at(plane_.point);
    map.turn = Mat2(Vec2(dot(plane_.dual_s, footprint.dual_s), dot(plane_.dual_s, footprint.dual_t)),
                    Vec2(dot(plane_.dual_t, footprint.dual_s), dot(plane_.dual_t, footprint.dual_t)));
    return map;
}

PlaneBeams::Parallelogram PlaneBeams::parallelogram_of(const ReceiverPlane& footprint, const Map& map) {
    const Mat2 back = glm::inverse(map.turn);
    return {-(back * map.origin), footprint.has_footprint ? 0.5 * back : Mat2(0)};
}

PlaneBeams::Box2 PlaneBeams::box_of(const Parallelogram& footprint) {
    const Vec2 half = glm::abs(footprint.half[0]) + glm::abs(footprint.half[1]);
    return {footprint.middle - half, footprint.middle + half};
}

void PlaneBeams::build(std::uint32_t first, std::uint32_t end) {
    const auto at = static_cast<std::uint32_t>(nodes_.size());
    nodes_.emplace_back();
    Node node;
    Box2 middles;
    const auto middle_of = [&](std::uint32_t entry) {
        return bounds_[entry].box.low + bounds_[entry].box.high;
    };
    for (std::uint32_t i = first; i < end; ++i) {
        node.box.include(bounds_[order_[i]].box.low), node.box.include(bounds_[order_[i]].box.high);
        middles.include(middle_of(order_[i]));
    }
    if (end - first <= kPerLeaf) {
        node.first = first, node.end = end;
    } else {
        const Vec2 wide = middles.high - middles.low;
        const int k = wide.x > wide.y ? 0 : 1;
        const std::uint32_t middle = first + (end - first) / 2;
        std::nth_element(order_.begin() + first, order_.begin() + middle, order_.begin() + end,
                         [&](std::uint32_t a, std::uint32_t b) {
                             const double of_a = middle_of(a)[k], of_b = middle_of(b)[k];
                             return of_a != of_b ? of_a < of_b : a < b;
                         });
        build(first, middle);
        build(middle, end);
    }
    node.skip = static_cast<std::uint32_t>(nodes_.size());
    nodes_[at] = node;
}

}  // namespace trilens
