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
#include "projector/kernel_setup-inl.h"

HWY_BEFORE_NAMESPACE();
namespace trilens {
namespace HWY_NAMESPACE {

// From here on every operation rounds as decide() rounds it: no fused multiply-add.

/// Some lanes' rays, as FacetRays::at gives them.
struct ExactRays {
    Vector3 origin, direction;
    Double weight;
};

HWY_INLINE Vector3 set3(const Vec3& v) {
    return {hn::Set(kDouble, v.x), hn::Set(kDouble, v.y), hn::Set(kDouble, v.z)};
}
HWY_INLINE Double exact_inner(const Vector3& a, const Vector3& b) {
    return hn::Add(hn::Add(hn::Mul(a.x, b.x), hn::Mul(a.y, b.y)), hn::Mul(a.z, b.z));
}
HWY_INLINE Vector3 exact_outer(const Vector3& a, const Vector3& b) {
    return {hn::Sub(hn::Mul(a.y, b.z), hn::Mul(b.y, a.z)), hn::Sub(hn::Mul(a.z, b.x), hn::Mul(b.z, a.x)),
            hn::Sub(hn::Mul(a.x, b.y), hn::Mul(b.x, a.y))};
}
HWY_INLINE Double largest_part(const Vector3& v) {
    return hn::Max(hn::Abs(v.x), hn::Max(hn::Abs(v.y), hn::Abs(v.z)));
}

/// SampleGrid::position along one axis, from lines of samples counted from the window's corner.
HWY_INLINE Double position_of_line(const Double& line, int start, int side) {
    const Double n = hn::Set(kDouble, static_cast<double>(side)), half = hn::Set(kDouble, 0.5);
    const Double pixel = hn::Floor(hn::Div(hn::Add(line, half), n));
    const Double inside = hn::Sub(line, hn::Mul(pixel, n));
    return hn::Add(hn::Add(hn::Set(kDouble, static_cast<double>(start)), pixel),
                   hn::Div(hn::Add(inside, half), n));
}

HWY_INLINE ExactRays rays_through(const FacetRays& facet, const Double& x, const Double& y) {
    const Double u = hn::Sub(x, hn::Set(kDouble, facet.screen.x)),
                 v = hn::Sub(y, hn::Set(kDouble, facet.screen.y));
    const auto family = [&](const std::array<Vec3, 3>& f) HWY_ATTR {
        return plus(plus(set3(f[0]), times(u, set3(f[1]))), times(v, set3(f[2])));
    };
    const std::array<double, 3>& w = facet.rays.weight;
    return {family(facet.rays.origin), family(facet.rays.direction),
            hn::Add(hn::Add(hn::Set(kDouble, w[0]), hn::Mul(u, hn::Set(kDouble, w[1]))),
                    hn::Mul(v, hn::Set(kDouble, w[2])))};
}

/// Cramer's rule as in decide.cpp; `good`: lanes that it may be trusted in.
struct ExactHits {
    Double t, b1, b2;
    hn::Mask<DoubleTag> good;
};

HWY_INLINE ExactHits meet_exactly(const ExactRays& ray, const Vector3 (&corner)[3]) {
    const Vector3 e1 = minus(corner[1], corner[0]), e2 = minus(corner[2], corner[0]);
    const Vector3 p = minus(ray.origin, times(ray.weight, corner[0]));
    const Vector3 q = exact_outer(ray.direction, e2), r = exact_outer(p, e1);
    const Double determinant = exact_inner(e1, q);
    const Double size = hn::Mul(largest_part(ray.direction), hn::Mul(largest_part(e1), largest_part(e2)));
    const Double scale = hn::Div(hn::Set(kDouble, 1.0), hn::Mul(determinant, ray.weight));
    ExactHits hits;
    hits.t = hn::Mul(exact_inner(e2, r), hn::Mul(ray.weight, scale));
    hits.b1 = hn::Mul(exact_inner(p, q), scale);
    hits.b2 = hn::Mul(exact_inner(ray.direction, r), scale);
    const Double zero = hn::Zero(kDouble), one = hn::Set(kDouble, 1.0);
    hits.good =
        hn::And(hn::And(hn::Ge(hn::Abs(determinant), hn::Mul(hn::Set(kDouble, kLeastDeterminant), size)),
                        hn::Lt(hn::Abs(hits.t), hn::Set(kDouble, std::numeric_limits<double>::infinity()))),
                hn::And(hn::And(hn::Ge(hits.b1, zero), hn::Ge(hits.b2, zero)),
                        hn::Le(hn::Add(hits.b1, hits.b2), one)));
    return hits;
}

/// The winners of a vector's samples, in the terms of the data's sorted corners.
struct alignas(64) Winners {
    double t[kLanes], b1[kLanes], b2[kLanes];
    Id triangle[kLanes];  // index into PreparedScene::Data, or kNone
};

HWY_NOINLINE void write_hits(const KernelScene& scene, std::uint32_t vector, const Winners& winners) {
    const VectorSamples& samples = scene.tiles->samples[vector];
    if (!scene.vector_hits.empty()) {
        VectorHits& out = scene.vector_hits[vector];
        for (std::size_t k = 0; k < kLanes; ++k) {
            const Id winner = winners.triangle[k];
            Hit hit;
            if (winner != kNone)
                hit = scene_hit(*scene.data, winner, {winners.t[k], {winners.b1[k], winners.b2[k]}});
            set_lane(out, k, hit);
        }
    }
    if (!scene.hits.empty()) {
        for (Each lane(samples.valid); lane; ++lane) {
            const std::size_t k = *lane;
            const Id winner = winners.triangle[k];
            scene.hits[samples.sample[k]] =
                winner == kNone
                    ? Hit{}
                    : scene_hit(*scene.data, winner, {winners.t[k], {winners.b1[k], winners.b2[k]}});
        }
    }
}

HWY_INLINE std::array<Vec3, 3> corners_of(const PreparedScene::Data& data, Id triangle, const Vec3& centre) {
    return {data.corner(0, triangle, centre), data.corner(1, triangle, centre),
            data.corner(2, triangle, centre)};
}

/// Where one sure hit lies, by the scalar decision, which must agree that it is one.
HWY_NOINLINE LineHit decide_sure(const KernelScene& scene, const FacetRays& facet, Id sample, Id triangle) {
    const std::optional<LineHit> hit =
        decide(facet.at(scene.grid->position(sample)), corners_of(*scene.data, triangle, facet.centre));
    TRILENS_CHECK(hit.has_value(), "a sure hit must be one for the exact decision too");
    return *hit;
}

/// Fills in t and the barycentrics of a vector's sure hits.
HWY_NOINLINE void place_sure_hits(const KernelScene& scene, const SampleTile& tile, std::uint32_t vector,
                                  const Nearest& nearest, Winners& winners) {
    const FacetRays& facet = scene.tiles->rays[tile.rays];
    const SampleVector& samples = scene.tiles->vectors[vector];
    const SampleGrid& grid = *scene.grid;
    const double middle_x = 0.5 * (tile.width - 1), middle_y = 0.5 * (tile.height - 1);
    const double half_x = std::max(0.5, middle_x), half_y = std::max(0.5, middle_y);
    std::copy_n(nearest.triangle, kLanes, winners.triangle);

    for (std::size_t at = 0; at < kLanes; at += kDoubles) {
        // Corners of all lanes' triangles; lanes that see nothing borrow any.
        const Id first = winners.triangle[at];
        bool same = first != kNone;
        for (std::size_t k = at + 1; k < at + kDoubles; ++k) same = same && winners.triangle[k] == first;
        Vector3 corner[3];
        if (same) {
            for (std::size_t k = 0; k < 3; ++k) corner[k] = set3(scene.data->corner(k, first, facet.centre));
        } else {
            HWY_ALIGN double own[3][3][kDoubles] = {};
            for (std::size_t i = 0; i < kDoubles; ++i) {
                const Id triangle = winners.triangle[at + i];
                if (triangle == kNone) continue;
                for (std::size_t k = 0; k < 3; ++k) {
                    const Vec3 c = scene.data->corner(k, triangle, facet.centre);
                    own[k][0][i] = c.x;
                    own[k][1][i] = c.y;
                    own[k][2][i] = c.z;
                }
            }
            for (int k = 0; k < 3; ++k)
                corner[k] = {hn::Load(kDouble, own[k][0]), hn::Load(kDouble, own[k][1]),
                             hn::Load(kDouble, own[k][2])};
        }
        HWY_ALIGN double lattice_x[kDoubles], lattice_y[kDoubles];
        for (std::size_t i = 0; i < kDoubles; ++i) {
            lattice_x[i] = samples.u[at + i] * half_x + middle_x;
            lattice_y[i] = samples.v[at + i] * half_y + middle_y;
        }
        const Double column = hn::Add(hn::Round(hn::Load(kDouble, lattice_x)),
                                      hn::Set(kDouble, static_cast<double>(tile.column)));
        const Double row =
            hn::Add(hn::Round(hn::Load(kDouble, lattice_y)), hn::Set(kDouble, static_cast<double>(tile.row)));
        const ExactRays rays = rays_through(facet, position_of_line(column, grid.x0, grid.side),
                                            position_of_line(row, grid.y0, grid.side));
        const ExactHits hits = meet_exactly(rays, corner);
        hn::Store(hits.t, kDouble, winners.t + at);
        hn::Store(hits.b1, kDouble, winners.b1 + at);
        hn::Store(hits.b2, kDouble, winners.b2 + at);
        std::uint8_t good_bits[8] = {};
        hn::StoreMaskBits(kDouble, hits.good, good_bits);
        for (Each lane(first_lanes(kDoubles) & ~good_bits[0]); lane; ++lane) {
            const std::size_t k = at + *lane;
            if (winners.triangle[k] == kNone) continue;
            const LineHit hit =
                decide_sure(scene, facet, scene.tiles->samples[vector].sample[k], winners.triangle[k]);
            winners.t[k] = hit.t;
            winners.b1[k] = hit.barycentric.x;
            winners.b2[k] = hit.barycentric.y;
        }
    }
}

/// One sample among its sure hit and its doubtful triangles, all decided exactly, by FirstHits' rule.
HWY_NOINLINE void resolve_sample(const KernelScene& scene, const FacetRays& facet, Id sample,
                                 std::span<const Doubt> doubts, std::size_t lane, Winners& winners) {
    const SampleRay ray = facet.at(scene.grid->position(sample));
    const Id sure = winners.triangle[lane];
    FirstHits hits(1);
    const auto offer_all = [&] {
        Id last = kNone;
        const auto offer = [&](Id triangle) {
            const std::optional<LineHit> hit = decide(ray, corners_of(*scene.data, triangle, facet.centre));
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
    winners.triangle[lane] = hits.winner(0);
    if (hits.winner(0) == kNone) return;
    winners.t[lane] = hits.hit(0).t;
    winners.b1[lane] = hits.hit(0).barycentric.x;
    winners.b2[lane] = hits.hit(0).barycentric.y;
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
        for (std::uint32_t i = 0; i < tile.vectors; ++i) {
            const std::uint32_t vector = tile.first_vector + i, in_group = vector - state.first_vector;
            Winners winners;
            place_sure_hits(scene, tile, vector, state.nearest[in_group], winners);
            while (next < doubts.size() && doubts[next].vector == in_group) {
                std::size_t end = next;
                while (end < doubts.size() && doubts[end].vector == in_group &&
                       doubts[end].lane == doubts[next].lane)
                    ++end;
                const std::size_t lane = doubts[next].lane;
                resolve_sample(scene, facet, scene.tiles->samples[vector].sample[lane],
                               std::span(doubts).subspan(next, end - next), lane, winners);
                next = end;
            }
            write_hits(scene, vector, winners);
        }
    }
}

}  // namespace HWY_NAMESPACE
}  // namespace trilens
HWY_AFTER_NAMESPACE();

#endif
