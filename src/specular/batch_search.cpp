// Dual-tree search: halves whichever of points and surface is the larger, and drops pairs without images.
#include "specular/batch_search.h"

#include <algorithm>
#include <numeric>
#include <optional>

#include "base/math/box.h"
#include "specular/point_packet.h"

namespace trilens {
namespace {

/// So few points are walked side by side.
constexpr std::size_t kFewPoints = kPointLanes;
/// A part of the surface is halved while it leaves more open than this many times what the points do.
constexpr double kPartShare = 1;
/// Cells whose normals turn less than this are asked the Newton operator, where their halves are at hand.
constexpr double kNewtonTurn = 0.06;
/// Cells whose normals turn less than this, or with a side shorter than that, are left to the walks of the
/// points.
constexpr double kFlatPart = 0.05;
constexpr double kSmallPart = 0x1p-10;
/// A tree of more nodes (some 900 bytes each) grows no further, and one of more than so many is not kept.
constexpr std::size_t kMostNodes = 1u << 16;
constexpr std::size_t kMostKept = 1u << 15;

}  // namespace

BatchSearch::BatchSearch(const Surface& surface, const CellBvh& cells, const SpecularQuery& query,
                         const SearchLimits& limits)
    : surface_(surface),
      cells_(cells),
      limits_(limits),
      tree_(surface, cells, query, limits.asks_rays),
      group_(surface, *cells.bounder(), tree_, query, limits),
      ball_(query) {}

/// Adds to `left` what may hold an image of any point of the ball.
void BatchSearch::sift(TreeNode& part, Parts& left) {
    const PlaceTest test = test_place(ball_, part.place, part.view, radius_);
    if (test.empty) return;
    const bool is_last = part.bounds && (part.bounds->is_finest || part.place.normal_radius < kFlatPart ||
                                         part.box.high.x - part.box.low.x < kSmallPart ||
                                         part.box.high.y - part.box.low.y < kSmallPart);
    if (part.bounds && part.place.normal_radius <= (part.is_halved ? kNewtonTurn : kHopelessTurn)) {
        const Vec2 half = part.box.half();
        const NewtonBounds newton = newton_bounds(tree_.terms_of(part), ball_.point, half, radius_);
        if (newton.known && leaves_cell(newton, half)) return;
    }
    const bool is_full = !part.is_halved && tree_.size() >= kMostNodes;
    if (is_last || is_full || !(test.by_place > kPartShare * test.by_points)) {
        left.push_back(&part);
        return;
    }
    tree_.halve(part);
    for (TreeNode* half : part.halves)
        if (half) sift(*half, left);
}

SpecularSearch BatchSearch::search_whole(const Vec3& point) {
    SpecularQuery query = ball_;
    query.point = point;
    if (tree_.size() < kMostNodes)
        return BranchAndBound(surface_, *cells_.bounder(), tree_, limits_).run(query);
    ViewTree tree(surface_, cells_, query, limits_.asks_rays);
    return BranchAndBound(surface_, *cells_.bounder(), tree, limits_).run(query);
}

/// Sifted when first asked for: most points need no parts.
const BatchSearch::Parts& BatchSearch::parts_of(Level& level) {
    if (level.is_sifted) return level.parts;
    level.is_sifted = true;
    Parts whole;
    if (!level.above && tree_.root()) whole.push_back(tree_.root());
    const Parts& from = level.above ? parts_of(*level.above) : whole;
    const PointBall ball = ball_around(points_, level.some);
    ball_.point = ball.middle;
    radius_ = ball.radius;
    for (TreeNode* part : from) sift(*part, level.parts);
    return level.parts;
}

/// As a walk through the whole surface has it: where something stays undecided, by that walk.
void BatchSearch::search(Level& level) {
    const std::span<const std::size_t> some = level.some;
    std::vector<std::optional<SpecularSearch>> found(some.size());
    if (tree_.size() < kMostNodes) {
        std::vector<Vec3> points;
        for (const std::size_t p : some) points.push_back(points_[p]);
        group_.begin(points);
        found = group_.end(group_.is_done() ? Parts() : parts_of(level));
    }
    for (std::size_t k = 0; k < some.size(); ++k)
        found_[some[k]] = found[k] ? std::move(*found[k]) : search_whole(points_[some[k]]);
}

void BatchSearch::descend(std::span<std::size_t> some, Level* above) {
    Level level{above, some, false, {}};
    if (some.size() <= kFewPoints) {
        if (some.size() > PointPacket::kNearPoints) spatial_split(points_, some, PointPacket::kNearPoints);
        search(level);
        return;
    }
    const std::size_t half = spatial_split(points_, some, kFewPoints);
    descend(some.first(half), &level);
    descend(some.subspan(half), &level);
}

std::vector<SpecularSearch> BatchSearch::run(std::span<const Vec3> points) {
    if (tree_.size() > kMostKept) tree_.begin_anew();
    points_ = points;
    found_ = std::vector<SpecularSearch>(points.size());
    std::vector<std::size_t> order(points.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    if (!points.empty()) descend(order, nullptr);
    return std::move(found_);
}

}  // namespace trilens
