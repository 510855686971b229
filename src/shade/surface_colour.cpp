// Materials' pictures and backgrounds, averaged over the footprints of rays.
// Source: Igehy, Tracing Ray Differentials, SIGGRAPH 1999 (transfer of a differential to a plane).
#include <algorithm>
#include <cmath>

#include "shade/shade.h"

namespace trilens {
namespace {

const Material& material_of(const ShadeScene& scene, const Hit& hit) {
    return scene.materials[scene.material[hit.triangle]];
}

/// uv of the triangle's corners in the set that a texture is of; null: there are none.
const std::array<Vec2, 3>* uvs_of(const ShadeScene& scene, Id triangle, const TextureSampler& sampler) {
    const auto& set = sampler.uv_set == 0 ? scene.uvs : scene.second_uvs;
    return triangle < set.size() ? &set[triangle] : nullptr;
}

Vec2 uv_at(const ShadeScene& scene, const Hit& hit, const TextureSampler& sampler) {
    const std::array<Vec2, 3>* of_corners = uvs_of(scene, hit.triangle, sampler);
    if (!of_corners) return Vec2(0);
    const std::array<Vec2, 3>& uv = *of_corners;
    return (1 - hit.barycentric.x - hit.barycentric.y) * uv[0] + hit.barycentric.x * uv[1] +
           hit.barycentric.y * uv[2];
}

/// The factor of the base colour and its alpha that the mesh's own colours are there.
Vec4 color_at(const ShadeScene& scene, const Hit& hit) {
    if (hit.triangle >= scene.colors.size()) return Vec4(1);
    const std::array<Vec4, 3>& color = scene.colors[hit.triangle];
    const Vec4 mean = (1 - hit.barycentric.x - hit.barycentric.y) * color[0] + hit.barycentric.x * color[1] +
                      hit.barycentric.y * color[2];
    return glm::clamp(mean, Vec4(0), Vec4(1));
}

/// How the picture's place at the hit changes along the sides of the ray's footprint.
Footprint footprint_on(const ShadeScene& scene, const SeenAlong& seen, const TextureSampler& sampler) {
    const std::array<Vec2, 3>* of_corners = uvs_of(scene, seen.hit->triangle, sampler);
    if (!of_corners) return {Vec2(0), Vec2(0)};
    const std::array<Vec2, 3>& uv = *of_corners;
    const IdTriple& corner = scene.triangles->triangles[seen.hit->triangle];
    const Vec3& a = scene.triangles->points[corner[0]];
    const Vec3 b = scene.triangles->points[corner[1]] - a, c = scene.triangles->points[corner[2]] - a;
    const Vec3 normal = cross(b, c);
    const double area = dot(normal, normal), along = dot(normal, seen.ray->direction);
    Footprint footprint;
    for (std::size_t k = 0; k < 2; ++k) {
        // The ray's point moves with origin and direction, and along the ray until it is in the plane again.
        Vec3 step = seen.differential->origin[k] + seen.hit->t * seen.differential->direction[k];
        step -= dot(normal, step) / along * seen.ray->direction;
        footprint[k] = sampler.step(dot(cross(step, c), normal) / area * (uv[1] - uv[0]) +
                                    dot(cross(b, step), normal) / area * (uv[2] - uv[0]));
    }
    return footprint;
}

/// A picture that is there.
struct LookedUp {
    const Texture& picture;
    const TextureSampler& sampler;
};

LookedUp placed(const PlacedTexture& texture) {
    return {*texture.picture, texture.sampler};
}

/// The picture where a ray meets the surface; the mean over the ray's footprint where there are `mips`.
Vec3 look_up(const ShadeScene& scene, const SeenAlong& seen, const MipMap* mips, const LookedUp& texture) {
    const TextureSampler& sampler = texture.sampler;
    const Vec2 place = sampler.place(uv_at(scene, *seen.hit, sampler));
    if (!mips) return lookup(texture.picture, sampler, place);
    return lookup(*mips, sampler, place, footprint_on(scene, seen, sampler));
}

/// A normal map there: its own normal and how long the mean of those in the footprint is.
void look_up_normal(const ShadeScene& scene, const SeenAlong& seen, const MipMap* mips, MapTexels& texels) {
    const Material& material = material_of(scene, *seen.hit);
    const TextureSampler& sampler = material.normal_texture.sampler;
    const auto normal_at = [&](const Vec2& place) {
        return normal_of_texel(lookup(*material.normal_texture.picture, sampler, place),
                               material.normal_scale);
    };
    const Vec2 place = sampler.place(uv_at(scene, *seen.hit, sampler));
    Vec3 mean;
    if (mips) {
        mean = lookup(*mips, sampler, {place, footprint_on(scene, seen, sampler)}, normal_at);
        texels.normal_length = std::min(length(mean), 1.0);
    } else {
        mean = normal_at(place);
    }
    const Vec3 normal = normalize_or_zero(mean);
    if (normal != Vec3(0)) texels.normal = normal;
}

/// The normals that others of the same picture and scale have, if any.
std::shared_ptr<const MipMap> normals_like(const MaterialMips& own, const std::vector<MaterialMips>& others) {
    for (const MaterialMips& other : others)
        if (other.normal_picture == own.normal_picture && other.normal_scale == own.normal_scale)
            return other.normal;
    return nullptr;
}

/// A direction as the background's picture lies.
Vec3 turned(const Background& background, const Vec3& v) {
    const double c = background.rotate_cos, s = background.rotate_sin;
    return {c * v.x - s * v.z, v.y, s * v.x + c * v.z};
}

}  // namespace

void prepare_textures(ShadeScene& scene) {
    const std::vector<MaterialMips> before = std::move(scene.mips);
    std::vector<std::shared_ptr<const MipMap>> known{scene.environment_map};
    for (const MaterialMips& one : before)
        known.insert(known.end(), {one.base_color, one.metallic_roughness, one.occlusion, one.emissive});
    const auto map_of = [&](const std::shared_ptr<const Texture>& texture) {
        std::shared_ptr<const MipMap> map;
        if (!texture) return map;
        const auto found = std::find_if(known.begin(), known.end(),
                                        [&](const auto& one) { return one && one->texture() == texture; });
        map = found != known.end() ? *found : std::make_shared<const MipMap>(texture);
        known.push_back(map);
        return map;
    };
    scene.mips.clear();
    for (const Material& material : scene.materials) {
        MaterialMips mips;
        mips.base_color = map_of(material.base_color_texture);
        mips.metallic_roughness = map_of(material.metallic_roughness_texture.picture);
        mips.occlusion = map_of(material.occlusion_texture.picture);
        mips.emissive = map_of(material.emissive_texture.picture);
        mips.normal_picture = material.normal_texture.picture;
        mips.normal_scale = material.normal_scale;
        if (mips.normal_picture) mips.normal = normals_like(mips, before);
        if (mips.normal_picture && !mips.normal) mips.normal = normals_like(mips, scene.mips);
        if (mips.normal_picture && !mips.normal)
            mips.normal = std::make_shared<const MipMap>(normals_of(*mips.normal_picture, mips.normal_scale));
        scene.mips.push_back(std::move(mips));
    }
    scene.environment_map = map_of(scene.background.environment);
}

bool is_lit(const ShadeScene& scene, const Hit& hit) {
    return !material_of(scene, hit).unlit;
}

bool has_texture(const ShadeScene& scene, const Hit& hit) {
    if (!hit.seen()) return scene.background.environment != nullptr;
    const Material& material = material_of(scene, hit);
    return material.base_color_texture || hit.triangle < scene.colors.size() || has_light_maps(scene, hit) ||
           material.emissive_texture.picture;
}

bool has_light_maps(const ShadeScene& scene, const Hit& hit) {
    const Material& material = material_of(scene, hit);
    return material.normal_texture.picture || material.metallic_roughness_texture.picture ||
           material.occlusion_texture.picture;
}

Vec3 shade_background(const Background& background, const Vec3& direction) {
    if (!background.environment) return background.color;
    return lookup_latitude_longitude(*background.environment, turned(background, direction));
}

SurfaceLook look_at(const ShadeScene& scene, const Hit& hit, const MapTexels& texels) {
    const Material& material = material_of(scene, hit);
    SurfaceLook look;
    look.base = texels.base;
    look.metallic = material.metallic_factor * texels.metallic;
    look.roughness = material.roughness_factor * texels.roughness;
    if (texels.normal_length < 1) look.roughness = widened_roughness(look.roughness, texels.normal_length);
    look.ior = material.ior;
    look.specular = material.specular_factor;
    look.specular_color = material.specular_color_factor;
    look.emissive = material.emissive_factor * texels.emissive;
    look.brdf = material.is_matt() ? Brdf::kLambert : Brdf::kMetallicRoughness;
    return look;
}

Vec3 baked_light_at(const ShadeScene& scene, const Hit& hit, const Vec3& toward) {
    if (hit.triangle >= scene.baked.size()) return Vec3(0);
    const IdTriple& corner = scene.triangles->triangles[hit.triangle];
    const Vec3& a = scene.triangles->points[corner[0]];
    const Vec3 normal = cross(scene.triangles->points[corner[1]] - a, scene.triangles->points[corner[2]] - a);
    const BakedLight& light = scene.baked[hit.triangle];
    const std::array<Vec3, 3>& side = dot(normal, toward) > 0 ? light.back : light.front;
    return (1 - hit.barycentric.x - hit.barycentric.y) * side[0] + hit.barycentric.x * side[1] +
           hit.barycentric.y * side[2];
}

namespace {

/// Unit, at right angles to each other and to the normal, along growing u and v; zero where there are none.
struct MapAxes {
    Vec3 along_u{0}, along_v{0};
};

Vec3 in_plane(const Vec3& v, const Vec3& normal) {
    return normalize_or_zero(v - dot(v, normal) * normal);
}

/// By the corners' tangents. `front`: the normal on the side where the corners turn anticlockwise.
MapAxes given_axes(const ShadeScene& scene, const Hit& hit, const Vec3& front) {
    if (hit.triangle >= scene.tangents.size()) return {};
    const std::array<Vec4, 3>& at = scene.tangents[hit.triangle];
    const Vec4 mean = (1 - hit.barycentric.x - hit.barycentric.y) * at[0] + hit.barycentric.x * at[1] +
                      hit.barycentric.y * at[2];
    const Vec3 tangent = in_plane(Vec3(mean), front);
    return {tangent, (mean.w < 0 ? -1.0 : 1.0) * cross(front, tangent)};
}

/// By the point's derivatives over the triangle with corners a, a + b and a + c.
MapAxes own_axes(const std::array<Vec2, 3>& uv, const std::array<Vec3, 2>& sides, const Vec3& front) {
    const auto& [b, c] = sides;
    const Vec2 ub = uv[1] - uv[0], uc = uv[2] - uv[0];
    const double area = cross(ub, uc);
    if (!(area != 0)) return {};
    const Vec3 along_u = (uc.y * b - ub.y * c) / area, along_v = (ub.x * c - uc.x * b) / area;
    const Vec3 tangent = in_plane(along_u, front), bitangent = cross(front, tangent);
    return {tangent, dot(bitangent, along_v) < 0 ? -bitangent : bitangent};
}

}  // namespace

Vec3 mapped_normal(const ShadeScene& scene, const Hit& hit, const SurfaceNormals& surface,
                   const Vec3& in_map) {
    const Material& material = material_of(scene, hit);
    const Vec3& normal = surface.shading;
    if (!material.normal_texture.picture) return normal;
    const std::array<Vec2, 3>* of_corners = uvs_of(scene, hit.triangle, material.normal_texture.sampler);
    if (!of_corners) return normal;
    const IdTriple& corner = scene.triangles->triangles[hit.triangle];
    const Vec3& a = scene.triangles->points[corner[0]];
    const Vec3 b = scene.triangles->points[corner[1]] - a, c = scene.triangles->points[corner[2]] - a;
    // The map is of the front, where the corners turn anticlockwise.
    const double side = dot(cross(b, c), surface.geometric) < 0 ? -1 : 1;
    const Vec3 front = side * normal;
    MapAxes axes = given_axes(scene, hit, front);
    if (axes.along_u == Vec3(0)) axes = own_axes(*of_corners, {b, c}, front);
    if (axes.along_u == Vec3(0)) return normal;
    const Vec3 mapped =
        normalize_or_zero(in_map.x * axes.along_u + in_map.y * axes.along_v + in_map.z * front);
    return mapped == Vec3(0) ? normal : side * mapped;
}

bool is_plain(const ShadeScene& scene, const Hit& hit) {
    const Material& material = material_of(scene, hit);
    return material.is_matt() && !material.normal_texture.picture && !material.occlusion_texture.picture;
}

Vec3 background_radiance(const Background& background, const MipMap& map, const Vec3& direction,
                         const std::array<Vec3, 2>& sides) {
    return lookup_latitude_longitude(map, turned(background, direction),
                                     {turned(background, sides[0]), turned(background, sides[1])});
}

double opacity_at(const ShadeScene& scene, const Hit& hit) {
    const Material& material = material_of(scene, hit);
    const Texture* picture = material.base_color_texture.get();
    const double factor = material.alpha_factor * color_at(scene, hit).w;
    if (!picture || picture->alpha.empty()) return factor;
    const TextureSampler& sampler = material.base_color_sampler;
    const double alpha = lookup_alpha(*picture, sampler, sampler.place(uv_at(scene, hit, sampler)));
    return std::clamp(factor * alpha, 0.0, 1.0);
}

MapTexels texels_at(const ShadeScene& scene, const SeenAlong& seen) {
    MapTexels texels;
    if (!seen.hit->seen()) {
        texels.base = seen.differential && scene.environment_map
                          ? background_radiance(scene.background, *scene.environment_map, seen.ray->direction,
                                                seen.differential->direction)
                          : shade_background(scene.background, seen.ray->direction);
        return texels;
    }
    const Id index = scene.material[seen.hit->triangle];
    const Material& material = scene.materials[index];
    const MaterialMips* mips = seen.differential && index < scene.mips.size() ? &scene.mips[index] : nullptr;
    texels.base = material.base_color_factor * Vec3(color_at(scene, *seen.hit));
    if (material.base_color_texture)
        texels.base *= look_up(scene, seen, mips ? mips->base_color.get() : nullptr,
                               {*material.base_color_texture, material.base_color_sampler});
    if (material.unlit) return texels;
    if (const PlacedTexture& both = material.metallic_roughness_texture; both.picture) {
        const Vec3 texel =
            look_up(scene, seen, mips ? mips->metallic_roughness.get() : nullptr, placed(both));
        texels.roughness = std::clamp(texel.y, 0.0, 1.0);
        texels.metallic = std::clamp(texel.z, 0.0, 1.0);
    }
    if (material.normal_texture.picture)
        look_up_normal(scene, seen, mips ? mips->normal.get() : nullptr, texels);
    if (material.occlusion_texture.picture) {
        const Vec3 texel =
            look_up(scene, seen, mips ? mips->occlusion.get() : nullptr, placed(material.occlusion_texture));
        texels.occlusion = 1 + material.occlusion_strength * (std::clamp(texel.x, 0.0, 1.0) - 1);
    }
    if (material.emissive_texture.picture)
        texels.emissive =
            look_up(scene, seen, mips ? mips->emissive.get() : nullptr, placed(material.emissive_texture));
    return texels;
}

}  // namespace trilens
