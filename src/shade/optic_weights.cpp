#include "shade/optic_weights.h"

#include "shade/fresnel.h"
#include "shade/shade.h"

namespace trilens {
namespace {

/// Refractive index where the ray comes from over the index where it goes.
double eta_of(const Material& material, bool front) {
    return front ? 1 / material.ior : material.ior;
}

}  // namespace

OpticWeights optic_weights(const Material& material, const Incidence& incidence, bool fresnel) {
    OpticWeights weights;
    if (is_mirror(material)) {
        weights.reflect = fresnel ? metal_reflectance(material.base_color_factor, incidence.cosine)
                                  : material.base_color_factor;
        return weights;
    }
    const double reflectance =
        fresnel ? fresnel_reflectance(incidence.cosine, eta_of(material, incidence.front)) : 0;
    weights.reflect = Vec3(reflectance);
    weights.refract = (1 - reflectance) * material.base_color_factor;
    return weights;
}

bool reflects_totally(const Material& material, const Incidence& incidence) {
    return !is_mirror(material) &&
           fresnel_reflectance(incidence.cosine, eta_of(material, incidence.front)) >= 1;
}

Vec3 refracted_transmittance(const Material& material, bool front, const std::optional<double>& distance) {
    if (!front || !distance) return Vec3(1);
    return volume_transmittance(material, *distance);
}

}  // namespace trilens
