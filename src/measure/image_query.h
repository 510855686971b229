// The search for one point, step by step: each step is a patch to be inverted.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "base/vec.h"
#include "measure/image_finder.h"
#include "measure/patch_batch.h"
#include "measure/patch_cache.h"

namespace trilens {

/// Begun once per point, then asked for its next patch and told the answer, until it has no next one.
class ImageQuery {
  public:
    /// `guess`: a shift that is likely; it makes the search shorter, and changes nothing else.
    void begin(const ImageFinder& finder, const SeenPoint& wanted, double reach,
               const std::optional<Vec2>& guess);

    /// Puts the next patch into a lane of the batch; false at the end. `patches`: of the finder's reference.
    bool next(PatchBatch& batch, std::size_t lane, PatchCache& patches);
    /// What the batch says of that patch.
    void take(const PatchBatch& batch, std::size_t lane);

    /// At the end: the place that was found, as ImageFinder::find returns it.
    const std::optional<Vec2>& shift() const { return best_shift_; }

  private:
    enum class Stage { kNear, kGuess, kSearch, kEnd };
    struct Node {
        int level, column, row;
        double distance;  // squared, pixels
    };

    bool next_cell();
    bool begin_near_cell();
    bool begin_search();
    bool begin_guess();
    bool begin_found_cell();
    bool begin_cell(int column, int row);
    bool is_near_cell(int column, int row) const;
    bool may_improve(double distance) const;
    void push(const Node& node);
    void push_children(const Node& node);
    bool next_patch(PatchBatch& batch, std::size_t lane, PatchCache& patches);
    bool put_patch(int corner, PatchBatch& batch, std::size_t lane, PatchCache& patches);

    const ImageFinder* finder_ = nullptr;
    SeenPoint wanted_;
    std::optional<Vec2> guess_;
    Stage stage_ = Stage::kEnd;

    double best_score_ = 0;  // pixels; distance and penalties
    std::optional<Vec2> best_shift_;

    std::array<int, 2> side_{};  // which way the point lies
    int near_ = 0;               // of the four cells round the pixel, how many have been begun
    bool is_shown_ = false;      // the reference's pixel shows the point's object

    int column_ = 0, row_ = 0;  // of the cell under way
    int corner_ = 4;            // its next
    bool same_primitive_ = true, any_ = false;
    std::uint16_t tried_ = 0;  // nodes of the patches that have been tried

    std::array<Node, 4 * 32> stack_;  // four children per level, and fewer than 32 levels
    std::size_t nodes_ = 0;
};

}  // namespace trilens
