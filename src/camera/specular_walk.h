// The walk of one query through a surface's cells, from the whole or from what is left of it.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "camera/specular_search.h"
#include "camera/specular_tree.h"

namespace trilens {

/// Over a cell whose normals turn by more than this the Newton operator decides nothing, and is not asked.
inline constexpr double kHopelessTurn = 0.25;
/// In parameters: zeros this far outside of a cell count as on its border, so that neighbours leave no gap.
inline constexpr double kCellBorder = 1e-12;

/// Whether the Newton operator shows that the cell has no zero: both are of the cell with these half sides.
bool leaves_cell(const NewtonBounds& newton, const Vec2& half);

/// Branch and bound for one query after the other, all of one tree. One thread each; surface, bounder and
/// tree must live longer.
class SpecularWalk {
  public:
    SpecularWalk(const Surface& surface, const SurfaceBounder& bounder, SpecularTree& tree,
                 const SearchLimits& limits)
        : surface_(surface), bounder_(bounder), tree_(tree), limits_(limits) {}

    /// Searches the whole surface.
    SpecularSearch run(const SpecularQuery& query);

    /// The same list sooner, from `parts`, which are taken to hold every image, and `near`, zeros of the law
    /// for a point close by. None where something stays undecided, or a zero lies on the border of a cell.
    std::optional<SpecularSearch> run_near(const SpecularQuery& query, std::span<TreeNode* const> parts,
                                           std::span<const SurfaceParameter> near);

    /// The zeros of the law that the last run settled, of images or not.
    const std::vector<SurfaceParameter>& zeros() const { return zeros_; }

  private:
    enum class Verdict { kEmpty, kSettled, kSplit };

    void begin(const SpecularQuery& query, bool is_near);
    SpecularSearch end();
    void visit_all(TreeNode& from);
    void visit(TreeNode& node);
    Verdict judge_cell(const TreeNode& cell);
    Verdict ask_newton(const TreeNode& cell);
    Verdict settle(const CellBox& box, const SurfacePoint& middle, const NewtonBounds& newton);
    bool add_image(const SurfaceParameter& zero, const SurfacePoint& point);
    SurfacePoint point_at(Id face, const Vec2& uv) const;
    bool in_domain(Id face, const Vec2& uv) const;
    void refine_undecided();
    void settle_near(SurfaceParameter start);
    void settle_at(const SurfaceParameter& zero);
    void settle_again(const SurfaceParameter& zero);
    bool is_isolated(const CellBox& box) const;
    bool is_last(const TreeNode& cell) const;

    const Surface& surface_;
    const SurfaceBounder& bounder_;
    SpecularTree& tree_;
    SearchLimits limits_;
    SpecularQuery query_;
    double turn_of_newton_ = 0;  // cells whose normals turn by less are for the Newton operator
    double share_ = 0;           // to which the Newton operator shrinks the cell asked last
    bool is_near_ = false, is_lost_ = false;
    std::vector<TreeNode*> waiting_;
    std::vector<SurfaceParameter> undecided_, zeros_;
    std::vector<CellBox> isolated_;  // each with one zero at most, which is settled
    SpecularSearch result_;
};

}  // namespace trilens
