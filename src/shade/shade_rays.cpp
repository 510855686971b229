// What many rays show: their hits shaded in batches.
#include <algorithm>
#include <array>

#include "base/util/check.h"
#include "shade/shade.h"
#include "shade/shade_batch.h"
#include "shade/texture.h"

namespace trilens {
namespace {

ShadeLight as_lanes_see_it(const ShadeScene& scene, const Light& light) {
    ShadeLight seen;
    seen.is_point = light.type == Light::Type::kPoint;
    seen.position = light.position;
    seen.toward = -light.direction;
    seen.far = 2 * scene.size * seen.toward;
    seen.intensity = light.intensity;
    seen.casts_shadows = light.shadows && scene.occluded;
    return seen;
}

/// Those of the lanes whose shadow rays meet nothing.
ShadeBatch::Bits unhindered(const ShadeScene& scene, const ShadeBatch& batch, ShadeBatch::Bits lanes) {
    Segments segments;
    std::array<std::size_t, kShadeLanes> lane_of;
    for_each_of(lanes, [&](std::size_t i) {
        lane_of[segments.count] = i;
        segments.add(batch.shadow_start.get(i), batch.way.get(i));
    });
    if (segments.count == 0) return 0;
    for_each_of(scene.occluded(segments), [&](std::size_t s) { lanes &= ~Segments::bit(lane_of[s]); });
    return lanes;
}

/// A batch on its way, with what is not the same number in all lanes.
struct Shaded {
    explicit Shaded(const ShadeScene& of_scene)
        : scene(of_scene) {}  // lanes hold anything until they are set

    const ShadeScene& scene;
    ShadeBatch batch;
    std::array<const Hit*, kShadeLanes> hit;
    std::array<std::size_t, kShadeLanes> answer;  // index of the light that comes out

    void add(const SeenAlong& seen, std::size_t index);
    void pad();
    void arrive();
    Vec3 base_colour(std::size_t lane, const Material& material) const;
    void shade(std::span<Vec3> light);

  private:
    void set(std::size_t lane, const Hit& hit, const Vec3& toward);
};

void Shaded::set(std::size_t lane, const Hit& seen, const Vec3& toward) {
    const IdTriple& corner = scene.triangles->triangles[seen.triangle];
    for (std::size_t k = 0; k < 3; ++k) batch.corner[k].set(lane, scene.triangles->points[corner[k]]);
    if (batch.has_normals) {
        const bool given = seen.triangle < scene.normals.size();
        for (std::size_t k = 0; k < 3; ++k)
            batch.corner_normal[k].set(lane, given ? scene.normals[seen.triangle][k] : Vec3(0));
    }
    batch.toward.set(lane, toward);
    batch.weight[0][lane] = 1 - seen.barycentric.x - seen.barycentric.y;
    batch.weight[1][lane] = seen.barycentric.x;
    batch.weight[2][lane] = seen.barycentric.y;
}

void Shaded::add(const SeenAlong& seen, std::size_t index) {
    set(batch.count, *seen.hit, seen.ray->direction);
    hit[batch.count] = seen.hit;
    answer[batch.count++] = index;
}

/// Lanes beyond the last are computed with the rest of their vector: they repeat it.
void Shaded::pad() {
    constexpr std::size_t kWidest = 8;
    const Vec3 toward = batch.toward.get(batch.count - 1);
    for (std::size_t i = batch.count; i % kWidest != 0; ++i) set(i, *hit[batch.count - 1], toward);
}

Vec3 Shaded::base_colour(std::size_t lane, const Material& material) const {
    if (!material.base_color_texture) return material.base_color_factor;
    Vec2 uv(0);
    const Id triangle = hit[lane]->triangle;
    if (triangle < scene.uvs.size())
        for (std::size_t k = 0; k < 3; ++k) uv += batch.weight[k][lane] * scene.uvs[triangle][k];
    return material.base_color_factor * lookup_repeat(*material.base_color_texture, uv);
}

/// What all lights send to the lanes.
void Shaded::arrive() {
    ShadeBatch::Bits wanted = 0;
    for (std::size_t i = 0; i < batch.count; ++i)
        if (!scene.materials[scene.material[hit[i]->triangle]].unlit) wanted |= Segments::bit(i);
    if (wanted == 0) return;
    pad();
    find_surfaces(batch, kShadowOffset * scene.size);
    for (const Light& light : scene.lights) {
        if (light.type == Light::Type::kAmbient) {
            add_ambient(batch, light.intensity * light.color);
            continue;
        }
        const ShadeLight seen = as_lanes_see_it(scene, light);
        find_light(batch, seen);
        const ShadeBatch::Bits lit = batch.lit & wanted;
        add_light(batch, light.color, seen.casts_shadows ? unhindered(scene, batch, lit) : lit);
    }
}

/// Empties the batch into the light that was asked for.
void Shaded::shade(std::span<Vec3> light) {
    if (batch.count == 0) return;
    arrive();
    for (std::size_t i = 0; i < batch.count; ++i) {
        const Material& material = scene.materials[scene.material[hit[i]->triangle]];
        const Vec3 base = base_colour(i, material);
        light[answer[i]] = material.unlit ? base : base * batch.arriving.get(i);
    }
    batch.count = 0;
}

}  // namespace

void shade_rays(const ShadeScene& scene, std::span<const SeenAlong> seen, std::span<Vec3> light) {
    TRILENS_CHECK(light.size() == seen.size(), "one light per ray");
    Shaded shaded(scene);
    shaded.batch.has_normals = !scene.normals.empty();
    for (std::size_t i = 0; i < seen.size(); ++i) {
        if (!seen[i].hit->seen()) {
            light[i] = shade_background(scene.background, seen[i].ray->direction);
            continue;
        }
        shaded.add(seen[i], i);
        if (shaded.batch.count == kShadeLanes) shaded.shade(light);
    }
    shaded.shade(light);
}

}  // namespace trilens
