#include "measure/displacement/image_query.h"

#include <algorithm>
#include <cmath>

namespace trilens {
namespace {

/// The square of the distance from a pixel to a rectangle of the screen, both in pixel centres.
double squared_distance_to(const FieldSample& from, double x0, double y0, double x1, double y1) {
    const double dx = std::max({x0 - from.column, from.column - x1, 0.0});
    const double dy = std::max({y0 - from.row, from.row - y1, 0.0});
    return dx * dx + dy * dy;
}

/// A little more than the rounding of distances.
constexpr double kMore = 1 + 1e-9;

/// Whether the reference's own pixel belongs to a piece of the wanted object that is wide enough for a slope.
bool has_patch(const ImageFinder& finder, const FieldSample& wanted) {
    for (int corner = 0; corner < 4; ++corner) {
        const PatchPlace place{wanted.column - corner % 2, wanted.row - corner / 2, corner};
        if (finder.reference().wholeness(place.column, place.row) ||
            make_patch(finder.reference().field, finder.test().field, place, piece_of(wanted)))
            return true;
    }
    return false;
}

}  // namespace

void ImageQuery::begin(const ImageFinder& finder, const FieldSample& wanted, double reach,
                       const std::optional<Vec2>& guess) {
    finder_ = &finder;
    wanted_ = wanted;
    guess_ = guess;
    stage_ = Stage::kNear;
    best_score_ = reach + kMostPenalty;
    best_shift_.reset();
    near_ = 0;
    corner_ = 4;
    any_ = true;
    cells_ = {};

    const PositionField& field = finder.reference().field;
    const std::size_t here = field.index(wanted.column, wanted.row);
    is_shown_ = field.shows(here, piece_of(wanted));
    if (is_shown_ && field.point(here) == wanted.point) {
        // The same pixel shows the same point, to the last bit.
        best_shift_ = Vec2(0);
        stage_ = Stage::kEnd;
        return;
    }
    side_ = likely_side(field, wanted);
}

bool ImageQuery::next(PatchBatch& batch, std::size_t lane, PatchCache& patches) {
    while (stage_ != Stage::kEnd) {
        if (next_patch(batch, lane, patches)) return true;
        if (next_cell()) continue;
        if (stage_ == Stage::kWaiting) return false;
        stage_ = Stage::kEnd;
    }
    return false;
}

// --- Cells ---

bool ImageQuery::next_cell() {
    if (stage_ == Stage::kNear) {
        // Only the four cells round the pixel reach nearer than one pixel: a hit there that is nearer ends
        // the search. The likeliest comes first; within a quarter of a pixel it is not asked whether another
        // image lies nearer still.
        while (near_ < 4) {
            if (best_shift_ && best_score_ < kSurelyNearest) return false;
            if (begin_near_cell()) return true;
        }
        if (best_shift_ && best_score_ < kSurelyNearest) return false;
        if (!begin_search()) return false;
        stage_ = Stage::kGuess;
        if (begin_guess()) return true;
    }
    if (stage_ == Stage::kGuess) stage_ = Stage::kWaiting;
    return stage_ == Stage::kSearch && begin_found_cell();
}

bool ImageQuery::begin_near_cell() {
    const int dx = near_ % 2 ? -side_[0] : side_[0], dy = near_ / 2 ? -side_[1] : side_[1];
    ++near_;
    const int column = wanted_.column + std::min(dx, 0), row = wanted_.row + std::min(dy, 0);
    return finder_->reference().may_show(wanted_.point, column, row) && begin_cell(column, row);
}

/// What a line of pixels says, and whether and how far to look on.
bool ImageQuery::begin_search() {
    if (is_shown_ && !has_patch(*finder_, wanted_)) {
        const std::optional<Vec2> shift = find_along_sliver(finder_->reference().field, wanted_);
        if (shift && glm::length(*shift) < best_score_) {
            best_score_ = glm::length(*shift);
            best_shift_ = shift;
        }
    }
    if (best_shift_ && best_score_ <= 1) return false;
    best_score_ =
        std::min(best_score_, farthest_place(finder_->reference().field, finder_->test().field, wanted_));
    return true;
}

bool ImageQuery::is_near_cell(int column, int row) const {
    return (column == wanted_.column || column == wanted_.column - 1) &&
           (row == wanted_.row || row == wanted_.row - 1);
}

/// Whether a hit at such a squared distance may be the best or as good. All that may be are tried, so that
/// the order of trials does not matter.
bool ImageQuery::may_improve(double distance) const {
    return distance <= squared_reach();
}

/// The cell of the guess first: a good hit there leaves little to search.
bool ImageQuery::begin_guess() {
    if (!guess_) return false;
    const FieldPyramid& index = finder_->reference();
    const double x = std::floor(wanted_.column + guess_->x), y = std::floor(wanted_.row + guess_->y);
    if (!(x >= -1 && x < index.field.width && y >= -1 && y < index.field.height)) return false;
    const int column = static_cast<int>(x), row = static_cast<int>(y);
    if (is_near_cell(column, row) || !may_improve(squared_distance_to(wanted_, x, y, x + 1, y + 1)) ||
        !index.may_show(wanted_.point, column, row))
        return false;
    return begin_cell(column, row);
}

double ImageQuery::squared_reach() const {
    return kMore * best_score_ * best_score_;
}

std::optional<CandidateCell> ImageQuery::candidate(int column, int row) const {
    if (is_near_cell(column, row)) return std::nullopt;
    const double distance = squared_distance_to(wanted_, column, row, column + 1, row + 1);
    if (!may_improve(distance) || !finder_->reach_of(column, row).may_hold(wanted_.point))
        return std::nullopt;
    return CandidateCell{column, row, distance};
}

void ImageQuery::give(std::span<const CandidateCell> cells) {
    cells_ = cells;
    stage_ = Stage::kSearch;
}

/// The nearest first, as long as one may hold the point nearer than the best hit so far.
bool ImageQuery::begin_found_cell() {
    while (!cells_.empty()) {
        const CandidateCell cell = cells_.front();
        if (!may_improve(cell.distance)) return false;
        cells_ = cells_.subspan(1);
        if (begin_cell(cell.column, cell.row)) return true;
    }
    return false;
}

// --- Patches of a cell ---

/// False where the cell has nothing of the wanted object.
bool ImageQuery::begin_cell(int column, int row) {
    const FieldPyramid& index = finder_->reference();
    if (index.wholeness(column, row) && !index.field.shows(index.field.index(column, row), piece_of(wanted_)))
        return false;
    column_ = column;
    row_ = row;
    corner_ = 0;
    same_primitive_ = true;
    any_ = false;
    tried_ = 0;
    return true;
}

/// Tries every piece of the wanted object and optic that has a pixel among the cell's corners: first of the
/// point's own triangle, then, where none of those was solid enough to be tried, of any.
bool ImageQuery::next_patch(PatchBatch& batch, std::size_t lane, PatchCache& patches) {
    for (;;) {
        while (corner_ < 4)
            if (put_patch(corner_++, batch, lane, patches)) return true;
        if (any_ || !same_primitive_) return false;
        same_primitive_ = false;
        corner_ = 0;
        tried_ = 0;
    }
}

bool ImageQuery::put_patch(int corner, PatchBatch& batch, std::size_t lane, PatchCache& patches) {
    const FieldPyramid& index = finder_->reference();
    const PositionField& field = index.field;
    const int x = column_ + corner % 2, y = row_ + corner / 2;
    if ((tried_ >> kCellCorner[static_cast<std::size_t>(corner)]) & 1 || !field.contains(x, y)) return false;
    SurfaceId piece = piece_of(wanted_);
    if (same_primitive_) piece.primitive = wanted_.primitive;
    if (!field.shows(field.index(x, y), piece)) return false;

    const Vec2 from = glm::clamp(Vec2(wanted_.column - column_, wanted_.row - row_), Vec2(0), Vec2(1));
    const std::uint8_t asked = same_primitive_ ? FieldPyramid::kWholeTriangle : FieldPyramid::kWhole;
    if (index.wholeness(column_, row_) & asked) {
        any_ = true;
        tried_ = 0xffff;
        for (std::size_t b = 0; b < 4; ++b) {
            const std::size_t first = field.index(column_ - 1, row_ - 1 + static_cast<int>(b));
            for (std::size_t a = 0; a < 4; ++a)
                batch.set_node(lane, a + 4 * b, field.point(first + a) - wanted_.point);
        }
        batch.ask(lane, wanted_.point, from, 0xffff);
        return true;
    }
    const std::optional<Patch>& patch = patches.get({column_, row_, corner}, same_primitive_);
    if (!patch) return false;
    any_ = true;
    tried_ |= patch->measured;
    for (std::size_t i = 0; i < 16; ++i) batch.set_node(lane, i, patch->nodes[i] - wanted_.point);
    batch.ask(lane, wanted_.point, from, patch->supported);
    return true;
}

void ImageQuery::take(const PatchBatch& batch, std::size_t lane) {
    if (!batch.has_hit(lane)) return;
    const Vec2 uv(batch.u.lane[lane], batch.v.lane[lane]);
    const Vec2 shift = uv + (Vec2(column_, row_) - Vec2(wanted_.column, wanted_.row));
    const double score = glm::length(shift) + kOvershootPenalty * batch.overshoot.lane[lane] +
                         (same_primitive_ ? 0 : kOtherPrimitivePenalty);
    // Of two that are as good the one that is farther up, then left, whichever was tried first.
    const bool is_tie = score == best_score_ && best_shift_ && stage_ != Stage::kNear;
    const bool is_first =
        is_tie && (shift.y < best_shift_->y || (shift.y == best_shift_->y && shift.x < best_shift_->x));
    if (!(score < best_score_) && !is_first) return;
    best_score_ = score;
    best_shift_ = shift;
}

}  // namespace trilens
