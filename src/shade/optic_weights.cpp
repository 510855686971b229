#include "shade/optic_weights.h"

#include "refract/refraction.h"
#include "shade/shade.h"

namespace trilens {
namespace {

GlassInterface interface_of(const Material& material, bool front) {
    return {front ? nullptr : &material, front ? &material : nullptr, material.base_color_factor};
}

double reflectance_of(const GlassInterface& interface, double cosine, bool fresnel, int colour) {
    const double eta = eta_of(interface, colour);
    if (fresnel) return fresnel_reflectance(cosine, eta);
    return is_beyond_critical(cosine, eta) ? 1 : 0;
}

bool disperses(const Material* material) {
    return material && material->dispersion > 0;
}

}  // namespace

double ior_of(const Material& material, int colour) {
    if (colour < 0 || colour > 2) return material.ior;
    return material.ior + (colour - 1) * (material.ior - 1) * 0.025 * material.dispersion;
}

double eta_of(const GlassInterface& interface, int colour) {
    return (interface.before ? ior_of(*interface.before, colour) : 1) /
           (interface.after ? ior_of(*interface.after, colour) : 1);
}

OpticWeights interface_weights(const GlassInterface& interface, double cosine, bool fresnel) {
    OpticWeights weights;
    if (interface.before == interface.after) {
        weights.refract = Vec3(1);
        return weights;
    }
    if (disperses(interface.before) || disperses(interface.after))
        for (int colour = 0; colour < 3; ++colour)
            weights.reflect[colour] = reflectance_of(interface, cosine, fresnel, colour);
    else
        weights.reflect = Vec3(reflectance_of(interface, cosine, fresnel, -1));
    weights.refract = (Vec3(1) - weights.reflect) * interface.tint;
    return weights;
}

bool reflects_totally(const GlassInterface& interface, double cosine) {
    return interface.before != interface.after && is_beyond_critical(cosine, eta_of(interface, -1));
}

OpticWeights optic_weights(const Material& material, const Incidence& incidence, bool fresnel) {
    if (!is_mirror(material))
        return interface_weights(interface_of(material, incidence.front), incidence.cosine, fresnel);
    OpticWeights weights;
    weights.reflect = fresnel ? metal_reflectance(material.base_color_factor, incidence.cosine)
                              : material.base_color_factor;
    return weights;
}

bool reflects_totally(const Material& material, const Incidence& incidence) {
    return !is_mirror(material) &&
           reflects_totally(interface_of(material, incidence.front), incidence.cosine);
}

}  // namespace trilens
