// Catmull and Rom's cubic between values on a line.
// Source: Catmull and Rom, A class of local interpolating splines, 1974; Keys, Cubic convolution
// interpolation for digital image processing, 1981.
#pragma once

#include <array>

namespace trilens {

/// Weights of the four neighbours -1, 0, 1, 2 at the share t of the way from 0 to 1; their sum is 1.
inline std::array<double, 4> catmull_rom(double t) {
    const double t2 = t * t, t3 = t2 * t;
    return {-0.5 * t + t2 - 0.5 * t3, 1 - 2.5 * t2 + 1.5 * t3, 0.5 * t + 2 * t2 - 1.5 * t3,
            -0.5 * t2 + 0.5 * t3};
}

}  // namespace trilens
