#include "image/tone.h"

#include <algorithm>
#include <cmath>

#include "base/math/luminance.h"
#include "base/util/error.h"

namespace trilens {
namespace {

constexpr double kBrightest = 1e30;
constexpr double kMostStops = 100;

Vec3 reinhard(const Vec3& colour, double white) {
    const double light = luminance(colour);
    return (1 + light / (white * white)) / (1 + light) * colour;
}

double aces(double x) {
    return x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14);
}

Vec3 neutral(Vec3 colour) {
    constexpr double kStart = 0.8 - 0.04, kDesaturation = 0.15, kRest = 1 - kStart;
    const double least = std::min({colour.x, colour.y, colour.z});
    colour -= least < 0.08 ? least - 6.25 * least * least : 0.04;
    const double peak = std::max({colour.x, colour.y, colour.z});
    if (peak < kStart) return colour;
    const double shown = 1 - kRest * kRest / (peak + kRest - kStart);
    const double grey = 1 - 1 / (kDesaturation * (peak - shown) + 1);
    return (1 - grey) * (shown / peak) * colour + Vec3(grey * shown);
}

}  // namespace

void check_tone_mapping(const ToneMapping& mapping) {
    if (!(std::fabs(mapping.exposure) <= kMostStops))
        throw UsageError("the exposure is not in -100..100 stops");
    if (!(mapping.white > 0 && std::isfinite(mapping.white)))
        throw UsageError("what is shown as white must be a positive luminance");
}

Vec3 tone_mapped(const Vec3& colour, const ToneMapping& mapping) {
    const double gain = std::exp2(mapping.exposure);
    Vec3 light(0);
    for (int c = 0; c < 3; ++c)
        if (colour[c] > 0) light[c] = std::min(gain * colour[c], kBrightest);
    switch (mapping.curve) {
        case ToneCurve::kLinear:
            return light;
        case ToneCurve::kReinhard:
            return reinhard(light, mapping.white);
        case ToneCurve::kAces:
            return {aces(light.x), aces(light.y), aces(light.z)};
        case ToneCurve::kNeutral:
            return neutral(light);
    }
    return light;
}

}  // namespace trilens
