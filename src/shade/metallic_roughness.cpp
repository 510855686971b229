#include "shade/metallic_roughness.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "shade/lights/light_sample.h"
#include "shade/microfacets.h"

namespace trilens {
namespace {

// Below it a lobe is narrower than what double numbers tell from one direction.
constexpr double kPolished = 1e-3;

double power4(double x) {
    return x * x * x * x;
}
double power5(double x) {
    return power4(x) * x;
}

/// G over 4 N.L N.V. Source: glTF 2.0, B.3.3 (Smith's, separable).
double visibility(double alpha2, double cos_light, double cos_view) {
    const auto one = [&](double cosine) {
        return cosine + std::sqrt(alpha2 + (1 - alpha2) * cosine * cosine);
    };
    return 1 / (one(cos_light) * one(cos_view));
}

}  // namespace

Vec3 outgoing_radiance(const SurfaceLook& look, const ArrivedLight& arrived) {
    if (look.is_matt()) return look.base * arrived.matt + look.emissive;
    // Dielectric: fresnel_mix of the matt base and the glossy cover; of F the brightest colour dims the base.
    const double r = (look.ior - 1) / (look.ior + 1);
    const Vec3 f0 = glm::min(r * r * look.specular_color, Vec3(1));
    const double brightest = std::max({f0.x, f0.y, f0.z});
    const Vec3 matt = look.base * (arrived.matt - look.specular * brightest * arrived.matt -
                                   look.specular * (1 - brightest) * arrived.matt_grazing);
    const Vec3 cover = look.specular * (f0 * arrived.glossy + arrived.glossy_grazing);
    // Metal: conductor_fresnel, whose colour at right angles is the base.
    const Vec3 metal = look.base * arrived.glossy + arrived.glossy_grazing;
    return (1 - look.metallic) * (matt + cover) + look.metallic * metal + look.emissive;
}

ArrivedLight arrived_from(const ViewedSurface& surface, const Vec3& toward, const Vec3& irradiance,
                          double spread) {
    const Vec3 half = normalize_or_zero(toward + surface.view);
    const double p = power5(1 - std::clamp(dot(surface.view, half), 0.0, 1.0));
    const Vec3 matt = std::numbers::inv_pi * irradiance;
    // Half vectors turn half as far as the light does; GGX's width is a slope's.
    const double r = std::max(surface.roughness, kLeastRoughness), alpha = r * r, wider = spread / 2;
    const double alpha2 = std::min(alpha * alpha + wider * wider, 1.0);
    const double dv = ggx_distribution(alpha2, dot(surface.normal, half)) *
                      visibility(alpha2, std::max(dot(surface.normal, toward), 0.0),
                                 std::max(dot(surface.normal, surface.view), kLeastViewCosine));
    return {matt, p * matt, dv * (1 - p) * irradiance, dv * p * irradiance};
}

LobeDirection lobe_direction(const ViewedSurface& surface, std::size_t sample, std::size_t count) {
    const bool polished = surface.roughness < kPolished;
    const double alpha2 = polished ? 0 : power4(surface.roughness);
    const Vec2 place = stratified_place(sample, count);
    const double cos2 = (1 - place.y) / (1 + (alpha2 - 1) * place.y);
    const double cos_half = std::sqrt(cos2), sin_half = std::sqrt(std::max(1 - cos2, 0.0));
    const double around = 2 * std::numbers::pi * place.x;
    const auto [u, v] = tangent_basis(surface.normal);
    const Vec3 half = normalize_or_zero(sin_half * (std::cos(around) * u + std::sin(around) * v) +
                                        cos_half * surface.normal);
    const double view_half = dot(surface.view, half);
    LobeDirection direction;
    direction.toward = normalize_or_zero(2 * view_half * half - surface.view);
    const double cos_light = dot(surface.normal, direction.toward);
    if (!(view_half > 0 && cos_light > 0)) return {};
    // f N.L over the density D N.H / (4 V.H), less Fresnel's term.
    const double cos_view = std::max(dot(surface.normal, surface.view), kLeastViewCosine);
    const double weight = 4 * visibility(alpha2, cos_light, cos_view) * cos_light * view_half / cos_half /
                          static_cast<double>(count);
    const double p = power5(1 - std::min(view_half, 1.0));
    direction.glossy = weight * (1 - p);
    direction.grazing = weight * p;
    if (polished) return direction;
    direction.side = std::sqrt(4 * view_half /
                               (static_cast<double>(count) * ggx_distribution(alpha2, cos_half) * cos_half));
    return direction;
}

}  // namespace trilens
