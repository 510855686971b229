// Packet traversal: several points that lie close together walk through the cells as one.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "specular/branch_and_bound.h"
#include "specular/simd_bounds.h"
#include "specular/sphere_images.h"

namespace trilens {

/// One thread each; surface, bounder and tree must live longer.
class PointPacket {
  public:
    /// For queries that differ from this in the point alone.
    PointPacket(const Surface& surface, const SurfaceBounder& bounder, ViewTree& tree,
                const SpecularQuery& query, const SearchLimits& limits);

    /// Warm-starts points from the previous group's solutions: at most kPointLanes of them.
    void begin(std::span<const Vec3> points);
    /// Whether that is all for some reason or other, so that `end` needs no parts.
    bool is_done() const { return under_way_ == 0; }
    /// For each of the points BranchAndBound::run's list, from `parts`, which are taken to hold every image;
    /// none where something stays undecided, or a zero lies on the border of a cell.
    std::vector<std::optional<SpecularSearch>> end(std::span<TreeNode* const> parts);

    /// So many points, counted from the first, best lie together once more.
    static constexpr std::size_t kNearPoints = 8;

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
    std::array<SurfaceParameter, 2> places_on_sphere(std::size_t lane) const;
    CellWord ask(TreeNode& cell, std::size_t lane);
    void note_settled();
    void note_zeros(std::size_t lane);
    bool knows_all(std::size_t lane) const;
    bool is_far_from_surface(const Vec3& place, const LawZero& zero) const;
    void visit(const Wait& wait);
    LaneBits judge(TreeNode& cell, LaneBits lanes);
    void lose(LaneBits lanes);

    const Surface& surface_;
    ViewTree& tree_;
    SpecularQuery query_;
    std::vector<BranchAndBound> walks_;  // one for each lane
    std::vector<LawZero> zeros_;         // of the last point
    const double curvature_;             // Surface::sphere_curvature
    const bool may_count_;               // whether find_zeros speaks of such queries
    SphereShape sphere_;
    SphereZeros sphere_zeros_;
    std::size_t count_ = 0;  // of points
    std::array<ZeroLanes, kMostZeros> known_;
    PointLanes points_;
    LaneBits under_way_ = 0;
    std::vector<Settled> settled_;
    std::uint32_t turn_ = 0;  // counts groups
    std::array<std::uint32_t, kPointLanes> looked_at_{};
    std::vector<Wait> waiting_;
};

}  // namespace trilens
