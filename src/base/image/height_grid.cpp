#include "base/image/height_grid.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace trilens {
namespace {

/// To 11 bits, as numbers of half precision have them.
double rounded_to_half(double value) {
    constexpr int kBits = 11, kLeastExponent = -14;
    if (value == 0 || !std::isfinite(value)) return value;
    const double step = std::ldexp(1.0, std::max(std::ilogb(value), kLeastExponent) - (kBits - 1));
    return std::nearbyint(value / step) * step;
}

/// The nearest float, infinite beyond them.
float rounded_to_float(double value) {
    constexpr double kMost = std::numeric_limits<float>::max(), kBeyond = kMost * (1 + 0x1p-25);
    if (std::fabs(value) >= kBeyond)
        return std::copysign(std::numeric_limits<float>::infinity(), value < 0 ? -1.f : 1.f);
    return static_cast<float>(std::clamp(value, -kMost, kMost));
}

}  // namespace

bool HeightGrid::stands_for(float value, double raw) const {
    if (greatest > 0) return std::round(static_cast<double>(value) * greatest) == raw;
    return value == rounded_to_float(is_half ? rounded_to_half(raw) : raw);
}

}  // namespace trilens
