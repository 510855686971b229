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
