#include "camera/specular_group.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "base/check.h"

namespace trilens {
namespace {

/// A search among so many cells is none of a point whose neighbour has the same images.
constexpr std::size_t kMostNear = 20'000;
/// The cells for the Newton operator where all zeros are thought to be known and the halves are at hand:
/// smaller than where one would be looked for, since what is left is excluded by its place more cheaply.
constexpr double kTurnAround = 0.03;

/// A point that lies further from a surface than this, in units of its faces, leaves no cell undecided.
constexpr double kFarInCells = 0x1p-10;

template <typename Act>
void for_each_lane(LaneBits lanes, Act act) {
    for (; lanes != 0; lanes &= lanes - 1) act(static_cast<std::size_t>(std::countr_zero(lanes)));
}

}  // namespace

SpecularGroup::SpecularGroup(const Surface& surface, const SurfaceBounder& bounder, SpecularTree& tree,
                             const SpecularQuery& query, const SearchLimits& limits)
    : tree_(tree),
      query_(query),
      walks_(kPointLanes, SpecularWalk(surface, bounder, tree, limits)),
      curvature_(surface.sphere_curvature()) {}

/// Of a sphere: by the normal at some place of it, and in units of its cells.
bool SpecularGroup::is_far_from_surface(const Vec3& place, const LawZero& zero) const {
    const Vec3 way = place - zero.point.position;
    const double height = dot(way, zero.point.normal) + 0.5 * curvature_ * dot(way, way);
    return std::fabs(height) > kFarInCells * (length(zero.point.du) + length(zero.point.dv));
}

/// What the lane's walk knows, but of points and eyes so near to the surface that cells of the smallest size
/// stay undecided.
void SpecularGroup::note_zeros(std::size_t lane) {
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

/// Asks for all lanes at once.
bool SpecularGroup::is_open(TreeNode& cell, std::size_t lane) {
    if (!cell.view.is_apart || walks_.front().is_last(cell)) return false;
    if (cell.place.normal_radius > kHopelessTurn) return true;
    auto asked = std::find_if(asked_.begin(), asked_.end(), [&](const Wait& a) { return a.node == &cell; });
    if (asked == asked_.end()) {
        const LaneQuestion question{query_.event == SpecularEvent::kReflect, path_indices(query_), points_,
                                    under_way_};
        asked_.push_back({&cell, newton_lanes(question, tree_.terms_of(cell), cell.box.half()).open});
        asked = asked_.end() - 1;
    }
    return asked->lanes >> lane & 1;
}

/// Each point begins where its neighbour ended.
void SpecularGroup::settle(std::span<const Vec3> points) {
    for (std::size_t lane = 0; lane < kPointLanes; ++lane)
        points_.set(lane, points[std::min(lane, points.size() - 1)]);
    asked_.clear();
    for (std::size_t lane = 0; lane < points.size(); ++lane) {
        query_.point = points[lane];
        walks_[lane].begin_near(query_, zeros_, [&](TreeNode& cell) { return is_open(cell, lane); });
        if (walks_[lane].is_lost()) under_way_ &= ~(LaneBits{1} << lane);
        if (walks_[lane].zeros().size() >= zeros_.size()) zeros_ = walks_[lane].zeros();
    }
}

void SpecularGroup::note_settled() {
    settled_.clear();
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

void SpecularGroup::lose(LaneBits lanes) {
    for_each_lane(lanes, [&](std::size_t lane) { walks_[lane].lose(); });
    under_way_ &= ~lanes;
}

/// Which of the lanes have to look at the cell's halves.
LaneBits SpecularGroup::judge(TreeNode& cell, LaneBits lanes) {
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
        if (!walks_[lane].must_split(cell)) lanes &= ~(LaneBits{1} << lane);
        if (walks_[lane].is_lost()) lose(LaneBits{1} << lane);
    });
    if (newton.contracts != 0) note_settled();
    if (is_last) lose(lanes);
    return is_last ? 0 : lanes;
}

void SpecularGroup::visit(const Wait& wait) {
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

std::vector<std::optional<SpecularSearch>> SpecularGroup::run(std::span<const Vec3> points,
                                                              std::span<TreeNode* const> parts) {
    TRILENS_CHECK(!points.empty() && points.size() <= kPointLanes, "a group has a lane for each point");
    under_way_ = static_cast<LaneBits>((std::uint64_t{1} << points.size()) - 1);
    settle(points);
    note_settled();
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
    for (std::size_t lane = 0; lane < points.size(); ++lane) {
        walks_[lane].look(looked_at_[lane]);
        found.push_back(walks_[lane].end_near());
    }
    zeros_ = walks_[points.size() - 1].zeros();
    return found;
}

}  // namespace trilens
