#include "shade/lights/light_sample.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>

namespace trilens {

Vec2 stratified_place(std::size_t sample, std::size_t count) {
    // Base 2 with as many digits as there are samples: the reversed index is a stratum's number.
    const int digits = static_cast<int>(std::bit_width(count - 1));
    std::size_t reversed = 0;
    for (int d = 0; d < digits; ++d) reversed |= ((sample >> d) & 1) << (digits - 1 - d);
    return {(static_cast<double>(sample) + 0.5) / static_cast<double>(count),
            (static_cast<double>(reversed) + 0.5) / static_cast<double>(std::size_t{1} << digits)};
}

TangentBasis tangent_basis(const Vec3& normal) {
    const double sign = std::copysign(1.0, normal.z);
    const double a = -1 / (sign + normal.z), b = normal.x * normal.y * a;
    return {{1 + sign * normal.x * normal.x * a, sign * b, -sign * normal.x},
            {b, sign + normal.y * normal.y * a, -normal.y}};
}

Vec2 recurrent_place(std::size_t index) {
    const auto steps = static_cast<double>(index);
    const Vec2 place = Vec2(0.5) + steps * Vec2(0.75487766624669276, 0.56984029099805327);
    return place - glm::floor(place);
}

Vec2 disk_place(const Vec2& square) {
    const double x = 2 * square.x - 1, y = 2 * square.y - 1;
    if (x == 0 && y == 0) return Vec2(0);
    const bool steep = std::fabs(y) > std::fabs(x);
    const double radius = steep ? y : x;
    const double angle =
        steep ? std::numbers::pi / 2 - std::numbers::pi / 4 * (x / y) : std::numbers::pi / 4 * (y / x);
    return {radius * std::cos(angle), radius * std::sin(angle)};
}

Vec3 hemisphere_direction(std::size_t sample, std::size_t count) {
    const Vec2 disk = disk_place(stratified_place(sample, count));
    return {disk.x, disk.y, std::sqrt(std::max(1 - dot(disk, disk), 0.0))};
}

Vec3 cone_direction(const Vec3& axis, double one_minus_cosine, const Vec2& square) {
    // Of a cap's area the part within a circle is as the square of a disk's radius: 1 - cos.
    const Vec2 disk = disk_place(square);
    const double share = std::min(dot(disk, disk), 1.0);
    const double height = share * one_minus_cosine;  // 1 - cosine of this direction
    const double out = std::sqrt(std::max(height * (2 - height), 0.0));
    const double scale = share > 0 ? out / std::sqrt(share) : 0;
    const auto [u, v] = tangent_basis(axis);
    return normalize_or_zero((1 - height) * axis + scale * (disk.x * u + disk.y * v));
}

}  // namespace trilens
