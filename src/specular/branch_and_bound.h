// Branch and bound over the cells of a surface for one query, from the whole or from what is left of it.
#pragma once

#include <algorithm>
#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "specular/specular_point.h"
#include "specular/specular_search.h"
#include "specular/view_tree.h"

namespace trilens {

/// Over a cell whose normals turn by more than this the Newton operator decides nothing, and is not asked.
inline constexpr double kHopelessTurn = 0.25;

/// What NewtonLanes say of a cell for a point.
enum class CellWord { kUnknown, kOpen, kNarrow };

/// A zero of the law, of an image or not.
struct LawZero {
    SurfaceParameter at;
    SurfacePoint point;
    double along = 0;  // h . normal
};

/// Branch and bound for one query after the other, all of one tree. One thread each; surface, bounder and
/// tree must live longer.
class BranchAndBound {
  public:
    BranchAndBound(const Surface& surface, const SurfaceBounder& bounder, ViewTree& tree,
                   const SearchLimits& limits)
        : surface_(surface), bounder_(bounder), tree_(tree), limits_(limits) {}

    using AskCell = std::function<CellWord(TreeNode& cell)>;

    /// Searches the whole surface.
    SpecularSearch run(const SpecularQuery& query);

    /// Begins a search that ends sooner, with `near`, zeros of the law for a point close by. What it settles
    /// has the bits that run has; the caller goes through the cells, by `has_settled` and `must_split`. Cells
    /// of which `ask` has a word are not asked one by one.
    void begin_near(const SpecularQuery& query, std::span<const LawZero> near, const AskCell& ask);
    /// The same from where zeros are for all that is known.
    void begin_at(const SpecularQuery& query, std::span<const SurfaceParameter> zeros, const AskCell& ask);
    /// Whether the cell, with all that it holds, has no zero but those that are settled.
    bool has_settled(const CellBox& box) const;
    std::span<const CellBox> settled() const { return isolated_; }
    /// Of a cell in which the Newton operator decides: whether it has to be halved.
    bool must_split(TreeNode& cell, const AskCell& ask);
    /// Notes that so many cells were looked at.
    void look(std::size_t cells) { result_.cells += cells; }
    /// Gives up: end_near then has no answer.
    void lose() { is_lost_ = true; }
    bool is_lost() const { return is_lost_; }
    /// The same list as from run, if all cells that are left have been looked at; none where something stayed
    /// undecided, or a zero lies on the border of a cell.
    std::optional<SpecularSearch> end_near();

    /// The zeros of the law that the last run settled.
    const std::vector<LawZero>& zeros() const { return zeros_; }

    /// Whether a cell is not halved any more.
    bool is_last(const TreeNode& cell) const {
        const Vec2 sides = cell.box.high - cell.box.low;
        return cell.bounds->is_finest || std::max(sides.x, sides.y) <= limits_.smallest_cell;
    }

  private:
    enum class Verdict { kEmpty, kSettled, kSplit };

    void begin(const SpecularQuery& query);
    SpecularSearch end();
    void visit_all(TreeNode& from);
    void visit(TreeNode& node);
    Verdict judge_cell(TreeNode& cell);
    Verdict ask_newton(TreeNode& cell);
    Verdict settle(const CellBox& box, const SurfacePoint& middle, const NewtonBounds& newton);
    bool add_image(const SurfaceParameter& zero, const SurfacePoint& point, const SpecularPath& path,
                   bool is_there);
    SurfacePoint point_at(Id face, const Vec2& uv) const;
    bool in_domain(Id face, const Vec2& uv) const;
    void refine_undecided();
    void settle_near(const LawZero& near, const AskCell& ask);
    void settle_at(const SurfaceParameter& zero, const AskCell& ask);
    bool descend_to(Id face, const Vec2& uv, const AskCell& ask, const TreeNode* last);
    TreeNode* half_around(TreeNode& cell, const Vec2& uv);

    const Surface& surface_;
    const SurfaceBounder& bounder_;
    ViewTree& tree_;
    SearchLimits limits_;
    SpecularQuery query_;
    double share_ = 0;  // to which the Newton operator shrinks the cell asked last
    bool is_lost_ = false;
    std::vector<TreeNode*> waiting_;
    std::vector<SurfaceParameter> undecided_;
    std::vector<LawZero> zeros_;
    std::vector<CellBox> isolated_;  // each with one zero at most, which is settled
    SpecularSearch result_;
};

}  // namespace trilens
