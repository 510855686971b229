#include "shade/optic_weights.h"

#include "shade/fresnel.h"
#include "shade/shade.h"

namespace trilens {
namespace {

/// Refractive index where the ray comes from over the index where it goes.
double eta_of(const Material& material, bool front, int colour) {
    const double ior = ior_of(material, colour);
    return front ? 1 / ior : ior;
}

double reflectance_of(const Material& material, const Incidence& incidence, bool fresnel, int colour) {
    const double share = fresnel_reflectance(incidence.cosine, eta_of(material, incidence.front, colour));
    return fresnel || share >= 1 ? share : 0;
}

}  // namespace

double ior_of(const Material& material, int colour) {
    if (colour < 0 || colour > 2) return material.ior;
    return material.ior + (colour - 1) * (material.ior - 1) * 0.025 * material.dispersion;
}

OpticWeights optic_weights(const Material& material, const Incidence& incidence, bool fresnel) {
    OpticWeights weights;
    if (is_mirror(material)) {
        weights.reflect = fresnel ? metal_reflectance(material.base_color_factor, incidence.cosine)
                                  : material.base_color_factor;
        return weights;
    }
    if (material.dispersion > 0)
        for (int colour = 0; colour < 3; ++colour)
            weights.reflect[colour] = reflectance_of(material, incidence, fresnel, colour);
    else
        weights.reflect = Vec3(reflectance_of(material, incidence, fresnel, -1));
    weights.refract = (Vec3(1) - weights.reflect) * material.base_color_factor;
    return weights;
}

bool reflects_totally(const Material& material, const Incidence& incidence) {
    return !is_mirror(material) &&
           fresnel_reflectance(incidence.cosine, eta_of(material, incidence.front, -1)) >= 1;
}

}  // namespace trilens
