// The metallic-roughness BRDF: GGX distribution, Smith's masking and shadowing, Schlick's Fresnel.
// Source: glTF 2.0 specification, appendix B; KHR_materials_ior; KHR_materials_specular.
#pragma once

#include <cstddef>

#include "base/description/material.h"
#include "base/math/vec.h"

namespace trilens {

/// What a surface is like at a point: as Material has it.
struct SurfaceLook {
    Vec3 base{1};
    double metallic = 0, roughness = 0;
    double ior = 1.5;        // of what covers the matt part; 1: nothing does
    double specular = 1;     // strength of that cover's reflection, 0..1
    Vec3 specular_color{1};  // at right angles
    Vec3 emissive{0};        // radiance
    Brdf brdf = Brdf::kByRoughness;
    bool is_matt() const {
        return brdf == Brdf::kLambert || (brdf == Brdf::kByRoughness && !(roughness > 0));
    }
};

/// Light at a point of a surface, sorted by how the BRDF weighs it. With E the irradiance of a direction,
/// p = (1 - V.H)^5 and D V the distribution times the visibility term: sums of E / pi, of E p / pi,
/// of E D V (1 - p), and of E D V p.
struct ArrivedLight {
    Vec3 matt{0}, matt_grazing{0}, glossy{0}, glossy_grazing{0};

    ArrivedLight& operator+=(const ArrivedLight& other) {
        matt += other.matt, matt_grazing += other.matt_grazing;
        glossy += other.glossy, glossy_grazing += other.glossy_grazing;
        return *this;
    }
    ArrivedLight& operator*=(double factor) {
        matt *= factor, matt_grazing *= factor, glossy *= factor, glossy_grazing *= factor;
        return *this;
    }
    ArrivedLight& operator/=(double divisor) {
        matt /= divisor, matt_grazing /= divisor, glossy /= divisor, glossy_grazing /= divisor;
        return *this;
    }
};

/// Radiance that leaves the point: the dielectric and the metal BRDF of appendix B, mixed by `metallic`.
Vec3 outgoing_radiance(const SurfaceLook& look, const ArrivedLight& arrived);

/// A surface and the way it is looked at; unit vectors, `view` towards the viewer.
struct ViewedSurface {
    Vec3 normal{0, 1, 0}, view{0, 1, 0};
    double roughness = 1;  // 0: polished
};

/// What a direction's light adds: irradiance E (already with the cosine) from `toward`, unit. `spread`: the
/// angle in radians from the middle to the border of what the direction stands for: the lobe is widened by
/// it, so that the light's samples do not show as dots; a polished surface shows lamps as one of
/// kLeastRoughness does.
ArrivedLight arrived_from(const ViewedSurface& surface, const Vec3& toward, const Vec3& irradiance,
                          double spread = 0);

/// One of `count` directions in which the surface reflects what is looked at: half vectors in proportion to
/// the distribution. An arriving radiance L adds {0, 0, L glossy, L grazing}; the direction stands for a
/// square of this side (radians), zero weights for none. Of a polished surface all are the mirrored one.
/// Source: Krivanek, Colbert, Real-Time Shading with Filtered Importance Sampling, 2008.
struct LobeDirection {
    Vec3 toward{0};
    double glossy = 0, grazing = 0;
    double side = 0;
};
LobeDirection lobe_direction(const ViewedSurface& surface, std::size_t sample, std::size_t count);

}  // namespace trilens
