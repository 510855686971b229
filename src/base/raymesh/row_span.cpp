#include "base/raymesh/row_span.h"

#include <algorithm>
#include <cmath>

namespace trilens {
namespace {

/// Where a x + d > least, in columns of samples, one column given away for the rounding of the quotient.
struct Columns {
    double begin = 0, end = 0;
};

/// A column's centre stands half a column behind its number.
double column_at(const SampleGrid& grid, double x) {
    return (x - grid.x0) * grid.side - 0.5;
}

/// `margin`: columns by which the range is made smaller at the end that the edge cuts; negative: larger.
Columns columns_above(const SampleGrid& grid, double slope, double rest, double margin) {
    if (slope > 0) return {std::ceil(column_at(grid, rest / slope)) + margin, INFINITY};
    if (slope < 0) return {-INFINITY, std::floor(column_at(grid, rest / slope)) + 1 - margin};
    return rest < 0 ? Columns{-INFINITY, INFINITY} : Columns{INFINITY, -INFINITY};
}

}  // namespace

FacetEdges::FacetEdges(const std::array<Vec3, 3>& corner, int orientation, const SampleGrid& grid)
    : grid_(grid) {
    // No coordinate of a corner relative to a sample is larger than `size`.
    const double reach_x = std::max(std::fabs(grid.x0), std::fabs(grid.x1));
    const double reach_y = std::max(std::fabs(grid.y0), std::fabs(grid.y1));
    double size = 0, depth = 0;
    for (const Vec3& c : corner) {
        depth = std::max(depth, std::fabs(c.z));
        size = std::max(
            {size, std::fabs(c.x) + reach_x * std::fabs(c.z), std::fabs(c.y) + reach_y * std::fabs(c.z)});
    }
    // With u = 2^-53: a corner relative to a sample, with the sample's own rounding, is off by 4 u size at
    // most, so that the edge function of those is off by 16 u size^2; the affine form, with products of at
    // most size^2 and seven roundings, by less than another 32 u size^2.
    bound_ = 0x1p-46 * size * size;
    for (std::size_t k = 0; k < 3; ++k) edge_[k] = cross(corner[k], corner[(k + 1) % 3]);

    // The determinant is the sum of the edge functions times the corners' depths. Where all corners are in
    // front and it is sure, its sign is the one that the edge functions have inside, and no sample sees the
    // three with the other.
    const double determinant = dot(corner[0], edge_[1]);
    const bool sure_sign = orientation != 0 || std::fabs(determinant) > 8 * bound_ * depth;
    const double sign = orientation != 0 ? orientation : determinant > 0 ? 1 : -1;
    for (Vec3& edge : edge_) edge = sign * edge;
    const bool ordinary = bound_ > 0x1p-900 && bound_ < 0x1p900;
    usable_ = sure_sign && ordinary;
}

RowSpan FacetEdges::cover(std::size_t row, std::size_t first, std::size_t last) const {
    RowSpan cover{first, first, first, last};
    if (!usable_) return cover;
    const double y = grid_.y0 + (static_cast<double>(row) + 0.5) / grid_.side;
    Columns sure{-INFINITY, INFINITY}, may = sure;
    const auto intersect = [](Columns& a, const Columns& b) {
        a = {std::max(a.begin, b.begin), std::min(a.end, b.end)};
    };
    for (const Vec3& edge : edge_) {
        const double rest = edge.y * y + edge.z;
        intersect(sure, columns_above(grid_, edge.x, bound_ - rest, 1));
        intersect(may, columns_above(grid_, edge.x, -bound_ - rest, -1));
    }
    const auto place = [&](double column) {
        return static_cast<std::size_t>(
            std::clamp(column, static_cast<double>(first), static_cast<double>(last)));
    };
    cover.begin = place(may.begin);
    cover.end = std::max(cover.begin, place(may.end));
    cover.sure_begin = std::clamp(place(sure.begin), cover.begin, cover.end);
    cover.sure_end = std::clamp(place(sure.end), cover.sure_begin, cover.end);
    return cover;
}

}  // namespace trilens
