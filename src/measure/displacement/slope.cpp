#include "measure/displacement/slope.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace trilens {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kParallel = 1e-12;  // squared sine of the angle between two slopes

std::optional<Vec3> difference(const Vec3* before, const Vec3& here, const Vec3* after) {
    if (before && after) return 0.5 * (*after - *before);
    if (after) return *after - here;
    if (before) return here - *before;
    return std::nullopt;
}

double along_one(const Vec3& slope, const Vec3& step) {
    const double part = std::abs(dot(slope, step)), square = dot(slope, slope);
    if (square > 0) return part / square;
    return step == Vec3(0) ? 0 : kInfinity;
}

double along_two(const Vec3& right, const Vec3& down, const Vec3& step) {
    if (step == Vec3(0)) return 0;
    const double a = dot(right, right), b = dot(right, down), d = dot(down, down);
    const double determinant = a * d - b * b, g0 = dot(right, step), g1 = dot(down, step);
    if (!(determinant > kParallel * a * d)) return kInfinity;
    const Vec2 pixels = Vec2(d * g0 - b * g1, a * g1 - b * g0) / determinant;
    const double off_plane = length(step - pixels.x * right - pixels.y * down);
    return glm::length(pixels) + off_plane / std::sqrt(std::max(a, d));
}

}  // namespace

Slopes slopes_at(const SeenField& field, int column, int row) {
    const std::size_t i = field.index(column, row), stride = static_cast<std::size_t>(field.width);
    const auto along = [&](std::uint8_t link, bool has_before, std::size_t step) {
        const bool before = has_before && (field.links[i - step] & link), after = field.links[i] & link;
        const Vec3 p = before ? field.point(i - step) : Vec3(0), q = after ? field.point(i + step) : Vec3(0);
        return difference(before ? &p : nullptr, field.point(i), after ? &q : nullptr);
    };
    return {along(SeenField::kRight, column > 0, 1), along(SeenField::kDown, row > 0, stride)};
}

std::optional<double> pixels_for(const Slopes& slopes, const Vec3& step) {
    if (slopes.right && slopes.down) return along_two(*slopes.right, *slopes.down, step);
    if (slopes.right) return along_one(*slopes.right, step);
    if (slopes.down) return along_one(*slopes.down, step);
    return std::nullopt;
}

}  // namespace trilens
