// The prior of a search: where the image of a point is expected, by the field's slopes, and along slivers one
// pixel wide.
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
#include "measure/field/position_field.h"

namespace trilens {

/// Hits outside the cell are penalised, so the neighbouring cell wins ties; so are hits on another triangle,
/// which are less exact. Never less than the distance.
inline constexpr double kOvershootPenalty = 2, kOtherPrimitivePenalty = 0.25;
inline constexpr double kMostPenalty = 1;  // more than both together
static_assert(kOvershootPenalty * kOvershoot + kOtherPrimitivePenalty < kMostPenalty);

/// Pixels. Two images of one point this near to each other are the two sides of one fold.
inline constexpr double kSurelyNearest = 0.25;

/// The point's object and optic, whichever its triangle.
inline SurfaceId piece_of(const FieldSample& point) {
    return {point.object, point.optic, std::nullopt};
}

/// Which way from its pixel the point lies, by the slopes of the field (with its links) there: the signs of
/// its offset.
std::array<int, 2> likely_side(const PositionField& field, const FieldSample& wanted);

/// How far the displaced image of the point may lie, pixels, by the slopes of both images at the pixel. On
/// the way to it the seen point moves from what the reference shows at the pixel to the wanted one; near a
/// fold it moves up to twice as far as the slopes say, round a corner between two walls as far again.
/// Infinite where the reference shows something else all round the pixel.
double farthest_place(const PositionField& field, const PositionField& test, const FieldSample& wanted);

/// The change of the seen point per pixel to the right and down, between linked neighbours: over both where
/// there are two. Nothing along an axis on which the pixel has none.
struct Slopes {
    std::optional<Vec3> right, down;
};

/// `field` with its links; the pixel must be in it.
Slopes slopes_at(const PositionField& field, int column, int row);

/// How many pixels it takes to change what is seen by `step`, to first order. With two slopes the part of the
/// step that leaves their plane counts as if along the longer one. With one slope only the part along it
/// counts: of what lies across, a piece one pixel wide says nothing. Infinite where the slopes are too short
/// or too nearly parallel for the step; nothing without slopes.
std::optional<double> pixels_for(const Slopes& slopes, const Vec3& step);

/// Where `field` (with its links) shows the point along the row or the column of linked pixels through the
/// point's own pixel, which must see the point's piece: the screen vector to there from the pixel, along one
/// axis (of the two answers the shorter). Between pixels positions are interpolated, beyond the line's ends
/// continued by less than a pixel. Across the line the piece has no slope, so a shift across it goes
/// unmeasured. Nothing where the pixel has no such neighbour, or the point lies off the line by more than
/// kOffLine times the step between its pixels: it is seen elsewhere, or the shift is mostly across.
std::optional<Vec2> find_along_sliver(const PositionField& field, const FieldSample& wanted);

inline constexpr double kOffLine = 0.5;

// The search for one point, step by step: each step is a patch to be inverted. Neighbouring pixels ask for
// the same patches again and again, so those made of late are kept.

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
