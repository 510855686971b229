// What many rays show: their hits shaded in batches.
#include <algorithm>
#include <array>

#include "base/util/check.h"
#include "shade/shade.h"
#include "shade/shade_batch.h"

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

/// Of sets of lights the hash is the sum of these: a number like a random one (splitmix64's finalizer).
std::uint64_t number_of_light(std::size_t light) {
    std::uint64_t x = (light + 1) * 0x9e3779b97f4a7c15u;
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
    return x ^ (x >> 31);
}

/// A batch on its way, with what is not the same number in all lanes.
struct Shaded {
    explicit Shaded(const ShadeScene& of_scene)
        : scene(of_scene) {}  // lanes hold anything until they are set

    const ShadeScene& scene;
    ShadeBatch batch;
    std::array<const SeenAlong*, kShadeLanes> seen;
    std::array<std::size_t, kShadeLanes> answer;    // index of the light that comes out
    std::array<std::uint64_t, kShadeLanes> lights;  // as ReachingLight has them

    void add(const SeenAlong& seen, std::size_t index);
    void pad();
    void arrive();
    void shade(std::span<Vec3> light);
    void find_reaching(std::span<ReachingLight> to);

  private:
    void set(std::size_t lane, const Hit& hit, const Vec3& toward);
};

void Shaded::set(std::size_t lane, const Hit& hit, const Vec3& toward) {
    const IdTriple& corner = scene.triangles->triangles[hit.triangle];
    for (std::size_t k = 0; k < 3; ++k) batch.corner[k].set(lane, scene.triangles->points[corner[k]]);
    if (batch.has_normals) {
        const bool given = hit.triangle < scene.normals.size();
        for (std::size_t k = 0; k < 3; ++k)
            batch.corner_normal[k].set(lane, given ? scene.normals[hit.triangle][k] : Vec3(0));
    }
    batch.toward.set(lane, toward);
    batch.weight[0][lane] = 1 - hit.barycentric.x - hit.barycentric.y;
    batch.weight[1][lane] = hit.barycentric.x;
    batch.weight[2][lane] = hit.barycentric.y;
}

void Shaded::add(const SeenAlong& one, std::size_t index) {
    set(batch.count, *one.hit, one.ray->direction);
    seen[batch.count] = &one;
    answer[batch.count++] = index;
}

/// Lanes beyond the last are computed with the rest of their vector: they repeat it.
void Shaded::pad() {
    constexpr std::size_t kWidest = 8;
    const Vec3 toward = batch.toward.get(batch.count - 1);
    for (std::size_t i = batch.count; i % kWidest != 0; ++i) set(i, *seen[batch.count - 1]->hit, toward);
}

/// What all lights send to the lanes.
void Shaded::arrive() {
    ShadeBatch::Bits wanted = 0;
    for (std::size_t i = 0; i < batch.count; ++i)
        if (is_lit(scene, *seen[i]->hit)) wanted |= Segments::bit(i);
    std::fill_n(lights.begin(), batch.count, std::uint64_t{0});
    if (wanted == 0) return;
    pad();
    find_surfaces(batch, kShadowOffset * scene.size);
    for (std::size_t l = 0; l < scene.lights.size(); ++l) {
        const Light& light = scene.lights[l];
        if (light.type == Light::Type::kAmbient) {
            add_ambient(batch, light.intensity * light.color);
            continue;
        }
        const ShadeLight as_seen = as_lanes_see_it(scene, light);
        find_light(batch, as_seen);
        ShadeBatch::Bits lit = batch.lit & wanted;
        if (as_seen.casts_shadows) lit = unhindered(scene, batch, lit);
        add_light(batch, light.color, lit);
        for_each_of(lit, [&](std::size_t i) { lights[i] += number_of_light(l); });
    }
}

/// Puts the batch into the light that was asked for.
void Shaded::shade(std::span<Vec3> light) {
    if (batch.count == 0) return;
    arrive();
    for (std::size_t i = 0; i < batch.count; ++i) {
        const Hit& hit = *seen[i]->hit;
        const Vec3 base = seen[i]->base ? *seen[i]->base : base_colour(scene, *seen[i]);
        light[answer[i]] = is_lit(scene, hit) ? base * batch.arriving.get(i) : base;
    }
}

void Shaded::find_reaching(std::span<ReachingLight> to) {
    for (std::size_t i = 0; i < batch.count; ++i)
        if (is_lit(scene, *seen[i]->hit)) to[answer[i]] = {lights[i], batch.arriving.get(i)};
}

}  // namespace

void shade_rays(const ShadeScene& scene, std::span<const SeenAlong> seen, std::span<Vec3> light,
                std::span<ReachingLight> reaching) {
    TRILENS_CHECK(light.size() == seen.size(), "one light per ray");
    Shaded shaded(scene);
    shaded.batch.has_normals = !scene.normals.empty();
    const auto empty = [&] {
        shaded.shade(light);
        if (!reaching.empty()) shaded.find_reaching(reaching);
        shaded.batch.count = 0;
    };
    for (std::size_t i = 0; i < seen.size(); ++i) {
        if (!seen[i].hit->seen()) {
            light[i] = seen[i].base ? *seen[i].base : base_colour(scene, seen[i]);
            continue;
        }
        shaded.add(seen[i], i);
        if (shaded.batch.count == kShadeLanes) empty();
    }
    empty();
}

void find_reaching_light(const ShadeScene& scene, std::span<const SeenAlong> seen,
                         std::span<ReachingLight> reaching) {
    Shaded shaded(scene);
    shaded.batch.has_normals = !scene.normals.empty();
    const auto empty = [&] {
        if (shaded.batch.count > 0) shaded.arrive();
        shaded.find_reaching(reaching);
        shaded.batch.count = 0;
    };
    for (std::size_t i = 0; i < seen.size(); ++i) {
        shaded.add(seen[i], i);
        if (shaded.batch.count == kShadeLanes) empty();
    }
    empty();
}

}  // namespace trilens
