// The luminance of linear Rec.709 light.
#pragma once

#include "base/math/vec.h"

namespace trilens {

/// Shares of red, green and blue. Source: ITU-R BT.709.
inline constexpr Vec3 kLuminance{0.2126, 0.7152, 0.0722};

inline double luminance(const Vec3& light) {
    return kLuminance.x * light.x + kLuminance.y * light.y + kLuminance.z * light.z;
}

}  // namespace trilens
