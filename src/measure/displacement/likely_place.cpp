#include "measure/displacement/likely_place.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "measure/displacement/slope.h"

namespace trilens {

std::array<int, 2> likely_side(const SeenField& field, const SeenPoint& wanted) {
    const std::size_t here = field.index(wanted.column, wanted.row),
                      below = static_cast<std::size_t>(field.width);
    if (!field.sees(here)) return {1, 1};
    const Vec3 p = field.point(here), offset = wanted.point - p;
    Vec3 du(0), dv(0);
    if (field.links[here] & SeenField::kRight)
        du = field.point(here + 1) - p;
    else if (wanted.column > 0 && (field.links[here - 1] & SeenField::kRight))
        du = p - field.point(here - 1);
    if (field.links[here] & SeenField::kDown)
        dv = field.point(here + below) - p;
    else if (wanted.row > 0 && (field.links[here - below] & SeenField::kDown))
        dv = p - field.point(here - below);
    const double a = dot(du, du), b = dot(du, dv), d = dot(dv, dv), g0 = dot(du, offset),
                 g1 = dot(dv, offset);
    return {d * g0 - b * g1 < 0 ? -1 : 1, a * g1 - b * g0 < 0 ? -1 : 1};
}

double farthest_place(const SeenField& field, const SeenField& test, const SeenPoint& wanted) {
    static const double kAway[] = {0, 1, std::hypot(1.0, 1.0)};
    const Piece piece = piece_of(wanted);
    const Slopes test_slopes = slopes_at(test, wanted.column, wanted.row);
    double least = std::numeric_limits<double>::infinity();
    for (int row = wanted.row - 1; row <= wanted.row + 1; ++row) {
        for (int column = wanted.column - 1; column <= wanted.column + 1; ++column) {
            if (!field.contains(column, row) || !field.shows(field.index(column, row), piece)) continue;
            const Vec3 step = wanted.point - field.point(field.index(column, row));
            const std::optional<double> there = pixels_for(test_slopes, step);
            const double away = kAway[std::abs(column - wanted.column) + std::abs(row - wanted.row)];
            // The slopes here only make it more.
            if (away + 1 + 4 * there.value_or(0) >= least) continue;
            const std::optional<double> here = pixels_for(slopes_at(field, column, row), step);
            // A single pixel next door says nothing of where it ends; one at the same place is the same spot.
            if (!here && !there && away > 0) continue;
            least = std::min(least, away + 1 + 4 * std::max(here.value_or(0), there.value_or(0)));
        }
    }
    return least;
}

}  // namespace trilens
