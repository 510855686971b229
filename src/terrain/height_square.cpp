#include "terrain/height_square.h"

#include <algorithm>
#include <cmath>

#include "base/util/check.h"
#include "base/util/parallel.h"

namespace trilens {
namespace {

/// Beyond the last of `known` values: twice that one less the value as far before it.
template <typename Value>
float reflected(int i, int known, const Value& value) {
    const int last = known - 1;
    return 2 * value(last) - value(std::max(0, 2 * last - i));
}

}  // namespace

HeightSquare::HeightSquare(const HeightGrid& heights, double no_data)
    : columns_(heights.columns), rows_(heights.rows) {
    TRILENS_CHECK(columns_ >= 2 && rows_ >= 2, "a terrain has a cell");
    while (side_ < std::max(columns_, rows_)) {
        ++levels_;
        side_ = (1 << levels_) + 1;
    }
    const auto side = static_cast<std::size_t>(side_);
    values_.resize(side * side);
    const auto is_height = [&](float value) {
        return std::isfinite(value) && !heights.stands_for(value, no_data);
    };
    missing_ = static_cast<std::size_t>(std::count_if(heights.values.begin(), heights.values.end(),
                                                      [&](float value) { return !is_height(value); }));
    if (missing_ > 0) is_missing_.assign(values_.size(), 0);
    parallel_for(static_cast<std::size_t>(rows_), kRowsPerTask, [&](std::size_t first, std::size_t last) {
        for (int y = static_cast<int>(first); y < static_cast<int>(last); ++y) {
            for (int x = 0; x < columns_; ++x) {
                const float value = heights.at(x, y);
                const bool known = is_height(value);
                values_[index(x, y)] = known ? value : 0;
                if (!known) is_missing_[index(x, y)] = 1;
            }
            for (int x = columns_; x < side_; ++x)
                values_[index(x, y)] = reflected(x, columns_, [&](int i) { return values_[index(i, y)]; });
        }
    });
    parallel_for(side, kRowsPerTask, [&](std::size_t first, std::size_t last) {
        for (int y = rows_; y < side_; ++y)
            for (int x = static_cast<int>(first); x < static_cast<int>(last); ++x)
                values_[index(x, y)] = reflected(y, rows_, [&](int i) { return values_[index(x, i)]; });
    });
}

bool HeightSquare::touches_missing(int x, int y) const {
    if (missing_ == 0) return false;
    for (int dy = -1; dy <= 1; ++dy)
        for (int dx = -1; dx <= 1; ++dx)
            if (x + dx >= 0 && y + dy >= 0 && is_missing(x + dx, y + dy)) return true;
    return false;
}

bool diagonal_falls(int x, int y, int half) {
    return ((x - half) / (2 * half) + (y - half) / (2 * half)) % 2 == 0;
}

HalvedSide halved_side(int x, int y, int half) {
    const bool odd_x = (x / half) % 2 != 0, odd_y = (y / half) % 2 != 0;
    if (odd_x && odd_y) return {half, diagonal_falls(x, y, half) ? half : -half};
    return odd_x ? HalvedSide{half, 0} : HalvedSide{0, half};
}

double bisection_detail(const HeightSquare& heights, int x, int y, int half) {
    const auto [dx, dy] = halved_side(x, y, half);
    return heights.at(x, y) - 0.5 * (heights.at(x - dx, y - dy) + heights.at(x + dx, y + dy));
}

}  // namespace trilens
