// Several points that lie close together, walked through a surface's cells as one.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "camera/specular_lanes.h"
#include "camera/specular_walk.h"

namespace trilens {

/// One thread each; surface, bounder and tree must live longer.
class SpecularGroup {
  public:
    /// For queries that differ from this in the point alone.
    SpecularGroup(const Surface& surface, const SurfaceBounder& bounder, SpecularTree& tree,
                  const SpecularQuery& query, const SearchLimits& limits);

    /// For each of at most kPointLanes points SpecularWalk::run's list, from `parts`, which are taken to hold
    /// every image; none where something stays undecided, or a zero lies on the border of a cell.
    std::vector<std::optional<SpecularSearch>> run(std::span<const Vec3> points,
                                                   std::span<TreeNode* const> parts);

  private:
    /// So many zeros of a point are thought of where others are excluded.
    static constexpr std::size_t kMostZeros = 3;

    struct Wait {
        TreeNode* node = nullptr;
        LaneBits lanes = 0;
    };
    /// A box with one zero at most for each of these lanes, which is settled.
    struct Settled {
        CellBox box;
        LaneBits lanes = 0;
    };

    void settle(std::span<const Vec3> points);
    bool is_open(TreeNode& cell, std::size_t lane);
    void note_settled();
    void note_zeros(std::size_t lane);
    bool is_far_from_surface(const Vec3& place, const LawZero& zero) const;
    void visit(const Wait& wait);
    LaneBits judge(TreeNode& cell, LaneBits lanes);
    void lose(LaneBits lanes);

    SpecularTree& tree_;
    SpecularQuery query_;
    std::vector<SpecularWalk> walks_;  // one for each lane
    std::vector<LawZero> zeros_;       // of the last point
    const double curvature_;           // Surface::sphere_curvature
    std::array<ZeroLanes, kMostZeros> known_;
    PointLanes points_;
    LaneBits under_way_ = 0;
    std::vector<Settled> settled_;
    std::vector<Wait> asked_;  // with the lanes for which the cell is open
    std::array<std::uint32_t, kPointLanes> looked_at_{};
    std::vector<Wait> waiting_;
};

}  // namespace trilens
