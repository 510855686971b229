// What many rays show: their hits shaded in batches.
#include <algorithm>
#include <array>
#include <numbers>

#include "base/util/check.h"
#include "shade/light_batch.h"
#include "shade/shade.h"

namespace trilens {
namespace {

/// Those of the lanes whose shadow rays meet nothing.
ShadeBatch::Bits unhindered(const std::function<Segments::Bits(const Segments&)>& occluded,
                            const ShadeBatch& batch, ShadeBatch::Bits lanes) {
    Segments segments;
    std::array<std::size_t, kShadeLanes> lane_of;
    for_each_of(lanes, [&](std::size_t i) {
        lane_of[segments.count] = i;
        segments.add(batch.shadow_start.get(i), batch.way.get(i));
    });
    if (segments.count == 0) return 0;
    for_each_of(occluded(segments), [&](std::size_t s) { lanes &= ~Segments::bit(lane_of[s]); });
    return lanes;
}

std::size_t lobe_count(const Light& dome) {
    const auto* environment = std::get_if<EnvironmentLight>(&dome.kind);
    return static_cast<std::size_t>(environment ? environment->samples
                                                : std::get<AmbientLight>(dome.kind).samples);
}

/// How far shadow rays of its reflection go.
double lobe_length(const ShadeScene& scene, const Light& dome) {
    const auto* ambient = std::get_if<AmbientLight>(&dome.kind);
    return occlusion_distance(ambient ? *ambient : AmbientLight{}, scene.size);
}

/// The mean radiance over a square of directions, `side` radians wide.
Vec3 dome_radiance(const ShadeScene& scene, const Light& dome, const Vec3& toward, double side) {
    const Vec3 factor = dome.intensity * dome.color;
    if (std::holds_alternative<AmbientLight>(dome.kind)) return factor;
    if (!scene.environment_map) return factor * shade_background(scene.background, toward);
    const auto [u, v] = tangent_basis(toward);
    return factor *
           background_radiance(scene.background, *scene.environment_map, toward, {side * u, side * v});
}

/// Of sets of lights the hash is the sum of these: a number like a random one (splitmix64's finalizer).
std::uint64_t number_of_light(std::size_t light) {
    std::uint64_t x = (light + 1) * 0x9e3779b97f4a7c15u;
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
    return x ^ (x >> 31);
}

/// A lane whose surface is no plain one.
struct ViewedLane {
    ViewedSurface surface;
    MapTexels texels;
    ArrivedLight arrived;
};

/// A batch on its way, with what is not the same number in all lanes.
struct Shaded {
    explicit Shaded(const ShadeScene& of_scene)
        : scene(of_scene) {}  // lanes hold anything until they are set

    const ShadeScene& scene;
    ShadeBatch batch;
    std::array<const SeenAlong*, kShadeLanes> seen;
    std::array<std::size_t, kShadeLanes> answer;    // index of the light that comes out
    std::array<std::uint64_t, kShadeLanes> lights;  // as ReachingLight has them
    // Lanes that the batch's sums are not enough for, with their own.
    ShadeBatch::Bits viewed = 0;
    std::vector<ViewedLane> viewed_lane;    // as many as lanes, once there are any
    std::array<Vec3, kShadeLanes> caustic;  // irradiance over pi that comes over optics; then its radiance

