// sRGB's transfer function. Source: IEC 61966-2-1.
#pragma once

#include <cmath>

namespace trilens {

/// Linear light of a stored value, both 0..1.
inline double linear_from_srgb(double v) {
    return v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4);
}

/// The stored value of linear light, both 0..1.
inline double srgb_from_linear(double v) {
    return v <= 0.0031308 ? v * 12.92 : 1.055 * std::pow(v, 1 / 2.4) - 0.055;
}

}  // namespace trilens
