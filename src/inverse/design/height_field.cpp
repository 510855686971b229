#include "inverse/design/height_field.h"

#include <algorithm>
#include <cmath>

namespace trilens {
namespace {

/// Weights of the four control values around a place, and of its first and second derivatives; `t` in 0..1 of
/// the middle interval. Source: de Boor, A Practical Guide to Splines.
struct CubicWeights {
    std::array<double, 4> value{}, first{}, second{};
};

CubicWeights cubic_weights(double t) {
    const double s = 1 - t;
    return {{s * s * s / 6, (3 * t * t * t - 6 * t * t + 4) / 6, (3 * s * s * s - 6 * s * s + 4) / 6,
             t * t * t / 6},
            {-s * s / 2, (3 * t * t - 4 * t) / 2, -(3 * s * s - 4 * s) / 2, t * t / 2},
            {s, 3 * t - 2, 3 * s - 2, t}};
}

}  // namespace

HeightField::HeightField(const Vec2& sides, const std::array<int, 2>& counts)
    : size(sides),
      controls(counts),
      heights(static_cast<std::size_t>(counts[0]) * static_cast<std::size_t>(counts[1])) {}

Vec2 HeightField::spacing() const {
    return {size.x / (controls[0] - 3), size.y / (controls[1] - 3)};
}

Vec2 HeightField::control_place(int column, int row) const {
    return Vec2(column - 1, row - 1) * spacing() - 0.5 * size;
}

HeightBasis HeightField::basis(const Vec2& at) const {
    const Vec2 step = spacing(), in = (at + 0.5 * size) / step;
    const int column = std::clamp(static_cast<int>(std::floor(in.x)), 0, controls[0] - 4),
              row = std::clamp(static_cast<int>(std::floor(in.y)), 0, controls[1] - 4);
    const CubicWeights across = cubic_weights(in.x - column), up = cubic_weights(in.y - row);
    HeightBasis result;
    for (std::size_t j = 0; j < 4; ++j)
        for (std::size_t i = 0; i < 4; ++i) {
            const std::size_t k = 4 * j + i;
            result.index[k] = (static_cast<std::size_t>(row) + j) * static_cast<std::size_t>(controls[0]) +
                              static_cast<std::size_t>(column) + i;
            result.z[k] = across.value[i] * up.value[j];
            result.x[k] = across.first[i] * up.value[j] / step.x;
            result.y[k] = across.value[i] * up.first[j] / step.y;
            result.xx[k] = across.second[i] * up.value[j] / (step.x * step.x);
            result.xy[k] = across.first[i] * up.first[j] / (step.x * step.y);
            result.yy[k] = across.value[i] * up.second[j] / (step.y * step.y);
        }
    return result;
}

Height HeightField::height(const Vec2& at) const {
    const HeightBasis b = basis(at);
    Height h;
    for (std::size_t k = 0; k < 16; ++k) {
        const double c = heights[b.index[k]];
        h.z += b.z[k] * c, h.x += b.x[k] * c, h.y += b.y[k] * c;
        h.xx += b.xx[k] * c, h.xy += b.xy[k] * c, h.yy += b.yy[k] * c;
    }
    return h;
}

double largest_curvature(const Height& h) {
    // First and second fundamental forms of a graph (do Carmo, section 3-3).
    const double e = 1 + h.x * h.x, f = h.x * h.y, g = 1 + h.y * h.y, w = std::sqrt(e * g - f * f);
    const double gauss = (h.xx * h.yy - h.xy * h.xy) / (w * w * w * w);
    const double mean = (e * h.yy - 2 * f * h.xy + g * h.xx) / (2 * w * w * w);
    return std::abs(mean) + std::sqrt(std::max(0.0, mean * mean - gauss));
}

}  // namespace trilens