    void add(const SeenAlong& seen, std::size_t index);
    void pad();
    void arrive();
    void add_baked(std::size_t lane);
    void add_caustic(std::size_t light, ShadeBatch::Bits wanted);
    void arrive_from(std::size_t light, ShadeBatch::Bits wanted);
    void find_viewed(ShadeBatch::Bits wanted);
    Vec3 find_sample(std::size_t light, std::size_t sample);
    void add_viewed(std::size_t light, std::size_t sample, ShadeBatch::Bits lit);
    void add_lobe(std::size_t light, std::size_t lane);
    void dim(ShadeBatch::Bits lit);
    ArrivedLight arrived(std::size_t lane) const;
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
    std::fill_n(caustic.begin(), batch.count, Vec3(0));
    if (wanted == 0) return;
    pad();
    find_surfaces(batch, kShadowOffset * scene.size);
    find_viewed(wanted);
    if (!scene.baked.empty()) for_each_of(wanted, [&](std::size_t i) { add_baked(i); });
    for (std::size_t l = 0; l < scene.lights.size(); ++l)
        if (!scene.lights[l].baked) arrive_from(l, wanted);
}

/// What was computed beforehand.
void Shaded::add_baked(std::size_t i) {
    const Vec3 light = baked_light_at(scene, *seen[i]->hit, seen[i]->ray->direction);
    batch.arriving.set(i, light);  // the first that arrives
    if (viewed & Segments::bit(i)) viewed_lane[i].arrived.matt += light;
}

/// What one light sends to the lanes that are wanted.
void Shaded::arrive_from(std::size_t l, ShadeBatch::Bits wanted) {
    const Light& light = scene.lights[l];
    const bool shadows = is_hindered(light) && scene.occluded;
    if (std::holds_alternative<AmbientLight>(light.kind) && !shadows) {
        add_ambient(batch, light.intensity * light.color);
        for (std::size_t k = 0; viewed && k < sample_count(scene, l); ++k) {
            find_sample(l, k);
            add_viewed(l, k, batch.lit & viewed);
        }
        for_each_of(viewed, [&](std::size_t i) { add_lobe(l, i); });
        return;
    }
    const std::size_t samples = sample_count(scene, l);
    ShadeBatch::Bits by_any = 0;
    for (std::size_t k = 0; k < samples; ++k) {
        const Vec3 color = find_sample(l, k) * light.color;
        ShadeBatch::Bits lit = batch.lit & wanted;
        if (shadows) lit = unhindered(light.caustics ? scene.occluded_by_all : scene.occluded, batch, lit);
        if (shadows) dim(lit);

        add_light(batch, color, lit);
        add_viewed(l, k, lit & viewed);
        by_any |= lit;
    }
    if (is_dome(light)) for_each_of(viewed, [&](std::size_t i) { add_lobe(l, i); });
    if (light.caustics && scene.caustic) add_caustic(l, wanted);
    if (samples == 1) for_each_of(by_any, [&](std::size_t i) { lights[i] += number_of_light(l); });
}

/// The light found last, by what it passes through.
void Shaded::dim(ShadeBatch::Bits lit) {
    if (!scene.let_through) return;
    for_each_of(lit, [&](std::size_t i) {
        batch.irradiance[i] *= scene.let_through({batch.shadow_start.get(i), batch.way.get(i)});
    });
}

/// Normals by the materials' maps, and how surfaces that are not plain are looked at.
void Shaded::find_viewed(ShadeBatch::Bits wanted) {
    viewed = 0;
    for_each_of(wanted, [&](std::size_t i) {
        const Hit& hit = *seen[i]->hit;
        if (is_plain(scene, hit)) return;
        viewed |= Segments::bit(i);
        viewed_lane.resize(kShadeLanes);
        const MapTexels texels = seen[i]->texels ? *seen[i]->texels : texels_at(scene, *seen[i]);
        const Vec3 normal =
            mapped_normal(scene, hit, {batch.normal.get(i), batch.geometric_normal.get(i)}, texels.normal);
        batch.normal.set(i, normal);
        const Vec3 view = -normalize_or_zero(batch.toward.get(i));
        viewed_lane[i] = {{normal, view, look_at(scene, hit, texels).roughness}, texels, {}};
    });
}

/// The light found last, in lanes that it reaches.
void Shaded::add_viewed(std::size_t l, std::size_t sample, ShadeBatch::Bits lit) {
    const Light& light = scene.lights[l];
    for_each_of(lit, [&](std::size_t i) {
        ViewedLane& lane = viewed_lane[i];
        const LightSample at =
            light_sample(scene, l, sample, {batch.position.get(i), batch.normal.get(i), scene.size});
        const Vec3 irradiance = std::numbers::pi * batch.irradiance[i] * (at.color * light.color);
        ArrivedLight one = arrived_from(lane.surface, at.toward, irradiance, at.spread);
        if (is_dome(light)) {  // its reflection comes by add_lobe
            one.glossy = one.glossy_grazing = Vec3(0);
            one *= lane.texels.occlusion;
        } else {  // the mean of cosines is the mean normal's, which is shorter than 1
            one.matt *= lane.texels.normal_length;
            one.matt_grazing *= lane.texels.normal_length;
        }
        lane.arrived += one;
    });
}

/// The reflection of light that comes from everywhere, in the directions that the lane's lobe has.
void Shaded::add_lobe(std::size_t l, std::size_t i) {
    const Light& light = scene.lights[l];
    ViewedLane& lane = viewed_lane[i];
    const std::size_t count = lobe_count(light);
    const double far = lobe_length(scene, light);
    const bool shadows = light.shadows && scene.occluded;
    Segments segments;
    std::array<LobeDirection, Segments::kMost> direction;
    const auto add_up = [&] {
        const Segments::Bits hidden = shadows && segments.count > 0 ? scene.occluded(segments) : 0;
        for_each_of(segments.all() & ~hidden, [&](std::size_t s) {
            Vec3 radiance =
                lane.texels.occlusion * dome_radiance(scene, light, direction[s].toward, direction[s].side);
            if (shadows && scene.let_through) radiance *= scene.let_through(segments.ray(s));
            lane.arrived.glossy += direction[s].glossy * radiance;
            lane.arrived.glossy_grazing += direction[s].grazing * radiance;
        });
        segments.count = 0;
    };
    for (std::size_t k = 0; k < count; ++k) {
        const LobeDirection one = lobe_direction(lane.surface, k, count);
        if (one.glossy == 0) continue;
        direction[segments.count] = one;
        segments.add(batch.shadow_start.get(i), far * one.toward);
        if (segments.count == Segments::kMost) add_up();
    }
    add_up();
}

ArrivedLight Shaded::arrived(std::size_t lane) const {
    if (viewed & Segments::bit(lane)) return viewed_lane[lane].arrived;
    return {.matt = batch.arriving.get(lane)};
}

/// One sample of a light as each lane sees it; gives its colour beside the light's.
Vec3 Shaded::find_sample(std::size_t light, std::size_t sample) {
    const LightLanes lanes = light_lanes(scene, light, sample);
    find_light(batch, lanes, is_hindered(scene.lights[light]) && scene.occluded);
    return lanes.color;
}

/// What comes over optics.
void Shaded::add_caustic(std::size_t light, ShadeBatch::Bits wanted) {
    for_each_of(wanted, [&](std::size_t i) {
        if (seen[i]->without_caustics) return;
        Receiver receiver;
        receiver.point = batch.position.get(i);
        receiver.normal = batch.geometric_normal.get(i);
        receiver.shading_normal = batch.normal.get(i);
        receiver.lifted = batch.shadow_start.get(i);
        if (seen[i]->footprint) receiver.sides = *seen[i]->footprint;
        receiver.seen_along = seen[i]->ray->direction;
        receiver.triangle = seen[i]->hit->triangle;
        receiver.exact = seen[i]->exact_caustics;
        receiver.cancel = seen[i]->cancel;
        caustic[i] += std::numbers::inv_pi * scene.caustic(light, receiver);
    });
}

/// Puts the batch into the light that was asked for.
void Shaded::shade(std::span<Vec3> light) {
    if (batch.count == 0) return;
    arrive();
    for (std::size_t i = 0; i < batch.count; ++i) {
        const Hit& hit = *seen[i]->hit;
        const bool is_viewed = (viewed & Segments::bit(i)) != 0;
        const MapTexels texels = seen[i]->texels ? *seen[i]->texels
                                 : is_viewed     ? viewed_lane[i].texels
                                                 : texels_at(scene, *seen[i]);
        if (!is_lit(scene, hit)) {
            light[answer[i]] = texels.base;
            continue;
        }
        SurfaceLook look = look_at(scene, hit, texels);
        light[answer[i]] = outgoing_radiance(look, arrived(i));
        if (caustic[i] == Vec3(0)) continue;
        look.emissive = Vec3(0);
        caustic[i] = outgoing_radiance(look, {.matt = caustic[i]});
        light[answer[i]] += caustic[i];
    }
}

void Shaded::find_reaching(std::span<ReachingLight> to) {
    for (std::size_t i = 0; i < batch.count; ++i)
        if (is_lit(scene, *seen[i]->hit)) to[answer[i]] = {lights[i], arrived(i), caustic[i]};
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
            light[i] = seen[i].texels ? seen[i].texels->base : texels_at(scene, seen[i]).base;
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
