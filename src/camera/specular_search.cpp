// Branch and bound over cells; interval Newton decides where images stand alone.
#include "camera/specular_search.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "base/check.h"
#include "camera/specular_bounds.h"
#include "camera/specular_cells.h"
#include "camera/specular_law.h"

namespace trilens {
namespace {

/// In parameters: zeros this far outside of a cell count as on its border, so that neighbours leave no gap.
constexpr double kBorder = 1e-12;
/// The interval Newton operator shrinks a cell to this share, so that Newton's method converges.
constexpr double kContraction = 0.5;
/// A refined image this far from the zero of the law that it began at is another one.
constexpr double kSameZero = 1e-6;
constexpr int kNewtonSteps = 30;
/// Over a cell whose normals turn by more than this the Newton operator decides nothing, and is not asked.
constexpr double kHopelessTurn = 0.25;
/// Undecided cells from which images are refined, evenly among them all.
constexpr std::size_t kUndecidedStarts = 64;

enum class Verdict { kEmpty, kSettled, kSplit };

double largest(const Vec2& v) {
    return std::max(std::fabs(v.x), std::fabs(v.y));
}

/// One query's walk through the cells.
class Walk {
  public:
    Walk(const Surface& surface, const SurfaceCells& cells, const SpecularQuery& query,
         const SearchLimits& limits)
        : surface_(surface), cells_(cells), query_(query), limits_(limits) {}

    SpecularSearch run();

  private:
    void visit_group(std::size_t index);
    void visit_cells();
    void visit(const CellBox& box, const SurfaceBounds& bounds, std::size_t halves);
    Verdict judge(const CellBox& box, const SurfaceBounds& bounds);
    Verdict settle(const CellBox& box, const SurfacePoint& middle, const NewtonBounds& newton);
    bool add_image(const SurfaceParameter& zero, const SurfacePoint& point);
    SurfacePoint point_at(Id face, const Vec2& uv) const;
    bool in_domain(Id face, const Vec2& uv) const;
    void refine_undecided();

    struct Waiting {
        CellBox box;
        std::size_t stored = 0;  // index of the stored cell
        bool is_stored = false;
    };

