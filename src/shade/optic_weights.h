// How much of the light of each path an optic passes on: Fresnel, tint and absorption, stated once for all
// engines.
#pragma once

#include "base/description/material.h"

namespace trilens {

/// Whether an optic of this material mirrors; else it is glass.
inline bool is_mirror(const Material& material) {
    return material.transmission_factor < 1;
}

/// The material's refractive index for one of the three colours of light (0, 1, 2: red, green, blue), or, for
/// any other `colour`, its `ior`. Where it disperses red and blue lie on either side of green by
/// (ior - 1) * 0.025 * dispersion; `dispersion` is 20 / Abbe number. Source: KHR_materials_dispersion.
double ior_of(const Material& material, int colour);

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
/// glass reflects by the Fresnel equations, in each colour by its own index where it disperses, and passes on
/// the rest times its tint. Without `fresnel` a mirror
/// reflects its tint at every angle, and glass passes on all of its tint or, beyond the critical angle,
/// reflects all.
OpticWeights optic_weights(const Material& material, const Incidence& incidence, bool fresnel);

/// Whether glass reflects all light that comes so.
bool reflects_totally(const Material& material, const Incidence& incidence);

/// A surface between two media. Null: air. With one medium on both sides it is no interface: all light goes
/// on, and nothing tints it.
struct GlassInterface {
    const Material* before = nullptr;  // where light comes from
    const Material* after = nullptr;   // where it goes
    Vec3 tint{1};                      // of what goes through
};

/// Refractive index before over that after; `colour` as ior_of has it.
double eta_of(const GlassInterface& interface, int colour);

/// As optic_weights; `cosine`: of the angle of incidence, 0..1.
OpticWeights interface_weights(const GlassInterface& interface, double cosine, bool fresnel);

/// Whether all light that comes at this angle is reflected.
bool reflects_totally(const GlassInterface& interface, double cosine);

}  // namespace trilens
