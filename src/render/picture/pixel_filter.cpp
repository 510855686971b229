#include "render/picture/pixel_filter.h"

#include <cmath>

namespace trilens {
namespace {

double mitchell(double x) {
    if (x < 1) return (7 * x * x * x - 12 * x * x + 16.0 / 3) / 6;
    if (x < 2) return (-7.0 / 3 * x * x * x + 12 * x * x - 20 * x + 32.0 / 3) / 6;
    return 0;
}

double gaussian(double x) {
    constexpr double kReach = 1.5, kDeviation = 0.5;
    const auto bell = [](double at) { return std::exp(-at * at / (2 * kDeviation * kDeviation)); };
    return x < kReach ? bell(x) - bell(kReach) : 0;
}

}  // namespace

SampleColour PixelFilter::averaged(const SampleColour& sample) const {
    if (!shown) return sample;
    const Vec3 light = sample.direct + sample.reflect + sample.refract, wanted = shown(light);
    SampleColour result = sample;
    for (int c = 0; c < 3; ++c) {
        const double share = light[c] > 0 ? wanted[c] / light[c] : 0;
        result.direct[c] *= share;
        result.reflect[c] *= share;
        result.refract[c] *= share;
    }
    return result;
}

PixelFilter make_pixel_filter(FilterKind kind, int side) {
    PixelFilter filter;
    filter.reach = kind == FilterKind::kBox ? 0 : kind == FilterKind::kGaussian ? 1 : 2;
    for (int pixel = -filter.reach; pixel <= filter.reach; ++pixel)
        for (int i = 0; i < side; ++i) {
            const double off = std::fabs(pixel + (i + 0.5) / side - 0.5);
            filter.weights.push_back(kind == FilterKind::kBox        ? 1
                                     : kind == FilterKind::kMitchell ? mitchell(off)
                                                                     : gaussian(off));
        }
    return filter;
}

}  // namespace trilens
