#include "specular/point_packet.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "base/util/check.h"

namespace trilens {
namespace {

/// A search among so many cells is none of a point whose neighbour has the same images.
constexpr std::size_t kMostNear = 20'000;
/// The cells for the Newton operator where all zeros are thought to be known and the halves are at hand:
/// smaller than where one would be looked for, since what is left is excluded by its place more cheaply.
constexpr double kTurnAround = 0.03;

/// A point that lies further from a surface than this, in units of its faces, leaves no cell undecided.
constexpr double kFarInCells = 0x1p-10;

/// h . normal of zeros at which eye and point are on the same side is no less; where they are not it is zero.
constexpr double kClearOfEdge = 0.01;

template <typename Act>
void for_each_lane(LaneBits lanes, Act act) {
    for (; lanes != 0; lanes &= lanes - 1) act(static_cast<std::size_t>(std::countr_zero(lanes)));
}

}  // namespace

PointPacket::PointPacket(const Surface& surface, const SurfaceBounder& bounder, ViewTree& tree,
                         const SpecularQuery& query, const SearchLimits& limits)
    : surface_(surface),
      tree_(tree),
      query_(query),
      walks_(kPointLanes, BranchAndBound(surface, bounder, tree, limits)),
      curvature_(surface.sphere_curvature()),
      may_count_(curvature_ > 0 && query.event == SpecularEvent::kReflect && !query.camera.parallel &&
                 limits.smallest_cell <= SearchLimits().smallest_cell &&
                 limits.most_cells >= SearchLimits().most_cells) {
    if (!may_count_) return;
    const SurfacePoint at = surface.eval(0, Vec2(0.5));
    sphere_.radius = 1 / curvature_;
    sphere_.center = at.position - sphere_.radius * at.normal;
}

/// Of a sphere: by the normal at some place of it, and in units of its cells.
bool PointPacket::is_far_from_surface(const Vec3& place, const LawZero& zero) const {
    const Vec3 way = place - zero.point.position;
    const double height = dot(way, zero.point.normal) + 0.5 * curvature_ * dot(way, way);
    return std::fabs(height) > kFarInCells * (length(zero.point.du) + length(zero.point.dv));
}

/// What the lane's walk knows, but of points and eyes so near to the surface that cells of the smallest size
/// stay undecided.
void PointPacket::note_zeros(std::size_t lane) {
    const std::vector<LawZero>& zeros = walks_[lane].zeros();
    for (std::size_t k = 0; k < kMostZeros; ++k) {
        ZeroLanes& known = known_[k];
        known.known &= ~(LaneBits{1} << lane);
        if (k >= zeros.size() || !is_far_from_surface(points_.at(lane), zeros[k])) continue;
        if (!query_.camera.parallel && !is_far_from_surface(query_.camera.eye, zeros[k])) continue;
        known.known |= LaneBits{1} << lane;
        known.at.set(lane, zeros[k].point.position);
        known.along[lane] = zeros[k].along;
    }
}

/// Whether a lane's walk has both zeros of a sphere that has two.
bool PointPacket::knows_all(std::size_t lane) const {
    std::size_t outside = 0, inside = 0;
    for (const LawZero& zero : walks_[lane].zeros()) {
        outside += zero.along < -kClearOfEdge;
        inside += zero.along > kClearOfEdge;
    }
    return (sphere_zeros_.lit >> lane & 1 && outside == 1 && inside == 1) ||
           (sphere_zeros_.shaded >> lane & 1 && outside == 0 && inside == 2);
}

/// The zeros of a sphere that has two, roughly; else no faces.
std::array<SurfaceParameter, 2> PointPacket::places_on_sphere(std::size_t lane) const {
    if (!((sphere_zeros_.lit | sphere_zeros_.shaded) >> lane & 1)) return {};
    return {surface_.sphere_place(sphere_zeros_.first.at(lane)),
            surface_.sphere_place(sphere_zeros_.second.at(lane))};
}

/// Asks for the lane and those next to it at once.
CellWord PointPacket::ask(TreeNode& cell, std::size_t lane) {
    if (!cell.view.is_apart || walks_.front().is_last(cell)) return CellWord::kUnknown;
    if (cell.place.normal_radius > kHopelessTurn) return CellWord::kOpen;
    if (cell.asked_by != turn_) {
        cell.asked_by = turn_;
        cell.asked = cell.open = cell.narrow = 0;
    }
    if (!(cell.asked >> lane & 1)) {
        const LaneBits neighbours = ((LaneBits{1} << kNearPoints) - 1) << (lane / kNearPoints * kNearPoints);
        const LaneQuestion question{query_.event == SpecularEvent::kReflect, path_indices(query_), points_,
                                    neighbours};
        const NewtonLanes newton = newton_lanes(question, tree_.terms_of(cell), cell.box.half());
        cell.asked |= neighbours;
        cell.open |= newton.open;
        cell.narrow |= newton.narrow;
    }
    if (cell.open >> lane & 1) return CellWord::kOpen;
    return cell.narrow >> lane & 1 ? CellWord::kNarrow : CellWord::kUnknown;
}

/// Each point begins where its neighbour ended, if not where a sphere has its zeros.
void PointPacket::settle(std::span<const Vec3> points) {
    for (std::size_t lane = 0; lane < kPointLanes; ++lane)
        points_.set(lane, points[std::min(lane, points.size() - 1)]);
    if (may_count_) find_zeros(sphere_, query_.camera.eye, points_, sphere_zeros_);
    ++turn_;
    for (std::size_t lane = 0; lane < points.size(); ++lane) {
        BranchAndBound& walk = walks_[lane];
        const auto ask_in_lanes = [this, lane](TreeNode& cell) { return ask(cell, lane); };
        query_.point = points[lane];
        const std::array<SurfaceParameter, 2> on_sphere = places_on_sphere(lane);
        if (on_sphere[0].face != kNone)
            walk.begin_at(query_, on_sphere, ask_in_lanes);
        else
            walk.begin_near(query_, zeros_, ask_in_lanes);
        if (walk.is_lost()) under_way_ &= ~(LaneBits{1} << lane);
        if (walk.zeros().size() >= zeros_.size()) zeros_ = walk.zeros();
    }
}

void PointPacket::note_settled() {
    settled_.clear();
    for_each_lane(under_way_, [&](std::size_t lane) {
        if (knows_all(lane)) under_way_ &= ~(LaneBits{1} << lane);
    });
    if (curvature_ > 0) for_each_lane(under_way_, [&](std::size_t lane) { note_zeros(lane); });
    for_each_lane(under_way_, [&](std::size_t lane) {
        for (const CellBox& box : walks_[lane].settled()) {
            const auto known = std::find_if(settled_.begin(), settled_.end(), [&](const Settled& other) {
                return is_within(box, other.box) && is_within(other.box, box);
            });
            if (known == settled_.end())
                settled_.push_back({box, LaneBits{1} << lane});
            else
                known->lanes |= LaneBits{1} << lane;
        }
    });
}

void PointPacket::lose(LaneBits lanes) {
    for_each_lane(lanes, [&](std::size_t lane) { walks_[lane].lose(); });
    under_way_ &= ~lanes;
}

/// Which of the lanes have to look at the cell's halves.
LaneBits PointPacket::judge(TreeNode& cell, LaneBits lanes) {
    const bool is_last = walks_.front().is_last(cell);
    if (cell.place.normal_radius > (cell.is_halved ? kTurnAround : kHopelessTurn) && !is_last) return lanes;
    if (!cell.view.is_apart) {
        if (is_last) lose(lanes);
        return is_last ? 0 : lanes;
    }
    const LaneQuestion question{query_.event == SpecularEvent::kReflect, path_indices(query_), points_,
                                lanes};
    const NewtonLanes newton = newton_lanes(question, tree_.terms_of(cell), cell.box.half());
    lanes &= ~newton.leaves;
    for_each_lane(lanes & newton.contracts, [&](std::size_t lane) {
        if (!walks_[lane].must_split(cell, [&](TreeNode& one) { return ask(one, lane); }))
            lanes &= ~(LaneBits{1} << lane);
        if (walks_[lane].is_lost()) lose(LaneBits{1} << lane);
    });
    if (newton.contracts != 0) note_settled();
    if (is_last) lose(lanes);
    return is_last ? 0 : lanes;
}

void PointPacket::visit(const Wait& wait) {
    TreeNode& node = *wait.node;
    LaneBits lanes = wait.lanes & under_way_;
    for (std::size_t lane = 0; lane < kPointLanes; ++lane) looked_at_[lane] += lanes >> lane & 1;
    if (node.bounds)
        for (const Settled& settled : settled_)
            if (is_within(node.box, settled.box)) lanes &= ~settled.lanes;
    if (lanes == 0) return;
    const LaneQuestion question{query_.event == SpecularEvent::kReflect, path_indices(query_), points_,
                                lanes};
    lanes &= ~empty_lanes(question, node.place, node.view);
    for (const ZeroLanes& zeros : known_)
        if (lanes & zeros.known)
            lanes &= ~alone_lanes({question.reflects, question.n, points_, lanes}, node.place, node.view,
                                  zeros, curvature_);
    if (lanes != 0 && node.bounds) lanes = judge(node, lanes);
    if (lanes == 0) return;
    tree_.halve(node);
    for (TreeNode* half : {node.halves[1], node.halves[0]})
        if (half) waiting_.push_back({half, lanes});
}

void PointPacket::begin(std::span<const Vec3> points) {
    TRILENS_CHECK(!points.empty() && points.size() <= kPointLanes, "a group has a lane for each point");
    count_ = points.size();
    under_way_ = static_cast<LaneBits>((std::uint64_t{1} << points.size()) - 1);
    settle(points);
    note_settled();
}

std::vector<std::optional<SpecularSearch>> PointPacket::end(std::span<TreeNode* const> parts) {
    waiting_.clear();
    looked_at_.fill(0);
    for (TreeNode* part : parts) waiting_.push_back({part, under_way_});
    std::size_t looked_at = 0;
    while (!waiting_.empty() && under_way_ != 0) {
        const Wait next = waiting_.back();
        waiting_.pop_back();
        visit(next);
        if (++looked_at == kMostNear) lose(under_way_);
    }
    std::vector<std::optional<SpecularSearch>> found;
    for (std::size_t lane = 0; lane < count_; ++lane) {
        walks_[lane].look(looked_at_[lane]);
        found.push_back(walks_[lane].end_near());
    }
    zeros_ = walks_[count_ - 1].zeros();
    return found;
}

}  // namespace trilens
