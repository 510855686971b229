// The volume rendering integral of emission and absorption along a ray, exact where the scalar is linear and
// the transfer function piecewise linear.
#pragma once

#include <span>
#include <vector>

#include "base/math/vec.h"
#include "volume/volume_data.h"

namespace trilens {

/// What a stretch of a ray adds to the light from behind it: light = emission + transmittance * behind.
struct VolumeLight {
    Vec3 emission{0};          // radiance, linear Rec.709
    double transmittance = 1;  // 0..1

    /// Takes what lies behind in, in front of which this is.
    void put_behind(const VolumeLight& behind) {
        emission += transmittance * behind.emission;
        transmittance *= behind.transmittance;
    }
};

/// A stretch on which colour and extinction are linear, from its start to its end.
struct LinearMedium {
    Vec3 color_start{0}, color_end{0};
    double extinction_start = 0, extinction_end = 0;  // per unit of length, not negative
};

/// The integral over a stretch of this length of several media that fill it together: the extinctions add up,
/// and each emits its colour times its extinction (Max, Optical Models for Direct Volume Rendering, IEEE TVCG
/// 1(2), 1995). The optical depth is the closed form; the stretch is cut at depths of at most 1, and each
/// part integrated by Gauss and Legendre's rule of 8 points: off by less than 1e-12 of the colours. What lies
/// behind a depth of 40 is left out (e^-40 of the light).
VolumeLight integrate(std::span<const LinearMedium> media, double length);

/// Of a ray in one volume, a stretch on which the scalar is linear: lengths from where the ray starts.
struct ScalarStretch {
    double from = 0, to = 0;  // world units
    double scalar_from = 0, scalar_to = 0;
};

/// The stretches of a ray in one volume, from near to far.
struct RayThroughVolume {
    const TransferFunction* transfer = nullptr;
    std::vector<ScalarStretch> stretches;
};

/// The light of a ray through volumes, cut at the transfer functions' points; where stretches overlap, of one
/// volume or of several, their media add up.
VolumeLight integrate(std::span<const RayThroughVolume> volumes);

}  // namespace trilens
