#include "inverse/unwrap/photo.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/math/catmull_rom.h"

namespace trilens {

Vec3 sample_bicubic(const Texture& photo, const Vec2& at) {
    const double x = at.x - 0.5, y = at.y - 0.5, left = std::floor(x), top = std::floor(y);
    const std::array<double, 4> across = catmull_rom(x - left), down = catmull_rom(y - top);
    std::array<std::size_t, 4> column;
    for (int i = 0; i < 4; ++i)
        column[static_cast<std::size_t>(i)] =
            3 * static_cast<std::size_t>(std::clamp(left + i - 1, 0.0, photo.width - 1.0));
    Vec3 sum{0};
    for (int j = 0; j < 4; ++j) {
        const auto row = static_cast<std::size_t>(std::clamp(top + j - 1, 0.0, photo.height - 1.0));
        const float* values = photo.rgb.data() + 3 * row * static_cast<std::size_t>(photo.width);
        Vec3 line{0};
        for (std::size_t i = 0; i < 4; ++i) {
            const float* p = values + column[i];
            line += across[i] * Vec3(p[0], p[1], p[2]);
        }
        sum += down[static_cast<std::size_t>(j)] * line;
    }
    return glm::max(sum, Vec3(0));
}

Vec3 sample_footprint(const Texture& photo, const Vec2& at, const Mat2& jacobian) {
    // A pixel of the photograph is a mean over itself already: variances of boxes add up (L^2 / 12).
    std::array<int, 2> count{};
    Mat2 sides = jacobian;
    for (int k = 0; k < 2; ++k) {
        const double whole = length(jacobian[k]), left = std::sqrt(std::max(0.0, whole * whole - 1));
        sides[k] = whole > 1 ? left / whole * jacobian[k] : Vec2(0);
        count[static_cast<std::size_t>(k)] =
            std::clamp(static_cast<int>(std::ceil(left - 0.25)), 1, kMostFootprint);
    }
    const auto [m, n] = count;
    if (m == 1 && n == 1) return sample_bicubic(photo, at);
    Vec3 sum{0};
    for (int j = 0; j < n; ++j)
        for (int i = 0; i < m; ++i)
            sum += sample_bicubic(photo, at + sides * Vec2((i + 0.5) / m - 0.5, (j + 0.5) / n - 0.5));
    return sum / (double(m) * n);
}

}  // namespace trilens
