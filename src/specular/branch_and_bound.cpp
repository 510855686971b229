// Branch and bound over cells; interval Newton decides where images stand alone.
#include "specular/branch_and_bound.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "specular/simd_bounds.h"
#include "specular/specular_point.h"

namespace trilens {
namespace {

constexpr double kBorder = kCellBorder;
/// A refined image this far from the zero of the law that it began at is another one.
constexpr double kSameZero = 1e-6;
constexpr int kWalkSteps = 30;
/// Undecided cells from which images are refined, evenly among them all.
constexpr std::size_t kUndecidedStarts = 64;

/// Zeros nearer than this to a cell's border are left to the cells on both sides.
constexpr double kClearOfBorder = 1e-9;
/// Newton steps from a neighbour's zero: enough to tell the cells that hold the zero.
constexpr int kNearSteps = 2;

double larger_part(const Vec2& v) {
    return std::max(std::fabs(v.x), std::fabs(v.y));
}

bool is_clear_of_border(const TreeNode& cell, const Vec2& uv) {
    const Vec2 inside = glm::min(uv - cell.box.low, cell.box.high - uv);
    return std::min(inside.x, inside.y) > kClearOfBorder;
}

}  // namespace

bool BranchAndBound::in_domain(Id face, const Vec2& uv) const {
    return surface_.domain(face) == FaceDomain::kSquare || uv.x + uv.y <= 1 + kBorder;
}

SurfacePoint BranchAndBound::point_at(Id face, const Vec2& uv) const {
    if (in_domain(face, uv)) return surface_.eval(face, uv);
    return bounder_.bounds(face, uv, uv).middle;
}

/// True if the zero's image is listed, or the zero is none: seen from a wrong side or behind the camera.
/// `point` and `path` are of a place close by, or of the zero where `is_there`.
bool BranchAndBound::add_image(const SurfaceParameter& zero, const SurfacePoint& point,
                               const SpecularPath& path, bool is_there) {
    if (sides_fit(query_, path, point.normal) && screen_from_world(query_.camera, point.position).z > 0) {
        const bool is_inside =
            surface_.domain(zero.face) == FaceDomain::kSquare || zero.uv.x + zero.uv.y <= 1;
        const auto image = is_there && is_inside ? refine_specular_point(surface_, zero, point, query_)
                                                 : refine_specular_point(surface_, zero, query_);
        if (!image || larger_part(image->at.uv - zero.uv) > kSameZero) return false;
        result_.images.push_back(*image);
    }
    zeros_.push_back({zero, point, dot(path.bend, point.normal)});
    return true;
}

/// A cell with one zero at most: finds it, or shows that it lies outside.
BranchAndBound::Verdict BranchAndBound::settle(const CellBox& box, const SurfacePoint& middle,
                                               const NewtonBounds& newton) {
    const Vec2 half = box.half();
    Vec2 uv = glm::clamp(box.middle() + newton.step, box.low, box.high);
    SurfacePoint point = middle;
    SpecularPath path;
    Vec2 law(0);
    for (int step = 0; step < kWalkSteps; ++step) {
        point = point_at(box.face, uv);
        path = specular_path(query_, point.position);
        law = {dot(path.bend, point.du), dot(path.bend, point.dv)};
        const Vec2 next = uv - glm::inverse(path_hessian(query_, path, point)) * law;
        if (!std::isfinite(next.x + next.y)) return Verdict::kSplit;
        const Vec2 inside = glm::clamp(next, box.low, box.high);
        const bool at_rest = larger_part(inside - uv) <= 0.1 * kBorder;
        const bool is_zero = larger_part(next - uv) <= kBorder;
        if (is_zero) {
            if (!in_domain(box.face, uv)) return Verdict::kEmpty;
            return add_image({box.face, uv}, point, path, true) ? Verdict::kSettled : Verdict::kSplit;
        }
        if (at_rest) break;
        uv = inside;
    }

    // From a place on the cell's border all zeros lie around the step there, within the contraction's share
    // of their distance; outward of the border there are none.
    const Vec2 step = -(newton.inverse * law), share = newton.spread / half;
    const double contraction = larger_part(share), far = larger_part(step / half) / (1 - contraction);
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
    return add_image({box.face, uv}, point, path, false) ? Verdict::kSettled : Verdict::kSplit;
}

BranchAndBound::Verdict BranchAndBound::ask_newton(TreeNode& cell) {
    share_ = HUGE_VAL;
    if (cell.place.normal_radius > kHopelessTurn && !is_last(cell)) return Verdict::kSplit;
    const Vec2 half = cell.box.half();
    NewtonBounds newton = newton_bounds(tree_.terms_of(cell), query_.point, half);
    if (!newton.known) return Verdict::kSplit;
    if (leaves_cell(newton, half)) return Verdict::kEmpty;
    share_ = larger_part(newton.spread / half);
    if (!(newton.spread.x <= kContraction * half.x && newton.spread.y <= kContraction * half.y))
        return Verdict::kSplit;
    step_with_care(query_, cell.bounds->middle, newton);
    return settle(cell.box, cell.bounds->middle, newton);
}

BranchAndBound::Verdict BranchAndBound::judge_cell(TreeNode& cell) {
    const Verdict verdict = ask_newton(cell);
    if (verdict != Verdict::kSplit || !(is_last(cell) || result_.cells >= limits_.most_cells)) return verdict;
    undecided_.push_back({cell.box.face, cell.box.middle()});
    return Verdict::kEmpty;
}

void BranchAndBound::visit(TreeNode& node) {
    ++result_.cells;
    if (test_place(query_, node.place, node.view, 0).empty) return;
    if (node.bounds && judge_cell(node) != Verdict::kSplit) return;
    tree_.halve(node);
    for (TreeNode* half : {node.halves[1], node.halves[0]})
        if (half) waiting_.push_back(half);
}

void BranchAndBound::visit_all(TreeNode& from) {
    waiting_.assign(1, &from);
    while (!waiting_.empty()) {
        TreeNode* next = waiting_.back();
        waiting_.pop_back();
        visit(*next);
    }
}

bool BranchAndBound::has_settled(const CellBox& box) const {
    return std::any_of(isolated_.begin(), isolated_.end(),
                       [&](const CellBox& b) { return is_within(box, b); });
}

/// Asks the cells around it from the largest on: a search of the whole settles the zero there, if there is.
bool BranchAndBound::must_split(TreeNode& cell, const AskCell& ask) {
    if (has_settled(cell.box)) return false;
    return descend_to(cell.box.face, cell.box.middle(), ask, &cell);
}

/// The zero near one for a point close by, by its cell.
void BranchAndBound::settle_near(const LawZero& near, const AskCell& ask) {
    SurfaceParameter start = near.at;
    for (int step = 0; step < kNearSteps; ++step) {
        const SurfacePoint point = step == 0 ? near.point : surface_.eval(start.face, start.uv);
        const SpecularPath path = specular_path(query_, point.position);
        start.uv -= glm::inverse(path_hessian(query_, path, point)) *
                    Vec2(dot(path.bend, point.du), dot(path.bend, point.dv));
        const bool inside = start.uv.x >= 0 && start.uv.y >= 0 && start.uv.x <= 1 && start.uv.y <= 1;
        if (!inside || !in_domain(start.face, start.uv)) return;
    }
    settle_at(start, ask);
}

void BranchAndBound::settle_at(const SurfaceParameter& zero, const AskCell& ask) {
    if (!has_settled({zero.face, zero.uv, zero.uv})) descend_to(zero.face, zero.uv, ask, nullptr);
}

/// Goes down through the cells that hold the place to the one where a search of the whole settles it, if
/// there is, and notes the largest in which it stands alone. True where none down to `last` decided.
bool BranchAndBound::descend_to(Id face, const Vec2& uv, const AskCell& ask, const TreeNode* last) {
    TreeNode* alone = nullptr;
    for (TreeNode* cell = &tree_.face(face); cell; cell = cell == last ? nullptr : half_around(*cell, uv)) {
        if (cell->view.is_behind) return false;
        const CellWord word = ask(*cell);
        if (!alone && word == CellWord::kNarrow) alone = cell;
        if (word != CellWord::kUnknown) continue;
        const Verdict verdict = ask_newton(*cell);
        if (!alone && share_ <= kAloneShare) alone = cell;
        if (verdict == Verdict::kSettled) {
            // A zero on the border is one of the neighbour too: which of the two is listed is for run to say.
            if (is_clear_of_border(*cell, zeros_.back().at.uv))
                isolated_.push_back(alone->box);
            else
                is_lost_ = true;
        }
        if (verdict != Verdict::kSplit) return false;
        if (is_last(*cell)) return true;
    }
    return true;
}

/// The half that holds a place; null where that is near the other.
TreeNode* BranchAndBound::half_around(TreeNode& cell, const Vec2& uv) {
    tree_.halve(cell);
    const CellBox& first = cell.halves[0]->box;
    const int axis = first.high.x < cell.box.high.x ? 0 : 1;
    if (!(std::fabs(uv[axis] - first.high[axis]) > kClearOfBorder)) return nullptr;
    return cell.halves[uv[axis] > first.high[axis] ? 1 : 0];
}

void BranchAndBound::refine_undecided() {
    result_.undecided = undecided_.size();
    const std::size_t stride = undecided_.size() / kUndecidedStarts + 1;
    for (std::size_t k = 0; k < undecided_.size(); k += stride)
        if (const auto image = refine_specular_point(surface_, undecided_[k], query_))
            result_.images.push_back(*image);
}

void BranchAndBound::begin(const SpecularQuery& query) {
    query_ = query;
    is_lost_ = false;
    undecided_.clear();
    zeros_.clear();
    isolated_.clear();
    result_ = {};
}

SpecularSearch BranchAndBound::end() {
    refine_undecided();
    result_.complete = undecided_.empty();
    result_.images = distinct_images(std::move(result_.images));
    return std::move(result_);
}

SpecularSearch BranchAndBound::run(const SpecularQuery& query) {
    begin(query);
    if (tree_.root()) visit_all(*tree_.root());
    return end();
}

void BranchAndBound::begin_near(const SpecularQuery& query, std::span<const LawZero> near,
                                const AskCell& ask) {
    begin(query);
    for (const LawZero& start : near) settle_near(start, ask);
}

void BranchAndBound::begin_at(const SpecularQuery& query, std::span<const SurfaceParameter> zeros,
                              const AskCell& ask) {
    begin(query);
    for (const SurfaceParameter& zero : zeros) settle_at(zero, ask);
}

std::optional<SpecularSearch> BranchAndBound::end_near() {
    if (is_lost_) return std::nullopt;
    return end();
}

}  // namespace trilens
