// From a number to a colour that the colour-blind tell apart and that also prints in grey.
#include "report/colour_map.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace trilens {
namespace {

constexpr double kCoefficients[7][3] = {
    {0.2777273272234177, 0.005407344544966578, 0.3340998053353061},
    {0.1050930431085774, 1.404613529898575, 1.384590162594685},
    {-0.3308618287255563, 0.214847559468213, 0.09509516302823659},
    {-4.634230498983486, -5.799100973351585, -19.33244095627987},
    {6.228269936347081, 14.17993336680509, 56.69055260068105},
    {4.776384997670288, -13.74514537774601, -65.35303263337234},
    {-5.435455855934631, 4.645852612178535, 26.3124352495832},
};

/// As sRGB code values 0..1, in which the map is defined.
std::array<double, 3> viridis_srgb(double share) {
    const double t = share > 0 ? std::min(share, 1.0) : 0.0;
    std::array<double, 3> colour{};
    for (std::size_t channel = 0; channel < 3; ++channel) {
        double value = 0;
        for (int power = 6; power >= 0; --power) value = value * t + kCoefficients[power][channel];
        colour[channel] = std::clamp(value, 0.0, 1.0);
    }
    return colour;
}

double linear_of_srgb(double code) {
    return code <= 0.04045 ? code / 12.92 : std::pow((code + 0.055) / 1.055, 2.4);  // IEC 61966-2-1
}

}  // namespace

LinearRgb viridis(double share) {
    const std::array<double, 3> code = viridis_srgb(share);
    return {static_cast<float>(linear_of_srgb(code[0])), static_cast<float>(linear_of_srgb(code[1])),
            static_cast<float>(linear_of_srgb(code[2]))};
}

std::string viridis_hex(double share) {
    std::string text = "#";
    for (const double code : viridis_srgb(share)) {
        const int level = static_cast<int>(std::lround(code * 255));
        text += "0123456789abcdef"[level / 16];
        text += "0123456789abcdef"[level % 16];
    }
    return text;
}

double ColourRange::share(double value) const {
    if (!(value > lo)) return 0;
    return std::min(1.0, std::log(value / lo) / std::log(hi / lo));
}

}  // namespace trilens
