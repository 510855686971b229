// Lazily refined tree of surface cells; per-camera terms are cached in each node.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <unordered_map>
#include <utility>
#include <vector>

#include "specular/cell_bounds.h"
#include "specular/cell_bvh.h"
#include "specular/self_occlusion.h"
#include "specular/simd_bounds.h"

namespace trilens {

/// Grows one by one; forgets all at once and then uses the same memory again.
template <typename T>
class NodePool {
  public:
    T& add(const T& value) {
        if (size_ == kChunk * chunks_.size()) chunks_.push_back(std::make_unique<T[]>(kChunk));
        T& place = chunks_[size_ / kChunk][size_ % kChunk];
        place = value;
        ++size_;
        return place;
    }
    void clear() { size_ = 0; }
    std::size_t size() const { return size_; }

  private:
    static constexpr std::size_t kChunk = 64;

    std::vector<std::unique_ptr<T[]>> chunks_;
    std::size_t size_ = 0;
};

/// A group of faces or a cell, with what does not depend on the point.
struct TreeNode {
    PlaceBounds place;
    EyeView view;                              // of a cell that the surface hides: behind the camera
    int looks_left = 0;                        // of a cell: how often more cells within are asked if hidden
    CellBox box;                               // of a cell
    const SurfaceBounds* bounds = nullptr;     // of a cell; null for a group
    std::size_t group = 0;                     // of a group: its index
    const SurfaceCell* stored = nullptr;       // of a cell that others may come to as well
    const CellTerms* terms = nullptr;          // of a cell, where terms_of was asked
    std::uint32_t asked_by = 0;                // of a cell: which group of points asked the Newton operator,
    LaneBits asked = 0, open = 0, narrow = 0;  // for which of them, and what it said
    bool is_halved = false;                    // whether `halves` is known
    TreeNode* halves[2] = {nullptr,
                           nullptr};  // null: has nothing of the face; a leaf group has its cell alone
};

/// Grows on request: one thread each. Surface cells must live longer.
class ViewTree {
  public:
    /// For all queries that differ from this in the point alone. Cells that the surface itself hides from
    /// the eye are taken for such behind the camera, where `cells` have an occluder and it `asks_rays`.
    ViewTree(const Surface& surface, const CellBvh& cells, const SpecularQuery& query, bool asks_rays = true);

    /// Forgets all nodes: none that it gave is valid after.
    void begin_anew();
    /// The whole surface; null where there are no cells.
    TreeNode* root() const { return root_; }
    /// The cell of a whole face.
    TreeNode& face(Id face);
    /// Fills in the node's halves.
    void halve(TreeNode& node);
    /// For a cell whose bounds leave the eye outside.
    const CellTerms& terms_of(TreeNode& cell);
    std::size_t size() const { return nodes_.size(); }

  private:
    TreeNode* add(const PlaceBounds& place);
    TreeNode* add_group(std::size_t index);
    TreeNode* add_cell(const CellBox& box, const SurfaceBounds& bounds, const SurfaceCell* stored,
                       int looks_left);
    TreeNode* add_stored(const SurfaceCell& cell, int looks_left);
    TreeNode* add_fresh(const CellBox& box, int looks_left);
    void look_at(TreeNode& cell);

    const Surface& surface_;
    const CellBvh& cells_;
    const SpecularQuery query_;
    const SelfOcclusion occlusion_;
    const bool may_hide_;
    NodePool<TreeNode> nodes_;
    NodePool<SurfaceBounds> fresh_;
    NodePool<CellTerms> terms_;
    std::vector<TreeNode*> faces_;
    std::unordered_map<const SurfaceCell*, InSight> in_sight_;  // what was asked, also by nodes forgotten
    TreeNode* root_ = nullptr;
};

}  // namespace trilens
