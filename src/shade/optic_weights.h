// How much of the light of each path an optic passes on: Fresnel, tint and absorption, stated once for all
// engines.
#pragma once

#include <optional>

#include "base/appearance.h"

namespace trilens {

/// Whether an optic of this material mirrors; else it is glass.
inline bool is_mirror(const Material& material) {
    return material.transmission_factor < 1;
}

/// How a ray comes to an optic.
struct Incidence {
    double cosine = 1;  // between the ray and the normal on its side, 0..1
    bool front = true;  // it comes from the side that the normals point to: from outside the body
};

/// Factors of linear Rec.709 light.
struct OpticWeights {
    Vec3 reflect{0}, refract{0};
};

/// The weights at the optic itself. A mirror reflects its tint, with Schlick's increase towards grazing;
/// glass reflects by the Fresnel equations and passes on the rest times its tint. Without `fresnel` a mirror
/// reflects its tint at every angle and glass passes on all of its tint.
OpticWeights optic_weights(const Material& material, const Incidence& incidence, bool fresnel);

/// Whether glass reflects all light that comes so.
bool reflects_totally(const Material& material, const Incidence& incidence);

/// Share of the refracted path's light left after `distance` (scene units) behind the interface; `distance`:
/// none where the ray meets nothing. The medium absorbs what has come through it to the eye, so only rays
/// that entered from the front, and only over a stretch that ends.
Vec3 refracted_transmittance(const Material& material, bool front, const std::optional<double>& distance);

}  // namespace trilens
