// Materials, by glTF's names, and the pictures that they look up; plain data that scene writes and shade
// reads.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "base/math/vec.h"
#include "base/util/names.h"

namespace trilens {

// A picture to look up, as materials and the background have it.

/// A picture to look up: linear Rec.709, rows from the top, three floats per texel.
struct Texture {
    int width = 0, height = 0;
    std::vector<float> rgb;
    std::vector<float> alpha;  // 0..1, one per texel; empty: all opaque
    bool is_premultiplied = false;  // colours are multiplied by alpha, as OpenEXR has them; else straight

    /// Where all is opaque there is no alpha, as in files that have none.
    void drop_opaque_alpha() {
        if (std::all_of(alpha.begin(), alpha.end(), [](float a) { return a >= 1; })) alpha = {};
    }
};

/// What lies beyond a picture's edges: as glTF's samplers have it.
enum class Wrap { kRepeat, kMirroredRepeat, kClampToEdge };

template <>
struct EnumNames<Wrap> {
    static constexpr std::array kTable{NamedValue<Wrap>{Wrap::kRepeat, "repeat"},
                                       NamedValue<Wrap>{Wrap::kMirroredRepeat, "mirroredRepeat"},
                                       NamedValue<Wrap>{Wrap::kClampToEdge, "clampToEdge"}};
};

/// How a surface's uv lie on its picture.
struct TextureSampler {
    Wrap wrap_s = Wrap::kRepeat, wrap_t = Wrap::kRepeat;
    // The place of uv on the picture is at_zero + u along_u + v along_v; both v upward from the bottom.
    Vec2 at_zero{0}, along_u{1, 0}, along_v{0, 1};
    int uv_set = 0;  // of the mesh's two: 0 or 1

    Vec2 place(const Vec2& uv) const { return at_zero + step(uv); }
    /// How the place moves with uv.
    Vec2 step(const Vec2& uv) const { return uv.x * along_u + uv.y * along_v; }
};

/// KHR_texture_transform: of uv whose v runs downward from the picture's top; scaled, turned by `rotation`
/// (radians, counter-clockwise on the picture), moved by `offset`.
struct TextureTransform {
    Vec2 offset{0};
    double rotation = 0;
    Vec2 scale{1};
};

/// Sets the map from uv to places.
inline void set_transform(const TextureTransform& transform, TextureSampler& sampler) {
    const double c = std::cos(transform.rotation), s = std::sin(transform.rotation);
    // Downward: (x, y) = offset + (c, -s) sx u + (s, c) sy (1 - v); upward the place is (x, 1 - y).
    const Vec2 along_u = Vec2(c, -s) * transform.scale.x, along_down = Vec2(s, c) * transform.scale.y;
    const Vec2 top = transform.offset + along_down;  // of v = 0
    sampler.along_u = {along_u.x, -along_u.y};
    sampler.along_v = {-along_down.x, along_down.y};
    sampler.at_zero = {top.x, 1 - top.y};
}

// Materials, by glTF's names; plain data that scene writes and shade reads.

/// glTF's: what is less opaque than a cutoff is not there (kMask), or shows what lies behind in part
/// (kBlend).
enum class AlphaMode { kOpaque, kMask, kBlend };

template <>
struct EnumNames<AlphaMode> {
    static constexpr std::array kTable{NamedValue<AlphaMode>{AlphaMode::kOpaque, "opaque"},
                                       NamedValue<AlphaMode>{AlphaMode::kMask, "mask"},
                                       NamedValue<AlphaMode>{AlphaMode::kBlend, "blend"}};
};

/// How an object's surface reflects light.
enum class Brdf {
    kByRoughness,        // Lambert's at roughness 0, else metallic-roughness
    kLambert,            // matt
    kMetallicRoughness,  // glTF's; at roughness 0 polished
};

template <>
struct EnumNames<Brdf> {
    static constexpr std::array kTable{NamedValue<Brdf>{Brdf::kByRoughness, "byRoughness"},
                                       NamedValue<Brdf>{Brdf::kLambert, "lambert"},
                                       NamedValue<Brdf>{Brdf::kMetallicRoughness, "metallicRoughness"}};
};

/// A picture and how it lies.
struct PlacedTexture {
    std::shared_ptr<const Texture> picture;  // may be null
    TextureSampler sampler;
};

/// The least roughness that lamps are reflected with: below it a point of light is smaller than can be seen.
inline constexpr double kLeastRoughness = 0.03;

/// glTF's names. On an optic either metallic_factor or transmission_factor is 1.
struct Material {
    std::string name;
    Vec3 base_color_factor{1};
    std::shared_ptr<const Texture> base_color_texture;  // may be null
    TextureSampler base_color_sampler;
    bool unlit = false;
    double metallic_factor = 0;
    double roughness_factor = 0;
    double transmission_factor = 0;
    double ior = 1.5;
    double dispersion = 0;
    Vec3 attenuation_color{1};
    double attenuation_distance = 0;  // scene units; 0: no absorption

    // Of objects alone. Pictures of numbers hold them as they are, not as colours.
    Brdf brdf = Brdf::kByRoughness;
    double specular_factor = 1;  // KHR_materials_specular
    Vec3 specular_color_factor{1};
    Vec3 emissive_factor{0};  // radiance: KHR_materials_emissive_strength's is a factor of it
    double normal_scale = 1;  // of the normal map's slopes
    double occlusion_strength = 1;
    PlacedTexture metallic_roughness_texture;   // green: roughness, blue: metallic, factors of the factors
    PlacedTexture normal_texture;               // 2 rgb - 1 in the frame of u, v (upward) and the normal
    PlacedTexture occlusion_texture;            // red: of ambient and environment light what arrives
    PlacedTexture emissive_texture;             // factor of emissive_factor
    AlphaMode alpha_mode = AlphaMode::kOpaque;  // of objects, masks cut when they are read
    double alpha_cutoff = 0.5;
    double alpha_factor = 1;   // times the alpha of the base colour's picture
    bool double_sided = true;  // of objects that blend: seen from behind, too

    bool is_matt() const {
        return brdf == Brdf::kLambert || (brdf == Brdf::kByRoughness && !(roughness_factor > 0));
    }
};

}  // namespace trilens
