// Batched search: what the points of one query have in common is excluded once (dual-tree branch and bound).
#pragma once

#include <span>
#include <vector>

#include "specular/cell_bvh.h"
#include "specular/point_packet.h"
#include "specular/specular_search.h"

namespace trilens {

/// Keeps what it learns of the surface from one list of points to the next. One thread each; surface and
/// cells, which have bounds, must live longer.
class BatchSearch {
  public:
    /// For queries with own normals that differ from this in the point alone.
    BatchSearch(const Surface& surface, const CellBvh& cells, const SpecularQuery& query,
                const SearchLimits& limits);

    /// SpecularSearcher::find_each.
    std::vector<SpecularSearch> run(std::span<const Vec3> points);

    /// Nodes of the surface's tree that are held: some 900 bytes each.
    std::size_t node_count() const { return tree_.size(); }

    /// Whether such queries are this batch's.
    bool serves(SpecularQuery query, const SearchLimits& limits) const {
        query.point = ball_.point;
        return query == ball_ && limits == limits_;
    }

  private:
    using Parts = std::vector<TreeNode*>;

    /// Points that lie together, and the parts of the surface that may hold an image of any of them.
    struct Level {
        Level* above = nullptr;
        std::span<const std::size_t> some;
        bool is_sifted = false;
        Parts parts;
    };

    void descend(std::span<std::size_t> some, Level* above);
    void search(Level& level);
    SpecularSearch search_whole(const Vec3& point);
    const Parts& parts_of(Level& level);
    void sift(TreeNode& part, Parts& left);

    const Surface& surface_;
    const CellBvh& cells_;
    const SearchLimits limits_;
    ViewTree tree_;
    PointPacket group_;
    SpecularQuery ball_;  // its point is the middle of the points that are sifted for
    double radius_ = 0;
    std::span<const Vec3> points_;
    std::vector<SpecularSearch> found_;
};

}  // namespace trilens
