// From the light of a scene to what a screen shows: exposure, a tone curve, sRGB's transfer function.
#pragma once

#include "base/math/srgb.h"
#include "base/math/vec.h"

namespace trilens {

/// How light beyond what a screen can show is brought into its range, linear Rec.709 to linear Rec.709.
enum class ToneCurve {
    kLinear,    // as it is; what is above 1 is cut off
    kReinhard,  // Reinhard and others, Photographic Tone Reproduction for Digital Images (2002), equation 4
    kAces,      // Narkowicz, ACES Filmic Tone Mapping Curve (2016): his fit to the Academy's curve
    kNeutral    // Khronos PBR Neutral Tone Mapper (2024): colours below 0.8 nearly as they are
};

struct ToneMapping {
    double exposure = 0;  // stops: light is multiplied by two to this power first
    ToneCurve curve = ToneCurve::kLinear;
    double white = 4;  // kReinhard: the least luminance, after exposure, that is shown as white
};

/// A linear colour after exposure and curve, linear, not yet cut to 0..1. Components below 0, and NaN, count
/// as 0; infinity as very bright.
Vec3 tone_mapped(const Vec3& colour, const ToneMapping& mapping);

/// Throws UsageError unless the exposure lies in -100..100 and white is positive and finite.
void check_tone_mapping(const ToneMapping& mapping);

}  // namespace trilens
