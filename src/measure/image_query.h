// The search for one point, step by step: each step is a patch to be inverted.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>

#include "base/vec.h"
#include "measure/candidate_cells.h"
#include "measure/image_finder.h"
#include "measure/patch_batch.h"
#include "measure/patch_cache.h"

namespace trilens {

/// Begun once per point, then asked for its next patch and told the answer, until it has no next one.
class ImageQuery {
  public:
    /// What is asked: the place of one of the group's points, at most `reach` pixels away. `guess`: a shift
    /// that is likely; it makes the search shorter, and changes nothing else.
    struct Question {
        SeenPoint wanted;
        std::shared_ptr<PointGroup> group;
        double reach = 0;
        std::optional<Vec2> guess;
    };
    void begin(const ImageFinder& finder, Question question);

    /// Puts the next patch into a lane of the batch; false at the end. `patches`: of the finder's reference.
    bool next(PatchBatch& batch, std::size_t lane, PatchCache& patches);
    /// What the batch says of that patch.
    void take(const PatchBatch& batch, std::size_t lane);

    /// At the end: the place that was found, as ImageFinder::find returns it.
    const std::optional<Vec2>& shift() const { return best_shift_; }

  private:
    enum class Stage { kNear, kGuess, kSearch, kEnd };

    bool next_cell();
    bool begin_near_cell();
    bool begin_search();
    bool begin_guess();
    bool begin_found_cell();
    bool begin_cell(int column, int row);
    bool is_near_cell(int column, int row) const;
    bool may_improve(double distance) const;
    bool next_patch(PatchBatch& batch, std::size_t lane, PatchCache& patches);
    bool put_patch(int corner, PatchBatch& batch, std::size_t lane, PatchCache& patches);

    const ImageFinder* finder_ = nullptr;
    SeenPoint wanted_;
    std::shared_ptr<PointGroup> group_;
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

    std::shared_ptr<CandidateCells> candidates_;
    std::size_t next_quad_ = 0;
    unsigned left_in_quad_ = 0;  // bits of the cells of the last one that may hold the point
};

}  // namespace trilens
