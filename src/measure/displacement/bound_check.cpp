// Bounds of displacement that a picture says are proven, against its measured displacement.
#include <algorithm>
#include <array>
#include <cmath>

#include "measure/common/comparable.h"
#include "measure/displacement/displacement.h"
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

/// How far, in pixels, what lies between pixels may be from where it is by interpolation: the field's second
/// differences, by the inverse of its first ones.
double interpolation_error(const PositionField& field, int column, int row) {
    const auto at = [&](int x, int y) { return field.point(field.index(column + x, row + y)); };
    const Vec3 middle = at(0, 0);
    const Vec3 dx = 0.5 * (at(1, 0) - at(-1, 0)), dy = 0.5 * (at(0, 1) - at(0, -1));
    const std::array seconds{at(1, 0) + at(-1, 0) - 2.0 * middle, at(0, 1) + at(0, -1) - 2.0 * middle,
                             0.5 * (at(1, 1) + at(-1, -1) - at(1, -1) - at(-1, 1))};
    const double xx = dot(dx, dx), xy = dot(dx, dy), yy = dot(dy, dy), determinant = xx * yy - xy * xy;
    double sum = 0;
    for (const Vec3& second : seconds) {
        const double x = dot(dx, second), y = dot(dy, second);
        sum += std::hypot(yy * x - xy * y, xx * y - xy * x);
    }
    return sum / (8 * determinant);
}

/// Whether what is measured in a pixel, whose place is interpolated from those around, is good to kBoundRoom.
bool is_well_measured(const PositionField& field, int column, int row) {
    if (!is_one_piece(field, column, row)) return false;
    for (int y = row - 1; y <= row + 1; ++y)
        for (int x = column - 1; x <= column + 1; ++x)
            if (!(interpolation_error(field, x, y) < kBoundRoom)) return false;
    return true;
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
