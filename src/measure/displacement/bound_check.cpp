// Bounds of displacement that a picture says are proven, against its measured displacement.
#include <algorithm>
#include <array>
#include <cmath>

#include "measure/common/comparable.h"
#include "measure/displacement/displacement.h"
#include "measure/field/patch.h"
#include "measure/field/position_field.h"

namespace trilens {
namespace {

constexpr int kReach = 2;             // of the 5 x 5 pixels
constexpr double kLeastShift = 0.01;  // pixels; of which a ratio says something

/// Whether the field shows one triangle through one optic in all pixels around.
bool is_one_piece(const PositionField& field, int column, int row) {
    if (column < kReach || row < kReach || column + kReach >= field.width || row + kReach >= field.height)
        return false;
    const std::size_t middle = field.index(column, row);
    const SurfaceId piece{(*field.object)[middle], field.optic_of(middle), field.primitive_of(middle)};
    for (int y = row - kReach; y <= row + kReach; ++y)
        for (int x = column - kReach; x <= column + kReach; ++x)
            if (!field.shows(field.index(x, y), piece)) return false;
    return true;
}

/// Five points in a row, of pixels.
using FivePoints = std::array<Vec3, 5>;

/// Whether patches over these pixels are cubics through them: third differences are small against steps.
bool is_smooth(const FivePoints& p) {
    const Vec3 before = p[3] - 3.0 * p[2] + 3.0 * p[1] - p[0], after = p[4] - 3.0 * p[3] + 3.0 * p[2] - p[1];
    const double third = std::max(dot(before, before), dot(after, after));
    const Vec3 left = p[2] - p[1], right = p[3] - p[2];
    return third <= kSmoothThird * std::max(dot(left, left), dot(right, right));
}

/// How far, in pixels, what a cubic says between pixels may be from where it is: the field's fourth
/// differences by the inverse of its first ones; 3/128 of them along each axis, doubled for what is left out.
double interpolation_error(const FivePoints& x, const FivePoints& y) {
    const Vec3 dx = 0.5 * (x[3] - x[1]), dy = 0.5 * (y[3] - y[1]);
    const double xx = dot(dx, dx), xy = dot(dx, dy), yy = dot(dy, dy), determinant = xx * yy - xy * xy;
    double sum = 0;
    for (const FivePoints* p : {&x, &y}) {
        const Vec3 fourth = (*p)[0] - 4.0 * (*p)[1] + 6.0 * (*p)[2] - 4.0 * (*p)[3] + (*p)[4];
        const double along_x = dot(dx, fourth), along_y = dot(dy, fourth);
        sum += std::hypot(yy * along_x - xy * along_y, xx * along_y - xy * along_x);
    }
    return 2 * 3.0 / 128 * sum / determinant;
}

/// Whether what is measured in a pixel, by those around, is good to kBoundRoom.
bool is_well_measured(const PositionField& field, int column, int row) {
    if (!is_one_piece(field, column, row)) return false;
    FivePoints x, y;
    for (int k = -kReach; k <= kReach; ++k) {
        const auto at = static_cast<std::size_t>(k + kReach);
        x[at] = field.point(field.index(column + k, row));
        y[at] = field.point(field.index(column, row + k));
    }
    return is_smooth(x) && is_smooth(y) && interpolation_error(x, y) < kBoundRoom;
}

}  // namespace

std::optional<BoundCheck> check_bounds(const Image& reference, const Image& test, const std::string& layer,
                                       const Displacement& displacement) {
    const Channel* const bound = test.find(kBoundChannel);
    std::optional<PositionField> field = make_seen_field(reference, layer);
    if (!bound || !field || displacement.state.empty()) return std::nullopt;
    link_neighbours(*field);
    const std::vector<std::uint8_t> is_near_fold = near_folds(*field);
    BoundCheck check;
    std::vector<double> ratios;
    for (int row = 0; row < field->height; ++row)
        for (int column = 0; column < field->width; ++column) {
            const std::size_t i = field->index(column, row);
            const double proven = double{bound->floats()[i]};
            if (!(proven > 0) || displacement.state[i] != Shift::kFound || is_near_fold[i] ||
                !is_well_measured(*field, column, row))
                continue;
            const double shift = std::hypot(double{displacement.shift_x[i]}, double{displacement.shift_y[i]});
            ++check.pixels;
            check.beyond += shift > proven + kBoundRoom;
            check.excess = std::max(check.excess.value_or(shift - proven), shift - proven);
            if (shift > kLeastShift) ratios.push_back(proven / shift);
        }
    if (!ratios.empty()) {
        check.tightness_max = *std::max_element(ratios.begin(), ratios.end());
        check.tightness_p50 = summarize(std::move(ratios)).p50;
    }
    return check;
}

}  // namespace trilens
