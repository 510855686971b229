// The search for one point, step by step: each step is a patch to be inverted. Neighbouring pixels ask for
// the same patches again and again, so those made of late are kept.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "base/math/vec.h"
#include "measure/displacement/image_finder.h"
#include "measure/field/field_pyramid.h"
#include "measure/field/patch.h"
#include "measure/field/patch_batch.h"

namespace trilens {

/// One thread's. A patch is the same whether it was kept or is made.
class PatchCache {
  public:
    /// `other`: as make_patch has it. Both must outlive it.
    PatchCache(const FieldPyramid& index, const PositionField& other)
        : index_(index), other_(other), entries_(kEntries) {}

    /// make_patch of the piece that the corner of the cell shows, of its own triangle alone or whole. Stays
    /// until the next call.
    const std::optional<Patch>& get(const PatchPlace& place, bool is_triangle) {
        const std::size_t key =
            (index_.cell_number(place.column, place.row) * 4 + static_cast<std::size_t>(place.corner)) * 2 +
            (is_triangle ? 1 : 0);
        Entry& entry = entries_[(key ^ key >> 9) % kEntries];
        if (entry.key != key + 1) {
            entry.patch = make(place, is_triangle);
            entry.key = key + 1;
        }
        return entry.patch;
    }

  private:
    static constexpr std::size_t kEntries = 2048;
    struct Entry {
        std::size_t key = 0;  // one more than the patch's; 0: none yet
        std::optional<Patch> patch;
    };

    std::optional<Patch> make(const PatchPlace& place, bool is_triangle) const {
        const PositionField& field = index_.field;
        const FieldSample seen =
            field.seen_point(field.index(place.column + place.corner % 2, place.row + place.corner / 2));
        SurfaceId piece{seen.object, seen.optic, std::nullopt};
        if (is_triangle) piece.primitive = seen.primitive;
        return make_patch(field, other_, place, piece);
    }

    const FieldPyramid& index_;
    const PositionField& other_;
    std::vector<Entry> entries_;
};

/// A cell that may show a point, and the square of its distance from the point's pixel.
struct CandidateCell {
    int column = 0, row = 0;
    double distance = 0;
};

/// Begun once per point, then asked for its next patch and told the answer, until it has no next one. Where
/// it then waits for cells, the search goes on with those.
class ImageQuery {
  public:
    /// `guess`: a shift that is likely; it makes the search shorter, and changes nothing else.
    void begin(const ImageFinder& finder, const FieldSample& wanted, double reach,
               const std::optional<Vec2>& guess);

    /// Puts the next patch into a lane of the batch; false at the end, and where it waits for cells.
    /// `patches`: of the finder's reference.
    bool next(PatchBatch& batch, std::size_t lane, PatchCache& patches);
    /// What the batch says of that patch.
    void take(const PatchBatch& batch, std::size_t lane);

    /// All but those next to the pixel have to be looked through.
    bool waits_for_cells() const { return stage_ == Stage::kWaiting; }
    const FieldSample& wanted() const { return wanted_; }
    /// Cells whose squared distance is more show nothing better.
    double squared_reach() const;
    /// The cell, if the point may be seen there and it has not been tried; nothing else.
    std::optional<CandidateCell> candidate(int column, int row) const;
    /// The search goes on with them. They are the nearest first, and stay where they are.
    void give(std::span<const CandidateCell> cells);

    /// At the end: the place that was found, as ImageFinder::find returns it.
    const std::optional<Vec2>& shift() const { return best_shift_; }

  private:
    enum class Stage { kNear, kGuess, kWaiting, kSearch, kEnd };

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
    FieldSample wanted_;
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

    std::span<const CandidateCell> cells_;  // that are left
};

}  // namespace trilens
