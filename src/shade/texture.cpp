#include "shade/texture.h"

#include <algorithm>
#include <cmath>

namespace trilens {
namespace {

/// As std::floor; a call costs more than all the rest of a look-up.
double floor_of(double x) {
    if (!(std::fabs(x) < 0x1p52)) return std::floor(x);
    const double whole = static_cast<double>(static_cast<long>(x));
    return whole > x ? whole - 1 : whole;
}

int wrap(long index, int size) {
    if (index >= 0 && index < size) return static_cast<int>(index);  // mostly, and a division is slow
    const long rest = index % size;
    return static_cast<int>(rest < 0 ? rest + size : rest);
}

Vec3 texel(const Texture& texture, int x, int y) {
    const float* rgb =
        &texture.rgb[3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(texture.width) +
                          static_cast<std::size_t>(x))];
    return {rgb[0], rgb[1], rgb[2]};
}

/// Bilinear look-up at texel coordinates (centres at .5) with x repeated and y by `row`.
template <typename Row>
Vec3 bilinear(const Texture& texture, double x, double y, Row row) {
    const double left = floor_of(x - 0.5), top = floor_of(y - 0.5);
    const double fx = x - 0.5 - left, fy = y - 0.5 - top;
    const int x0 = wrap(static_cast<long>(left), texture.width),
              x1 = wrap(static_cast<long>(left) + 1, texture.width);
    const int y0 = row(static_cast<long>(top)), y1 = row(static_cast<long>(top) + 1);
    return (1 - fy) * ((1 - fx) * texel(texture, x0, y0) + fx * texel(texture, x1, y0)) +
           fy * ((1 - fx) * texel(texture, x0, y1) + fx * texel(texture, x1, y1));
}

}  // namespace

Vec3 lookup_repeat(const Texture& texture, const Vec2& uv) {
    // Reduce to one period before scaling, so that far-away coordinates stay within integers.
    const double u = uv.x - floor_of(uv.x), v = uv.y - floor_of(uv.y);
    return bilinear(texture, u * texture.width, (1 - v) * texture.height,
                    [&](long y) { return wrap(y, texture.height); });
}

Vec3 lookup_latitude_longitude(const Texture& texture, const Vec3& direction) {
    constexpr double kPi = 3.14159265358979323846;
    const Vec3 d = normalize_or_zero(direction);
    const double u = 0.5 + std::atan2(d.x, -d.z) / (2 * kPi);
    const double v = std::acos(std::clamp(d.y, -1.0, 1.0)) / kPi;
    return bilinear(texture, u * texture.width, v * texture.height,
                    [&](long y) { return static_cast<int>(std::clamp<long>(y, 0, texture.height - 1)); });
}

}  // namespace trilens
