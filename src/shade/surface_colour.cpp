// Base colours and backgrounds, averaged over the footprints of rays.
// Source: Igehy, Tracing Ray Differentials, SIGGRAPH 1999 (transfer of a differential to a plane).
#include <algorithm>
#include <cmath>

#include "shade/shade.h"

namespace trilens {
namespace {

const Material& material_of(const ShadeScene& scene, const Hit& hit) {
    return scene.materials[scene.material[hit.triangle]];
}

Vec2 uv_at(const ShadeScene& scene, const Hit& hit) {
    if (hit.triangle >= scene.uvs.size()) return Vec2(0);
    const std::array<Vec2, 3>& uv = scene.uvs[hit.triangle];
    return (1 - hit.barycentric.x - hit.barycentric.y) * uv[0] + hit.barycentric.x * uv[1] +
           hit.barycentric.y * uv[2];
}

Vec3 look_up(const ShadeScene& scene, const Hit& hit, const PlacedTexture& texture) {
    return lookup(*texture.picture, texture.sampler, texture.sampler.place(uv_at(scene, hit)));
}

/// How uv at the hit change along the sides of the ray's footprint.
Footprint uv_footprint(const ShadeScene& scene, const SeenAlong& seen) {
    if (seen.hit->triangle >= scene.uvs.size()) return {Vec2(0), Vec2(0)};
    const IdTriple& corner = scene.triangles->triangles[seen.hit->triangle];
    const std::array<Vec2, 3>& uv = scene.uvs[seen.hit->triangle];
    const Vec3& a = scene.triangles->points[corner[0]];
    const Vec3 b = scene.triangles->points[corner[1]] - a, c = scene.triangles->points[corner[2]] - a;
    const Vec3 normal = cross(b, c);
    const double area = dot(normal, normal), along = dot(normal, seen.ray->direction);
    Footprint footprint;
    for (std::size_t k = 0; k < 2; ++k) {
        // The ray's point moves with origin and direction, and along the ray until it is in the plane again.
        Vec3 step = seen.differential->origin[k] + seen.hit->t * seen.differential->direction[k];
        step -= dot(normal, step) / along * seen.ray->direction;
        footprint[k] = dot(cross(step, c), normal) / area * (uv[1] - uv[0]) +
                       dot(cross(b, step), normal) / area * (uv[2] - uv[0]);
    }
    return footprint;
}

/// A direction as the background's picture lies.
Vec3 turned(const Background& background, const Vec3& v) {
    const double c = background.rotate_cos, s = background.rotate_sin;
    return {c * v.x - s * v.z, v.y, s * v.x + c * v.z};
}

}  // namespace

void prepare_textures(ShadeScene& scene) {
    std::vector<std::shared_ptr<const MipMap>> before = std::move(scene.base_color_maps);
    before.push_back(scene.environment_map);
    const auto map_of = [&](const std::shared_ptr<const Texture>& texture) {
        std::shared_ptr<const MipMap> map;
        if (!texture) return map;
        const auto found = std::find_if(before.begin(), before.end(),
                                        [&](const auto& one) { return one && one->texture() == texture; });
        map = found != before.end() ? *found : std::make_shared<const MipMap>(texture);
        before.push_back(map);
        return map;
    };
    scene.base_color_maps.clear();
    for (const Material& material : scene.materials)
        scene.base_color_maps.push_back(map_of(material.base_color_texture));
    scene.environment_map = map_of(scene.background.environment);
}

bool is_lit(const ShadeScene& scene, const Hit& hit) {
    return !material_of(scene, hit).unlit;
}

bool has_texture(const ShadeScene& scene, const Hit& hit) {
    return hit.seen() ? material_of(scene, hit).base_color_texture != nullptr
                      : scene.background.environment != nullptr;
}

Vec3 base_colour(const ShadeScene& scene, const Hit& hit) {
    const Material& material = material_of(scene, hit);
    if (!material.base_color_texture) return material.base_color_factor;
    return material.base_color_factor * lookup(*material.base_color_texture, material.base_color_sampler,
                                               material.base_color_sampler.place(uv_at(scene, hit)));
}

Vec3 shade_background(const Background& background, const Vec3& direction) {
    if (!background.environment) return background.color;
    return lookup_latitude_longitude(*background.environment, turned(background, direction));
}

SurfaceLook look_at(const ShadeScene& scene, const Hit& hit, const Vec3& base) {
    const Material& material = material_of(scene, hit);
    SurfaceLook look;
    look.base = base;
    look.metallic = material.metallic_factor;
    look.roughness = material.roughness_factor;
    look.ior = material.ior;
    look.specular = material.specular_factor;
    look.specular_color = material.specular_color_factor;
    look.emissive = material.emissive_factor;
    look.brdf = material.is_matt() ? Brdf::kLambert : Brdf::kMetallicRoughness;
    if (const PlacedTexture& both = material.metallic_roughness_texture; both.picture) {
        const Vec3 seen = look_up(scene, hit, both);
        look.roughness *= std::clamp(seen.y, 0.0, 1.0);
        look.metallic *= std::clamp(seen.z, 0.0, 1.0);
    }
    if (material.emissive_texture.picture) look.emissive *= look_up(scene, hit, material.emissive_texture);
    return look;
}

Vec3 mapped_normal(const ShadeScene& scene, const Hit& hit, const Vec3& normal,
                   const Vec3& geometric_normal) {
    const Material& material = material_of(scene, hit);
    if (!material.normal_texture.picture || hit.triangle >= scene.uvs.size()) return normal;
    const IdTriple& corner = scene.triangles->triangles[hit.triangle];
    const std::array<Vec2, 3>& uv = scene.uvs[hit.triangle];
    const Vec3& a = scene.triangles->points[corner[0]];
    const Vec3 b = scene.triangles->points[corner[1]] - a, c = scene.triangles->points[corner[2]] - a;
    const Vec2 ub = uv[1] - uv[0], uc = uv[2] - uv[0];
    const double area = ub.x * uc.y - ub.y * uc.x;
    if (!(area != 0)) return normal;
    // The point's derivatives by u and by v.
    const Vec3 along_u = (uc.y * b - ub.y * c) / area, along_v = (ub.x * c - uc.x * b) / area;
    // The map is of the front, where the corners turn anticlockwise.
    const double side = dot(cross(b, c), geometric_normal) < 0 ? -1 : 1;
    const Vec3 front = side * normal;
    const Vec3 tangent = normalize_or_zero(along_u - dot(along_u, front) * front);
    Vec3 bitangent = cross(front, tangent);
    if (dot(bitangent, along_v) < 0) bitangent = -bitangent;
    const Vec3 texel = look_up(scene, hit, material.normal_texture);
    const Vec3 mapped =
        normalize_or_zero(material.normal_scale * (2 * texel.x - 1) * tangent +
                          material.normal_scale * (2 * texel.y - 1) * bitangent + (2 * texel.z - 1) * front);
    return mapped == Vec3(0) ? normal : side * mapped;
}

double occlusion_at(const ShadeScene& scene, const Hit& hit) {
    const Material& material = material_of(scene, hit);
    if (!material.occlusion_texture.picture) return 1;
    const double seen = std::clamp(look_up(scene, hit, material.occlusion_texture).x, 0.0, 1.0);
    return 1 + material.occlusion_strength * (seen - 1);
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

Vec3 base_colour(const ShadeScene& scene, const SeenAlong& seen) {
    if (!seen.hit->seen()) {
        if (!seen.differential || !scene.environment_map)
            return shade_background(scene.background, seen.ray->direction);
        return background_radiance(scene.background, *scene.environment_map, seen.ray->direction,
                                   seen.differential->direction);
    }
    const Id index = scene.material[seen.hit->triangle];
    if (!seen.differential || index >= scene.base_color_maps.size() || !scene.base_color_maps[index])
        return base_colour(scene, *seen.hit);
    const Material& material = scene.materials[index];
    const TextureSampler& sampler = material.base_color_sampler;
    Footprint footprint = uv_footprint(scene, seen);
    for (Vec2& side : footprint) side = sampler.step(side);
    return material.base_color_factor *
           lookup(*scene.base_color_maps[index], sampler, sampler.place(uv_at(scene, *seen.hit)), footprint);
}

}  // namespace trilens
