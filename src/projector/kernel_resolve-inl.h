// What each sample sees, with the bits that decide() gives: sure hits in lanes, doubtful ones one by one.
// Included once per instruction set.
#if defined(TRILENS_KERNEL_RESOLVE_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef TRILENS_KERNEL_RESOLVE_INL_H
#undef TRILENS_KERNEL_RESOLVE_INL_H
#else
#define TRILENS_KERNEL_RESOLVE_INL_H
#endif

#include <algorithm>

#include "base/check.h"
#include "projector/kernel_place-inl.h"

HWY_BEFORE_NAMESPACE();
namespace trilens {
namespace HWY_NAMESPACE {

/// What a vector's samples see, in the terms of the scene's triangles.
struct alignas(64) Placed {
    double t[kLanes], second[kLanes], third[kLanes];
    Id triangle[kLanes];
};

HWY_INLINE void set_lane(Placed& placed, std::size_t lane, const Hit& hit) {
    placed.triangle[lane] = hit.triangle;
    placed.t[lane] = hit.t;
    placed.second[lane] = hit.barycentric.x;
    placed.third[lane] = hit.barycentric.y;
}

/// Past the caches: nobody here reads it again.
HWY_INLINE void stream_floats(const double* from, float* to) {
    const hn::Rebind<float, DoubleTag> some;
    alignas(64) float floats[kLanes];
    for (std::size_t at = 0; at < kLanes; at += kDoubles)
        hn::Store(hn::DemoteTo(some, hn::Load(kDouble, from + at)), some, floats + at);
    stream(load(floats), to);
}

HWY_NOINLINE void write_hits(const KernelScene& scene, std::uint32_t vector, const Placed& placed) {
    if (!scene.vector_hits.empty()) {
        VectorHits& out = scene.vector_hits[vector];
        stream_words(load_words(placed.triangle), out.triangle);
        stream_floats(placed.t, out.t);
        stream_floats(placed.second, out.u);
        stream_floats(placed.third, out.v);
    }
    if (scene.hits.empty()) return;
    const VectorSamples& samples = scene.tiles->samples[vector];
    for (Each lane(samples.valid); lane; ++lane) {
        const std::size_t k = *lane;
        scene.hits[samples.sample[k]] = {
            placed.triangle[k], placed.t[k], {placed.second[k], placed.third[k]}};
    }
}

HWY_INLINE std::array<Vec3, 3> corners_of(const PreparedScene::Data& data, Id triangle, const Vec3& centre) {
    return {data.corner(0, triangle, centre), data.corner(1, triangle, centre),
            data.corner(2, triangle, centre)};
}

/// Where one sure hit lies, by the scalar decision, which must agree that it is one.
HWY_NOINLINE Hit decide_sure(const KernelScene& scene, const FacetRays& facet, Id sample, Id triangle) {
    const std::optional<LineHit> hit = decide(facet, facet.at(scene.grid->position(sample)),
                                              corners_of(*scene.data, triangle, facet.centre));
    TRILENS_CHECK(hit.has_value(), "a sure hit must be one for the exact decision too");
    return scene_hit(*scene.data, triangle, *hit);
}

HWY_NOINLINE void fill_forms(const KernelScene& scene, const Vec3& centre, Id triangle,
                             const FacetCoefficients& facet, CachedForms& to) {
    const std::array<Vec3, 3> corner = corners_of(*scene.data, triangle, centre);
    make_forms(facet, corner.data(), to);
    to.triangle = scene.data->triangle[triangle];
    const std::array<std::uint8_t, 3>& was = scene.data->was_corner[triangle];
    to.second_corner = was[0] == 1 ? 0 : was[1] == 1 ? 1 : 2;
    to.third_corner = was[0] == 2 ? 0 : was[1] == 2 ? 1 : 2;
}

HWY_INLINE bool has_forms(const FormCache& cache, const SampleTile& tile, Id triangle) {
    return cache.rays == tile.rays && cache.triangle[triangle % kCachedForms] == triangle;
}

HWY_INLINE const CachedForms& cached_forms(const KernelScene& scene, const SampleTile& tile, Id triangle,
                                           FormCache& cache) {
    if (cache.rays != tile.rays) {
        cache.triangle.fill(kNone);
        cache.rays = tile.rays;
        set_facet(scene.tiles->rays[tile.rays], cache.facet);
    }
    const std::size_t at = triangle % kCachedForms;
    if (cache.triangle[at] != triangle) {
        fill_forms(scene, scene.tiles->rays[tile.rays].centre, triangle, cache.facet, cache.forms[at]);
        cache.triangle[at] = triangle;
    }
    return cache.forms[at];
}

HWY_INLINE const Double& weight_of(const PlacedLanes& p, std::uint8_t sorted_corner) {
    return sorted_corner == 0 ? p.first : sorted_corner == 1 ? p.second : p.third;
}

HWY_INLINE std::uint32_t bits(const hn::Mask<DoubleTag>& mask) {
    std::uint8_t bytes[8] = {};
    hn::StoreMaskBits(kDouble, mask, bytes);
    return bytes[0];
}

HWY_INLINE hn::Mask<DoubleTag> mask_of_doubles(std::uint32_t lanes) {
    const std::uint8_t bytes[8] = {static_cast<std::uint8_t>(lanes)};
    return hn::LoadMaskBits(kDouble, bytes);
}

/// Lanes of a vector that see one triangle. Returns those where place() says nothing.
HWY_INLINE std::uint32_t place_on_one(const CachedForms& cached, const SampleLanes* samples,
                                      std::uint32_t lanes, const TileTrust& trust, Placed& placed) {
    const FormLanes forms = broadcast(cached);
    std::uint32_t bad = 0;
    for (std::size_t at = 0, i = 0; at < kLanes; at += kDoubles, ++i) {
        const std::uint32_t own = lanes >> at & first_lanes(kDoubles);
        if (!own) continue;
        const PlacedLanes p = place_lanes(forms, samples[i], trust);
        const auto mask = mask_of_doubles(own);
        hn::BlendedStore(p.t, mask, kDouble, placed.t + at);
        hn::BlendedStore(weight_of(p, cached.second_corner), mask, kDouble, placed.second + at);
        hn::BlendedStore(weight_of(p, cached.third_corner), mask, kDouble, placed.third + at);
        bad |= (own & ~bits(p.good)) << at;
    }
    return bad;
}

/// Lanes that see many triangles: each its own forms.
HWY_NOINLINE std::uint32_t place_on_many(const KernelScene& scene, const FacetRays& facet,
                                         const SampleLanes* samples, const Id* triangle, std::uint32_t lanes,
                                         const TileTrust& trust, Placed& placed) {
    const PreparedScene::Data& data = *scene.data;
    std::uint32_t bad = 0;
    for (std::size_t at = 0, i = 0; at < kLanes; at += kDoubles, ++i) {
        const std::uint32_t own = lanes >> at & first_lanes(kDoubles);
        if (!own) continue;
        HWY_ALIGN double at_corner[3][3][kDoubles] = {};
        for (Each lane(own); lane; ++lane) {
            for (std::size_t k = 0; k < 3; ++k) {
                const Vec3 c = data.corner(k, triangle[at + *lane], facet.centre);
                at_corner[k][0][*lane] = c.x;
                at_corner[k][1][*lane] = c.y;
                at_corner[k][2][*lane] = c.z;
            }
        }
        Vector3 corner[3];
        for (int k = 0; k < 3; ++k)
            corner[k] = {hn::Load(kDouble, at_corner[k][0]), hn::Load(kDouble, at_corner[k][1]),
                         hn::Load(kDouble, at_corner[k][2])};
        const PlacedLanes p = place_lanes(forms_in_lanes(facet, corner), samples[i], trust);
        HWY_ALIGN double weight[3][kDoubles], t[kDoubles];
        hn::Store(p.t, kDouble, t);
        hn::Store(p.first, kDouble, weight[0]);
        hn::Store(p.second, kDouble, weight[1]);
        hn::Store(p.third, kDouble, weight[2]);
        for (Each lane(own); lane; ++lane) {
            const std::size_t k = at + *lane;
            const std::array<std::uint8_t, 3>& was = data.was_corner[triangle[k]];
            double of[3];
            for (std::size_t c = 0; c < 3; ++c) of[was[c]] = weight[c][*lane];
            placed.t[k] = t[*lane];
            placed.second[k] = of[1];
            placed.third[k] = of[2];
            placed.triangle[k] = data.triangle[triangle[k]];
        }
        bad |= (own & ~bits(p.good)) << at;
    }
    return bad;
}

/// What the samples of a vector surely see.
HWY_NOINLINE void place_sure_hits(const KernelScene& scene, const SampleTile& tile, std::uint32_t vector,
                                  const Nearest& nearest, const TileTrust& trust, FormCache& cache,
                                  Placed& placed) {
    constexpr int kSeveral = 4;  // measured: so many lanes that see one triangle are worth its own forms
    const FacetRays& facet = scene.tiles->rays[tile.rays];
    SampleLanes samples[kLanes / kDoubles];
    for (std::size_t at = 0, i = 0; at < kLanes; at += kDoubles, ++i)
        samples[i] = samples_of(*scene.grid, facet, tile, scene.tiles->vectors[vector], at);

    const Words triangles = load_words(nearest.triangle);
    const std::uint32_t see = kAllLanes & ~bits(same(triangles, set_word(kNone)));
    std::uint32_t left = see, bad = 0;
    if (see != kAllLanes) {
        for (std::size_t k = 0; k < kLanes; ++k) set_lane(placed, k, Hit{});
    }
    std::uint32_t alone = 0;
    for (; left; left &= left - 1) {
        const std::uint32_t first = static_cast<std::uint32_t>(std::countr_zero(left));
        const Id triangle = nearest.triangle[first];
        const Mask see_it = same(triangles, set_word(triangle));
        const std::uint32_t own = bits(see_it);
        if (std::popcount(own) < kSeveral && !has_forms(cache, tile, triangle)) {
            alone |= own;
        } else {
            const CachedForms& forms = cached_forms(scene, tile, triangle, cache);
            store_words(choose(see_it, set_word(forms.triangle), load_words(placed.triangle)),
                        placed.triangle);
            bad |= place_on_one(forms, samples, own, trust, placed);
        }
        left &= ~own | 1u << first;
    }
    if (alone) bad |= place_on_many(scene, facet, samples, nearest.triangle, alone, trust, placed);
    if (!trust.weight) bad = see;
    for (Each lane(bad); lane; ++lane)
        set_lane(
            placed, *lane,
            decide_sure(scene, facet, scene.tiles->samples[vector].sample[*lane], nearest.triangle[*lane]));
}

/// One sample among its sure hit, if any, and its doubtful triangles, all decided exactly, by FirstHits'
/// rule.
HWY_NOINLINE Hit resolve_sample(const KernelScene& scene, const FacetRays& facet, Id sample, Id sure,
                                std::span<const Doubt> doubts) {
    const SampleRay ray = facet.at(scene.grid->position(sample));
    FirstHits hits(1);
    const auto offer_all = [&] {
        Id last = kNone;
        const auto offer = [&](Id triangle) {
            const std::optional<LineHit> hit =
                decide(facet, ray, corners_of(*scene.data, triangle, facet.centre));
            if (hit) hits.offer(0, *hit, triangle, scene.data->rank[triangle]);
        };
        if (sure != kNone) offer(sure);
        for (const Doubt& doubt : doubts) {
            if (doubt.triangle != last && doubt.triangle != sure) offer(doubt.triangle);
            last = doubt.triangle;
        }
    };
    offer_all();
    if (hits.order_mattered()) hits.begin_second_pass(), offer_all();
    const Id winner = hits.winner(0);
    return winner == kNone ? Hit{} : scene_hit(*scene.data, winner, hits.hit(0));
}

/// Writes the hits of all of the group's samples.
HWY_NOINLINE void resolve_group(const KernelScene& scene, KernelState& state) {
    std::vector<Doubt>& doubts = state.doubts;
    std::sort(doubts.begin(), doubts.end(), [](const Doubt& a, const Doubt& b) {
        if (a.vector != b.vector) return a.vector < b.vector;
        return a.lane != b.lane ? a.lane < b.lane : a.triangle < b.triangle;
    });
    std::size_t next = 0;
    for (std::uint32_t j = state.first_lane; j < state.first_lane + state.tiles; ++j) {
        const SampleTile& tile = scene.tiles->tiles[state.first_tile + j];
        const FacetRays& facet = scene.tiles->rays[tile.rays];
        const TileTrust trust = trust_of(facet, tile, *scene.grid);
        Placed placed;
        for (std::uint32_t i = 0; i < tile.vectors; ++i) {
            const std::uint32_t vector = tile.first_vector + i, in_group = vector - state.first_vector;
            const Nearest& nearest = state.nearest[in_group];
            place_sure_hits(scene, tile, vector, nearest, trust, state.cache, placed);
            while (next < doubts.size() && doubts[next].vector == in_group) {
                std::size_t end = next;
                while (end < doubts.size() && doubts[end].vector == in_group &&
                       doubts[end].lane == doubts[next].lane)
                    ++end;
                const std::size_t lane = doubts[next].lane;
                set_lane(placed, lane,
                         resolve_sample(scene, facet, scene.tiles->samples[vector].sample[lane],
                                        nearest.triangle[lane], std::span(doubts).subspan(next, end - next)));
                next = end;
            }
            write_hits(scene, vector, placed);
        }
    }
}

}  // namespace HWY_NAMESPACE
}  // namespace trilens
HWY_AFTER_NAMESPACE();

#endif
