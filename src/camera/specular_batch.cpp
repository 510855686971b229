// Two trees at once: whichever of points and surface is the larger is halved, and pairs without images go.
#include "camera/specular_batch.h"

#include <algorithm>
#include <numeric>
#include <optional>

#include "base/halve_points.h"
#include "camera/specular_walk.h"

namespace trilens {
namespace {

/// So few points are walked one after the other.
constexpr std::size_t kFewPoints = 8;
/// A part of the surface is halved while it leaves more open than this many times what the points do.
constexpr double kPartShare = 1;
/// Cells whose normals turn less than this are asked the Newton operator, where their halves are at hand.
constexpr double kNewtonTurn = 0.06;
/// Cells whose normals turn less than this, or with a side shorter than that, are left to the walks of the
/// points.
constexpr double kFlatPart = 0.05, kSmallPart = 0x1p-10;
/// A tree of more nodes (some 500 bytes each) grows no further.
constexpr std::size_t kMostNodes = 1u << 16;

class Batch {
  public:
    Batch(const Surface& surface, const SurfaceCells& cells, const SpecularQuery& query,
          const SearchLimits& limits)
        : surface_(surface),
          cells_(cells),
          limits_(limits),
          tree_(surface, cells, query),
          walk_(surface, *cells.bounder(), tree_, limits),
          ball_(query) {}

    std::vector<SpecularSearch> run(std::span<const Vec3> points);

  private:
    using Parts = std::vector<TreeNode*>;

    void descend(std::span<std::size_t> some, const Parts& parts);
    SpecularSearch search(const Vec3& point, const Parts& parts);
    void sift(TreeNode& part, Parts& left);

    const Surface& surface_;
    const SurfaceCells& cells_;
    const SearchLimits& limits_;
    SpecularTree tree_;
    SpecularWalk walk_;
    SpecularQuery ball_;  // its point is the middle of the points that are sifted for
    double radius_ = 0;
    std::span<const Vec3> points_;
    std::vector<SurfaceParameter> zeros_;  // of the last point
    std::vector<SpecularSearch> found_;
};

/// Adds to `left` what may hold an image of any point of the ball.
void Batch::sift(TreeNode& part, Parts& left) {
    const PlaceTest test = test_place(ball_, part.place, part.view, radius_);
    if (test.empty) return;
    const bool is_last = part.bounds && (part.bounds->is_finest || part.place.normal_radius < kFlatPart ||
                                         part.box.high.x - part.box.low.x < kSmallPart ||
                                         part.box.high.y - part.box.low.y < kSmallPart);
    if (part.bounds && part.place.normal_radius <= (part.is_halved ? kNewtonTurn : kHopelessTurn)) {
        const Vec2 half = part.box.half();
        const NewtonBounds newton = newton_bounds(ball_, *part.bounds, part.view, half, radius_);
        if (newton.known && leaves_cell(newton, half)) return;
    }
    if (is_last || !(test.by_place > kPartShare * test.by_points)) {
        left.push_back(&part);
        return;
    }
    tree_.halve(part);
    for (TreeNode* half : part.halves)
        if (half) sift(*half, left);
}

/// As a walk through the whole surface has it: where something stays undecided, by that walk, in a tree of
/// its own that may grow deep.
SpecularSearch Batch::search(const Vec3& point, const Parts& parts) {
    SpecularQuery query = ball_;
    query.point = point;
    if (tree_.size() < kMostNodes) {
        std::optional<SpecularSearch> search = walk_.run_near(query, parts, zeros_);
        zeros_ = walk_.zeros();
        if (search) return std::move(*search);
    }
    SpecularTree tree(surface_, cells_, query);
    SpecularWalk walk(surface_, *cells_.bounder(), tree, limits_);
    SpecularSearch search = walk.run(query);
    zeros_ = walk.zeros();
    return search;
}

void Batch::descend(std::span<std::size_t> some, const Parts& parts) {
    const PointBall ball = ball_around(points_, some);
    ball_.point = ball.middle;
    radius_ = ball.radius;
    Parts left;
    for (TreeNode* part : parts) sift(*part, left);
    if (some.size() > kFewPoints) {
        const std::size_t half = halve_points(points_, some);
        descend(some.first(half), left);
        descend(some.subspan(half), left);
        return;
    }
    for (const std::size_t p : some) found_[p] = search(points_[p], left);
}

std::vector<SpecularSearch> Batch::run(std::span<const Vec3> points) {
    points_ = points;
    found_.resize(points.size());
    Parts whole;
    if (tree_.root()) whole.push_back(tree_.root());
    std::vector<std::size_t> order(points.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    if (!points.empty()) descend(order, whole);
    return std::move(found_);
}

}  // namespace

std::vector<SpecularSearch> search_each(const Surface& surface, const SurfaceCells& cells,
                                        const SpecularQuery& query, std::span<const Vec3> points,
                                        const SearchLimits& limits) {
    return Batch(surface, cells, query, limits).run(points);
}

}  // namespace trilens
