// A leaf mode: samples' own rays, for triangles of few samples. Vectors whose beams miss the leaf are
// skipped; then lanes are a vector's samples, one triangle after the other, or triangles, one sample after
// the other.
// Included once per instruction set.
#if defined(TRILENS_KERNEL_LEAF_RAYS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef TRILENS_KERNEL_LEAF_RAYS_INL_H
#undef TRILENS_KERNEL_LEAF_RAYS_INL_H
#else
#define TRILENS_KERNEL_LEAF_RAYS_INL_H
#endif

#include "projector/kernel/beams-inl.h"
#include "projector/kernel/hit_points-inl.h"
#include "projector/kernel/leaf_triangles-inl.h"

HWY_BEFORE_NAMESPACE();
namespace trilens {
namespace HWY_NAMESPACE {

/// As floats.
struct NarrowRays {
    Floats origin[3], direction[3];
};

/// Sets what the slab test takes of a vector's rays.
HWY_INLINE NarrowRays invert_directions(VectorRays& rays) {
    const Floats least = set(1e-30f), one = set(1.0f);
    NarrowRays narrowed;
    for (int a = 0; a < 3; ++a) {
        const Floats d = narrow(load_doubles(rays.direction[a])), o = narrow(load_doubles(rays.origin[a]));
        const Floats inverse = one / choose(absolute(d) < least, least, d);
        store(inverse, rays.inverse[a]);
        store(o * inverse, rays.start[a]);
        narrowed.direction[a] = d;
        narrowed.origin[a] = o;
    }
    return narrowed;
}

/// Local coordinates from the lines of samples that the floats are nearest to, among so many: the floats' own
/// rounding, a share of the tile, can be more than a small leaf forgives.
HWY_INLINE Double exact_local(const float* local, int lines) {
    const float middle = static_cast<float>(lines - 1) / 2, half = std::max(0.5f, middle);
    return hn::Mul(hn::Sub(lines_at(local, half, middle), hn::Set(kDouble, static_cast<double>(middle))),
                   hn::Set(kDouble, 1 / static_cast<double>(half)));
}

HWY_NOINLINE void make_vector_rays(const KernelScene& scene, KernelState& state, std::uint32_t vector) {
    const std::size_t j = state.work.tile_of_vector[vector];
    const SampleVector& samples = scene.tiles->vectors[state.group.first_vector + vector];
    const TileLanes& lanes = state.lanes;
    VectorRays& rays = state.work.rays[vector];
    const SampleTile& tile = scene.tiles->tiles[state.group.first_tile + j];
    for (std::size_t at = 0; at < kLanes; at += kDoubles) {
        const Double u = exact_local(samples.u + at, tile.width),
                     v = exact_local(samples.v + at, tile.height);
        const auto linear = [&](const double(&c)[3][kLanes]) HWY_ATTR {
            return hn::MulAdd(u, hn::Set(kDouble, c[1][j]),
                              hn::MulAdd(v, hn::Set(kDouble, c[2][j]), hn::Set(kDouble, c[0][j])));
        };
        const Double inverse = hn::Div(hn::Set(kDouble, 1.0), linear(lanes.weight));
        for (int a = 0; a < 3; ++a) {
            hn::Store(hn::Mul(linear(lanes.origin[a]), inverse), kDouble, rays.origin[a] + at);
            hn::Store(hn::Mul(linear(lanes.direction[a]), inverse), kDouble, rays.direction[a] + at);
        }
    }
    invert_directions(rays);
    state.work.rays_made[vector] = 1;
}

/// A vector's rays as floats around a leaf's centre, with their errors.
struct alignas(64) RaysInLeaf {
    float origin[3][kLanes], direction[3][kLanes], moment[3][kLanes];
    float edge_error[kLanes], above_error[kLanes], along_error[kLanes];
};

/// The double part of the errors of a tile's rays in a leaf. Weights lie above kLeastWeight.
struct RayErrorBounds {
    double edge, above;
    double d[3];                // from the facet's centre to the leaf's
    float middle[3], swing[3];  // the leaf's box from the facet's centre, wider by what floats round
};

HWY_INLINE RayErrorBounds ray_error_bounds(const TileLanes& lanes, std::size_t j, const Leaf& leaf) {
    RayErrorBounds errors;
    double reach = leaf.half[0] + leaf.half[1] + leaf.half[2];
    for (int a = 0; a < 3; ++a) {
        errors.d[a] = leaf.centre[a] - lanes.centre[a][j];
        reach += std::fabs(errors.d[a]);
    }
    const double far = lanes.weight_terms[j] * reach + lanes.origin_terms[j];
    const double h = std::max(leaf.half[0], std::max(leaf.half[1], leaf.half[2]));
    errors.edge = 8 * lanes.decision_error[j] * far * far + kUnderflow;
    errors.above = 8 * 3 * 8 * kDecisionErrorBound * h * h * far + kUnderflow;
    // |origin| + |d| is at most 3.5 `far`. Their floats, the products with the inverse, its own two roundings
    // and the difference are off by 7 half units of that.
    const double slack = 4 * (8 * 0x1p-24 + 2 * kDecisionErrorBound) * far;
    for (int a = 0; a < 3; ++a) {
        errors.middle[a] = static_cast<float>(errors.d[a]);
        errors.swing[a] = static_cast<float>(1.00001 * (leaf.half[a] + slack));
    }
    return errors;
}

HWY_NOINLINE void move_rays_to_leaf(const VectorRays& rays, const RayErrorBounds& errors, const Leaf& leaf,
                                    RaysInLeaf& r) {
    DoubleLanes o[3], d[3], m[3];
    for (std::size_t i = 0; i < kLanes / kDoubles; ++i) {
        const Vector3 direction = load3(rays.direction, i * kDoubles),
                      origin = minus(load3(rays.origin, i * kDoubles),
                                     Vector3{hn::Set(kDouble, errors.d[0]), hn::Set(kDouble, errors.d[1]),
                                             hn::Set(kDouble, errors.d[2])});
        const Vector3 moment = cross(origin, direction);
        o[0].part[i] = origin.x, o[1].part[i] = origin.y, o[2].part[i] = origin.z;
        d[0].part[i] = direction.x, d[1].part[i] = direction.y, d[2].part[i] = direction.z;
        m[0].part[i] = moment.x, m[1].part[i] = moment.y, m[2].part[i] = moment.z;
    }
    const float h[3] = {leaf.half[0], leaf.half[1], leaf.half[2]};
    const float hh[3] = {h[1] * h[2], h[2] * h[0], h[0] * h[1]};
    Floats along = set(0.0f), moments = along, above = along, speed = along;
    for (int a = 0; a < 3; ++a) {
        const Floats origin = narrow(o[a]), direction = narrow(d[a]), moment = narrow(m[a]);
        store(origin, r.origin[a]);
        store(direction, r.direction[a]);
        store(moment, r.moment[a]);
        along = multiply_add(absolute(direction), set(hh[a]), along);
        moments = multiply_add(absolute(moment), set(h[a]), moments);
        above = multiply_add(set(hh[a]), absolute(origin) + set(h[a]), above);
        speed = speed + absolute(direction);
    }
    const Floats tiny = set(kUnderflow) * (set(1.0f) + speed);
    store(multiply_add(set(kEdgeErrorBound), along + moments, set(static_cast<float>(errors.edge)) + tiny),
          r.edge_error);
    store(set(2.0f) * multiply_add(set(kDepthErrorBound), along, tiny), r.along_error);
    store(set(2.0f) * multiply_add(set(kDepthErrorBound), above, set(static_cast<float>(errors.above))),
          r.above_error);
}

/// The lanes whose rays meet the leaf's box before they see something nearer.
HWY_INLINE std::uint32_t rays_at_leaf(const VectorRays& rays, const RayErrorBounds& errors,
                                      const Nearest& nearest) {
    Floats enter = set(-kNever), leave = load(nearest.high);
    for (int a = 0; a < 3; ++a) {
        const Floats inverse = load(rays.inverse[a]);
        const Floats middle = multiply_subtract(set(errors.middle[a]), inverse, load(rays.start[a]));
        const Floats swing = set(errors.swing[a]) * absolute(inverse);
        enter = largest(enter, middle - swing);
        leave = least(leave, middle + swing);
    }
    return kAllLanes & ~bits((enter > leave) | (leave < set(0.0f)));
}

/// S, t and their errors for 16 pairs of a ray and a triangle.
HWY_INLINE Meeting meet_rays(const Floats (&conic)[3], const Floats& above, const Floats& along,
                             const Floats& edge_error, const Floats& above_error, const Floats& along_error) {
    const Floats low = least(conic[0], least(conic[1], conic[2])),
                 high = largest(conic[0], largest(conic[1], conic[2]));
    const Floats minus = set(0.0f) - edge_error;
    const Floats inverse = reciprocal(along), t = above * inverse;
    return {(low < minus) & (high > edge_error), (low > edge_error) | (high < minus),
            absolute(along) > along_error, t, error_of_time(t, absolute(inverse), above_error, along_error)};
}

/// Lanes are the vector's samples.
HWY_NOINLINE void meet_sample_lanes(const RaysInLeaf& r, const LeafEdges& edges, const Leaf& leaf,
                                    std::uint32_t triangles, std::uint32_t vector, std::uint32_t samples,
                                    KernelState& state) {
    const Floats dx = load(r.direction[0]), dy = load(r.direction[1]), dz = load(r.direction[2]);
    const Floats mx = load(r.moment[0]), my = load(r.moment[1]), mz = load(r.moment[2]);
    const Floats ox = load(r.origin[0]), oy = load(r.origin[1]), oz = load(r.origin[2]);
    for (Each triangle(triangles); triangle; ++triangle) {
        const std::size_t j = *triangle;
        Floats conic[3];
        for (int k = 0; k < 3; ++k) {
            const auto& l = edges.edge[k];
            const auto& m = edges.moment[k];
            conic[k] = multiply_add(
                dx, set(m[0][j]),
                multiply_add(dy, set(m[1][j]),
                             multiply_add(dz, set(m[2][j]),
                                          multiply_add(mx, set(l[0][j]),
                                                       multiply_add(my, set(l[1][j]), mz * set(l[2][j]))))));
        }
        const Floats nx = set(edges.normal[0][j]), ny = set(edges.normal[1][j]), nz = set(edges.normal[2][j]);
        const Floats above = subtract_product(
            nx, ox, subtract_product(ny, oy, subtract_product(nz, oz, set(edges.height[j]))));
        const Floats along = multiply_add(nx, dx, multiply_add(ny, dy, nz * dz));
        offer_lanes(
            state, vector, leaf.triangle[j],
            meet_rays(conic, above, along, load(r.edge_error), load(r.above_error), load(r.along_error)),
            samples);
    }
}

/// Lanes are the leaf's triangles.
HWY_NOINLINE void meet_triangle_lanes(const RaysInLeaf& r, const LeafEdges& edges, const Leaf& leaf,
                                      std::uint32_t triangles, std::uint32_t vector, std::uint32_t samples,
                                      KernelState& state) {
    const Floats nx = load(edges.normal[0]), ny = load(edges.normal[1]), nz = load(edges.normal[2]);
    for (Each sample(samples); sample; ++sample) {
        const std::size_t s = *sample;
        const Floats dx = set(r.direction[0][s]), dy = set(r.direction[1][s]), dz = set(r.direction[2][s]);
        const Floats mx = set(r.moment[0][s]), my = set(r.moment[1][s]), mz = set(r.moment[2][s]);
        Floats conic[3];
        for (int k = 0; k < 3; ++k) {
            const auto& l = edges.edge[k];
            const auto& m = edges.moment[k];
            conic[k] = multiply_add(
                dx, load(m[0]),
                multiply_add(dy, load(m[1]),
                             multiply_add(dz, load(m[2]),
                                          multiply_add(mx, load(l[0]),
                                                       multiply_add(my, load(l[1]), mz * load(l[2]))))));
        }
        const Floats above =
            subtract_product(nx, set(r.origin[0][s]),
                             subtract_product(ny, set(r.origin[1][s]),
                                              subtract_product(nz, set(r.origin[2][s]), load(edges.height))));
        const Floats along = multiply_add(nx, dx, multiply_add(ny, dy, nz * dz));
        const Meeting m = meet_rays(conic, above, along, set(r.edge_error[s]), set(r.above_error[s]),
                                    set(r.along_error[s]));
        const std::uint32_t near = triangles & ~bits(m.missed);
        if (!near) continue;
        alignas(64) float t_low[kLanes], t_high[kLanes];
        store(m.t - m.off, t_low);
        store(m.t + m.off, t_high);
        const std::uint32_t inside = bits(m.inside), placed = bits(m.placed);
        for (Each lane(near); lane; ++lane)
            offer_one(state, vector, static_cast<std::uint32_t>(s), leaf.triangle[*lane], t_low[*lane],
                      t_high[*lane], inside >> *lane & 1, placed >> *lane & 1);
    }
}

/// The leaf's triangles along the rays of every vector whose beam reaches the leaf. `middle`: of the leaf,
/// from the tree's centre.
HWY_NOINLINE void draw_ray_lanes(const KernelScene& scene, const Leaf& leaf, const float (&middle)[3],
                                 float nearest, KernelState& state) {
    constexpr float kTrianglePerSample =
        0.8f;  // what a triangle over 16 samples costs, in samples over 16 triangles
    if (!state.work.beams_made) make_vector_beams(scene, state);
    std::size_t tile = kLanes;
    RayErrorBounds errors{};
    for (std::uint32_t g = 0; g * kLanes < state.group.vectors; ++g) {
        const std::uint32_t live = first_lanes(state.group.vectors - g * static_cast<std::uint32_t>(kLanes));
        PlaneHeights heights;
        for (Each lane(live & vectors_at_box(state.work.beams[g], middle, leaf.half, nearest, heights)); lane;
             ++lane) {
            const std::uint32_t vector = g * static_cast<std::uint32_t>(kLanes) + *lane;
            if (!state.work.rays_made[vector]) make_vector_rays(scene, state, vector);
            if (state.work.tile_of_vector[vector] != tile) {
                tile = state.work.tile_of_vector[vector];
                touch_tile(scene, tile, state);
                errors = ray_error_bounds(state.lanes, tile, leaf);
            }
            const VectorRays& rays = state.work.rays[vector];
            const std::uint32_t samples = scene.tiles->valid[state.group.first_vector + vector] &
                                          rays_at_leaf(rays, errors, state.seen.nearest[vector]);
            if (!samples) continue;
            const std::uint32_t triangles = triangles_in_vector(state.work.beams[g], heights, *lane, leaf);
            if (!triangles) continue;
            RaysInLeaf r;
            move_rays_to_leaf(rays, errors, leaf, r);
            const float by_samples = kTrianglePerSample * static_cast<float>(std::popcount(triangles));
            if (by_samples <= static_cast<float>(std::popcount(samples)))
                meet_sample_lanes(r, state.work.edges, leaf, triangles, vector, samples, state);
            else
                meet_triangle_lanes(r, state.work.edges, leaf, triangles, vector, samples, state);
        }
    }
}

}  // namespace HWY_NAMESPACE
}  // namespace trilens
HWY_AFTER_NAMESPACE();

#endif
