// Uniform bicubic B-spline heights over a rectangle: a freeform surface as its designer has it.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "base/description/optic_description.h"
#include "base/math/vec.h"

namespace trilens {

/// A height with its derivatives at one (x, y).
struct Height {
    double z = 0, x = 0, y = 0;     // z, dz/dx, dz/dy
    double xx = 0, xy = 0, yy = 0;  // second derivatives
};

/// The 16 control points that a place depends on: index, and how height and slopes move with each.
struct HeightBasis {
    std::array<std::size_t, 16> index{};
    std::array<double, 16> z{}, x{}, y{}, xx{}, xy{}, yy{};
};

/// Heights over |x| <= size.x / 2, |y| <= size.y / 2. Beside the rectangle lies one row of control points
/// more on each side, so that it is the limit surface of the control net with no boundary interpolated.
struct HeightField {
    Vec2 size{1};
    std::array<int, 2> controls{4, 4};  // along x and y, 4 or more
    std::vector<double> heights;        // row by row, x fastest

    HeightField() = default;
    HeightField(const Vec2& sides, const std::array<int, 2>& counts);

    Vec2 spacing() const;
    /// Where a control point stands.
    Vec2 control_place(int column, int row) const;
    HeightBasis basis(const Vec2& at) const;
    Height height(const Vec2& at) const;
};

/// Larger of the principal curvatures' sizes, 1 / length.
double largest_curvature(const Height& at);

}  // namespace trilens