    const Surface& surface_;
    const SurfaceCells& cells_;
    const SpecularQuery& query_;
    const SearchLimits& limits_;
    std::vector<Waiting> waiting_;
    std::vector<SurfaceParameter> undecided_;
    SpecularSearch result_;
};

bool Walk::in_domain(Id face, const Vec2& uv) const {
    return surface_.domain(face) == FaceDomain::kSquare || uv.x + uv.y <= 1 + kBorder;
}

SurfacePoint Walk::point_at(Id face, const Vec2& uv) const {
    if (in_domain(face, uv)) return surface_.eval(face, uv);
    return cells_.bounder()->bounds(face, uv, uv).middle;
}

/// True if the zero's image is listed, or the zero is none: seen from a wrong side or behind the camera.
bool Walk::add_image(const SurfaceParameter& zero, const SurfacePoint& point) {
    const SpecularPath path = specular_path(query_, point.position);
    if (!sides_fit(query_, path, point.normal)) return true;
    if (!(screen_from_world(query_.camera, point.position).z > 0)) return true;
    const auto image = refine_specular_point(surface_, zero, query_);
    if (!image || largest(image->at.uv - zero.uv) > kSameZero) return false;
    result_.images.push_back(*image);
    return true;
}

/// A cell with one zero at most: finds it, or shows that it lies outside.
Verdict Walk::settle(const CellBox& box, const SurfacePoint& middle, const NewtonBounds& newton) {
    const Vec2 half = box.half();
    Vec2 uv = glm::clamp(box.middle() + newton.step, box.low, box.high);
    SurfacePoint point = middle;
    Vec2 law(0);
    for (int step = 0; step < kNewtonSteps; ++step) {
        point = point_at(box.face, uv);
        const Vec3 bend = specular_path(query_, point.position).bend;
        law = {dot(bend, point.du), dot(bend, point.dv)};
        const Vec2 next = uv - glm::inverse(path_hessian(query_, point)) * law;
        if (!std::isfinite(next.x + next.y)) return Verdict::kSplit;
        const Vec2 inside = glm::clamp(next, box.low, box.high);
        const bool at_rest = largest(inside - uv) <= 0.1 * kBorder;
        const bool is_zero = largest(next - uv) <= kBorder;
        if (is_zero) {
            if (!in_domain(box.face, uv)) return Verdict::kEmpty;
            return add_image({box.face, uv}, point) ? Verdict::kSettled : Verdict::kSplit;
        }
        if (at_rest) break;
        uv = inside;
    }

    // From a place on the cell's border all zeros lie around the step there, within the contraction's share
    // of their distance; outward of the border there are none.
    const Vec2 step = -(newton.inverse * law), share = newton.spread / half;
    const double contraction = largest(share), far = largest(step / half) / (1 - contraction);
    for (int axis = 0; axis < 2; ++axis) {
        const double out = uv[axis] >= box.high[axis]  ? step[axis]
                           : uv[axis] <= box.low[axis] ? -step[axis]
                                                       : 0;
        if (out - contraction * far * half[axis] > kBorder + newton.rounding[axis]) return Verdict::kEmpty;
    }
    // At rest on the border by rounding alone: a zero there is one.
    const bool rounding =
        std::fabs(step.x) <= kBorder + newton.rounding.x && std::fabs(step.y) <= kBorder + newton.rounding.y;
    if (!rounding) return Verdict::kSplit;
    if (!in_domain(box.face, uv)) return Verdict::kEmpty;
    return add_image({box.face, uv}, point) ? Verdict::kSettled : Verdict::kSplit;
}

Verdict Walk::judge(const CellBox& box, const SurfaceBounds& bounds) {
    if (holds_no_image(query_, place_of(bounds))) return Verdict::kEmpty;
    const bool is_last = bounds.is_finest || largest(box.high - box.low) <= limits_.smallest_cell;
    if (bounds.normal_radius > kHopelessTurn && !is_last) return Verdict::kSplit;
    const Vec2 half = box.half();
    const NewtonBounds newton = newton_bounds(query_, bounds, half);
    if (!newton.known) return Verdict::kSplit;
    bool alone = true;
    for (int axis = 0; axis < 2; ++axis) {
        const double reach = half[axis] + newton.spread[axis] + newton.rounding[axis] + kBorder;
        if (std::fabs(newton.step[axis]) > reach) return Verdict::kEmpty;
        alone = alone && newton.spread[axis] <= kContraction * half[axis];
    }
    return alone ? settle(box, bounds.middle, newton) : Verdict::kSplit;
}

void Walk::visit(const CellBox& box, const SurfaceBounds& bounds, std::size_t halves) {
    ++result_.cells;
    if (judge(box, bounds) != Verdict::kSplit) return;
    const bool is_smallest = largest(box.high - box.low) <= limits_.smallest_cell;
    if (bounds.is_finest || is_smallest || result_.cells >= limits_.most_cells) {
        undecided_.push_back({box.face, box.middle()});
        return;
    }
    if (halves > 0) {
        for (const std::size_t half : {halves + 1, halves}) waiting_.push_back({{}, half, true});
        return;
    }
    const auto two = halves_of(box, bounds.middle);
    waiting_.push_back({two.second, 0, false});
    waiting_.push_back({two.first, 0, false});
}

void Walk::visit_cells() {
    while (!waiting_.empty()) {
        const Waiting next = waiting_.back();
        waiting_.pop_back();
        if (next.is_stored) {
            const SurfaceCell& cell = cells_.cells()[next.stored];
            if (!is_outside(surface_.domain(cell.box.face), cell.box))
                visit(cell.box, cell.bounds, cell.halves);
        } else if (!is_outside(surface_.domain(next.box.face), next.box)) {
            visit(next.box, cells_.bounder()->bounds(next.box.face, next.box.low, next.box.high), 0);
        }
    }
}

void Walk::visit_group(std::size_t index) {
    const CellGroup& group = cells_.groups()[index];
    ++result_.cells;
    if (holds_no_image(query_, group.place)) return;
    if (group.leaf) {
        waiting_.push_back({{}, group.first, true});
        visit_cells();
    } else {
        visit_group(group.first);
        visit_group(group.second);
    }
}

void Walk::refine_undecided() {
    result_.undecided = undecided_.size();
    const std::size_t stride = undecided_.size() / kUndecidedStarts + 1;
    for (std::size_t k = 0; k < undecided_.size(); k += stride)
        if (const auto image = refine_specular_point(surface_, undecided_[k], query_))
            result_.images.push_back(*image);
}

SpecularSearch Walk::run() {
    if (!cells_.groups().empty()) visit_group(cells_.groups().size() - 1);
    refine_undecided();
    result_.complete = undecided_.empty();
    result_.images = distinct_images(std::move(result_.images));
    return std::move(result_);
}

}  // namespace

struct SpecularSearcher::Impl {
    const Surface& surface;
    SurfaceCells cells;
};

SpecularSearcher::SpecularSearcher(const Surface& surface)
    : impl_(new Impl{surface, SurfaceCells(surface)}) {}

SpecularSearcher::~SpecularSearcher() = default;

SpecularSearch SpecularSearcher::find(const SpecularQuery& query, const SearchLimits& limits) const {
    TRILENS_CHECK(query.eye_index > 0 && query.point_index > 0, "a refractive index is positive");
    TRILENS_CHECK(limits.smallest_cell > 0 && limits.starts > 0, "a search has an end and a start");
    if (impl_->cells.bounder() && query.own_normals)
        return Walk(impl_->surface, impl_->cells, query, limits).run();
    SpecularSearch search;
    search.images = specular_points(impl_->surface, regular_starts(impl_->surface, limits.starts), query);
    return search;
}

SpecularSearch SpecularSearcher::find_in_body(const SpecularQuery& query, const SearchLimits& limits) const {
    SpecularQuery outside = query, inside = query;
    outside.viewed = ViewedSide::kFront;
    inside.viewed = ViewedSide::kBack;
    std::swap(inside.eye_index, inside.point_index);
    SpecularSearch search = find(outside, limits), other = find(inside, limits);
    search.images.insert(search.images.end(), other.images.begin(), other.images.end());
    search.images = distinct_images(std::move(search.images));
    search.complete = search.complete && other.complete;
    search.cells += other.cells;
    search.undecided += other.undecided;
    return search;
}

SpecularSearch find_specular_points(const Surface& surface, const SpecularQuery& query,
                                    const SearchLimits& limits) {
    return SpecularSearcher(surface).find(query, limits);
}

}  // namespace trilens
