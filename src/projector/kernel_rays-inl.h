// A leaf mode: samples' own rays, for triangles of few samples. Vectors whose beams miss the leaf are
// skipped; then lanes are a vector's samples, one triangle after the other, or triangles, one sample after
// the other. Included once per instruction set.
#if defined(TRILENS_KERNEL_RAYS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef TRILENS_KERNEL_RAYS_INL_H
#undef TRILENS_KERNEL_RAYS_INL_H
#else
#define TRILENS_KERNEL_RAYS_INL_H
#endif

#include "projector/kernel_setup-inl.h"
#include "projector/kernel_triangles-inl.h"

HWY_BEFORE_NAMESPACE();
namespace trilens {
namespace HWY_NAMESPACE {

/// Beams around all of the group's vectors, 16 at a time.
HWY_NOINLINE void make_vector_beams(const KernelScene& scene, KernelState& state) {
    state.beams_made = true;
    state.rays_made.assign(state.vectors, 0);
    state.tile_of_vector.resize(state.vectors);
    if (state.rays.size() < state.vectors) state.rays.resize(state.vectors);
    state.beams.resize((state.vectors + kLanes - 1) / kLanes);
    for (std::uint32_t j = state.first_lane; j < state.first_lane + state.tiles; ++j) {
        const SampleTile& tile = scene.tiles->tiles[state.first_tile + j];
        std::fill_n(state.tile_of_vector.begin() + (tile.first_vector - state.first_vector), tile.vectors,
                    static_cast<std::uint8_t>(j));
    }
    HullLanes hull;
    for (std::uint32_t g = 0; g * kLanes < state.vectors; ++g) {
        for (std::uint32_t k = 0; k < kLanes; ++k) {
            const std::uint32_t vector =
                std::min(g * static_cast<std::uint32_t>(kLanes) + k, state.vectors - 1);
            const std::size_t j = state.tile_of_vector[vector];
            const SampleTile& tile = scene.tiles->tiles[state.first_tile + j];
            const std::uint32_t own = vector + state.first_vector - tile.first_vector;
            const VectorBoxes& box = scene.tiles->boxes[tile.first_boxes + own / kLanes];
            const std::size_t b = own % kLanes;
            // No thinner than a third of a sample, so that the hull has sides.
            const double half_u = std::max<double>(box.half_u[b], 0.6 / std::max(1, tile.width - 1)),
                         half_v = std::max<double>(box.half_v[b], 0.6 / std::max(1, tile.height - 1));
            const double weight =
                put_rectangle(state.lanes, j, {box.centre_u[b], box.centre_v[b], half_u, half_v}, hull, k);
            for (int a = 0; a < 3; ++a) hull.centre[a][k] = state.lanes.centre[a][j];
            hull.origin_terms[k] =
                weight > 0.1 ? state.lanes.origin_terms[j] : std::numeric_limits<double>::infinity();
        }
        make_planes(scene, hull);
        VectorBeams& beams = state.beams[g];
        std::memcpy(beams.plane, hull.plane, sizeof beams.plane);
        std::memcpy(beams.offset, hull.offset, sizeof beams.offset);
        for (std::uint32_t k = 0; k < kLanes; ++k)
            beams.farthest[k] = g * kLanes + k < state.vectors ? kNever : -kNever;
    }
}

/// Which of 16 vectors' beams reach a box, before their samples all see something nearer.
HWY_INLINE std::uint32_t vectors_at_box(const VectorBeams& beams, const float* middle, const float* half,
                                        float nearest) {
    const Floats cx = set(middle[0]), cy = set(middle[1]), cz = set(middle[2]);
    const Floats hx = set(half[0]), hy = set(half[1]), hz = set(half[2]);
    Mask missed = set(nearest) > load(beams.farthest);
    for (int k = 0; k < 4; ++k) {
        const Floats x = load(beams.plane[k][0]), y = load(beams.plane[k][1]), z = load(beams.plane[k][2]);
        const Floats swing = multiply_add(absolute(x), hx, multiply_add(absolute(y), hy, absolute(z) * hz));
        const Floats height = multiply_add(x, cx, multiply_add(y, cy, multiply_add(z, cz, swing)));
        missed = missed | (height < load(beams.offset[k]));
    }
    return kAllLanes & ~bits(missed);
}

/// The leaf's triangles that reach into one vector's beam.
HWY_INLINE std::uint32_t triangles_in_vector(const VectorBeams& beams, std::size_t lane, const Leaf& leaf,
                                             const float* middle) {
    std::uint32_t missed = 0;
    for (int p = 0; p < 4; ++p) {
        const float nx = beams.plane[p][0][lane], ny = beams.plane[p][1][lane], nz = beams.plane[p][2][lane];
        const Floats x = set(nx), y = set(ny), z = set(nz);
        const Floats at = set(nx * middle[0] + ny * middle[1] + nz * middle[2]);
        Floats height = set(-kNever);
        for (int k = 0; k < 3; ++k)
            height = largest(height, multiply_add(x, load(leaf.x[k]),
                                                  multiply_add(y, load(leaf.y[k]), z * load(leaf.z[k]))));
        missed |= bits(height + at < set(beams.offset[p][lane]));
    }
    return first_lanes(leaf.count) & ~missed;
}

HWY_NOINLINE void make_vector_rays(const KernelScene& scene, KernelState& state, std::uint32_t vector) {
    const std::size_t j = state.tile_of_vector[vector];
    const SampleVector& samples = scene.tiles->vectors[state.first_vector + vector];
    const TileLanes& lanes = state.lanes;
    VectorRays& rays = state.rays[vector];
    alignas(64) double u[kLanes], v[kLanes], inverse[kLanes];
    for (std::size_t k = 0; k < kLanes; ++k) {
        u[k] = samples.u[k];
        v[k] = samples.v[k];
    }
    for (std::size_t k = 0; k < kLanes; ++k)
        inverse[k] = 1 / (lanes.weight[0][j] + u[k] * lanes.weight[1][j] + v[k] * lanes.weight[2][j]);
    for (int a = 0; a < 3; ++a) {
        const double o0 = lanes.origin[a][0][j], o1 = lanes.origin[a][1][j], o2 = lanes.origin[a][2][j];
        const double d0 = lanes.direction[a][0][j], d1 = lanes.direction[a][1][j],
                     d2 = lanes.direction[a][2][j];
        for (std::size_t k = 0; k < kLanes; ++k) {
            rays.origin[a][k] = (o0 + u[k] * o1 + v[k] * o2) * inverse[k];
            rays.direction[a][k] = (d0 + u[k] * d1 + v[k] * d2) * inverse[k];
        }
        for (std::size_t k = 0; k < kLanes; ++k) {
            const float d = static_cast<float>(rays.direction[a][k]);
            rays.inverse[a][k] = 1 / (std::fabs(d) < 1e-30f ? 1e-30f : d);
        }
    }
    state.rays_made[vector] = 1;
}

/// A vector's rays as floats around a leaf's centre, with their doubts.
struct alignas(64) RaysInLeaf {
    float origin[3][kLanes], direction[3][kLanes], moment[3][kLanes];
    float edge_doubt[kLanes], above_doubt[kLanes], along_doubt[kLanes];
};

/// The double part of the doubts of a tile's rays in a leaf. Weights lie above kLeastWeight.
struct RayDoubts {
    double edge, above, slack;  // slack: by how much a box must be larger than the leaf
    double d[3];                // from the facet's centre to the leaf's
};

HWY_INLINE RayDoubts ray_doubts(const TileLanes& lanes, std::size_t j, const Leaf& leaf) {
    RayDoubts doubts;
    double reach = leaf.half[0] + leaf.half[1] + leaf.half[2];
    for (int a = 0; a < 3; ++a) {
        doubts.d[a] = leaf.centre[a] - lanes.centre[a][j];
        reach += std::fabs(doubts.d[a]);
    }
    const double far = lanes.weight_terms[j] * reach + lanes.origin_terms[j];
    const double h = std::max(leaf.half[0], std::max(leaf.half[1], leaf.half[2]));
    doubts.edge = 8 * lanes.decision_doubt[j] * far * far + kUnderflow;
    doubts.above = 8 * 3 * 8 * kDecisionDoubt * h * h * far + kUnderflow;
    doubts.slack = 8 * kDecisionDoubt * far;
    return doubts;
}

HWY_NOINLINE void finish_rays_in_leaf(const VectorRays& rays, const RayDoubts& doubts, const Leaf& leaf,
                                      RaysInLeaf& r) {
    const float h[3] = {leaf.half[0], leaf.half[1], leaf.half[2]};
    const float hh[3] = {h[1] * h[2], h[2] * h[0], h[0] * h[1]};
    for (std::size_t k = 0; k < kLanes; ++k) {
        const double x = rays.origin[0][k] - doubts.d[0], y = rays.origin[1][k] - doubts.d[1],
                     z = rays.origin[2][k] - doubts.d[2];
        const double dx = rays.direction[0][k], dy = rays.direction[1][k], dz = rays.direction[2][k];
        const float fx = static_cast<float>(dx), fy = static_cast<float>(dy), fz = static_cast<float>(dz);
        const float mx = static_cast<float>(y * dz - z * dy), my = static_cast<float>(z * dx - x * dz),
                    mz = static_cast<float>(x * dy - y * dx);
        r.direction[0][k] = fx, r.direction[1][k] = fy, r.direction[2][k] = fz;
        r.moment[0][k] = mx, r.moment[1][k] = my, r.moment[2][k] = mz;
        const float along = std::fabs(fx) * hh[0] + std::fabs(fy) * hh[1] + std::fabs(fz) * hh[2];
        const float moment = std::fabs(mx) * h[0] + std::fabs(my) * h[1] + std::fabs(mz) * h[2];
        const float above = hh[0] * (std::fabs(r.origin[0][k]) + h[0]) +
                            hh[1] * (std::fabs(r.origin[1][k]) + h[1]) +
                            hh[2] * (std::fabs(r.origin[2][k]) + h[2]);
        const float speed = std::fabs(fx) + std::fabs(fy) + std::fabs(fz);
        r.edge_doubt[k] =
            kEdgeDoubt * (along + moment) + static_cast<float>(doubts.edge) + kUnderflow * (1 + speed);
        r.along_doubt[k] = 2 * (kDepthDoubt * along + kUnderflow * (1 + speed));
        r.above_doubt[k] = 2 * (kDepthDoubt * above + static_cast<float>(doubts.above));
    }
}

/// The lanes whose rays meet the leaf's box before they see something nearer. Also sets r.origin.
HWY_INLINE std::uint32_t rays_at_leaf(const VectorRays& rays, const RayDoubts& doubts, const Leaf& leaf,
                                      const Nearest& nearest, RaysInLeaf& r) {
    // Products and differences round by 8 half units of the terms; the leaf's box is widened by as much.
    const Floats slack = set(16 * 0x1p-24f);
    Floats enter = set(-kNever), leave = load(nearest.high);
    for (int a = 0; a < 3; ++a) {
        for (std::size_t k = 0; k < kLanes; ++k)
            r.origin[a][k] = static_cast<float>(rays.origin[a][k] - doubts.d[a]);
        const Floats inverse = load(rays.inverse[a]);
        const Floats middle = set(0.0f) - load(r.origin[a]) * inverse;
        const Floats swing = set(leaf.half[a] + static_cast<float>(doubts.slack)) * absolute(inverse);
        const Floats wide = multiply_add(slack, absolute(middle) + swing, swing);
        enter = largest(enter, middle - wide);
        leave = least(leave, middle + wide);
    }
    return kAllLanes & ~bits((enter > leave) | (leave < set(0.0f)));
}

/// S, t and their doubts for 16 pairs of a ray and a triangle.
HWY_INLINE Meeting meet_rays(const Floats (&conic)[3], const Floats& above, const Floats& along,
                             const Floats& edge_doubt, const Floats& above_doubt, const Floats& along_doubt) {
    const Floats low = least(conic[0], least(conic[1], conic[2])),
                 high = largest(conic[0], largest(conic[1], conic[2]));
    const Floats minus = set(0.0f) - edge_doubt;
    const Floats inverse = reciprocal(along), t = above * inverse;
    return {(low < minus) & (high > edge_doubt), (low > edge_doubt) | (high < minus),
            absolute(along) > along_doubt, t, doubt_of_time(t, absolute(inverse), above_doubt, along_doubt)};
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
            meet_rays(conic, above, along, load(r.edge_doubt), load(r.above_doubt), load(r.along_doubt)),
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
        const Meeting m = meet_rays(conic, above, along, set(r.edge_doubt[s]), set(r.above_doubt[s]),
                                    set(r.along_doubt[s]));
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
    if (!state.beams_made) make_vector_beams(scene, state);
    std::size_t tile = kLanes;
    RayDoubts doubts{};
    for (std::uint32_t g = 0; g * kLanes < state.vectors; ++g) {
        const std::uint32_t live = first_lanes(state.vectors - g * static_cast<std::uint32_t>(kLanes));
        for (Each lane(live & vectors_at_box(state.beams[g], middle, leaf.half, nearest)); lane; ++lane) {
            const std::uint32_t vector = g * static_cast<std::uint32_t>(kLanes) + *lane;
            if (!state.rays_made[vector]) make_vector_rays(scene, state, vector);
            if (state.tile_of_vector[vector] != tile) {
                tile = state.tile_of_vector[vector];
                doubts = ray_doubts(state.lanes, tile, leaf);
            }
            const VectorRays& rays = state.rays[vector];
            RaysInLeaf r;
            const std::uint32_t samples = scene.tiles->samples[state.first_vector + vector].valid &
                                          rays_at_leaf(rays, doubts, leaf, state.nearest[vector], r);
            if (!samples) continue;
            const std::uint32_t triangles = triangles_in_vector(state.beams[g], *lane, leaf, middle);
            if (!triangles) continue;
            finish_rays_in_leaf(rays, doubts, leaf, r);
            const float by_samples = kTrianglePerSample * static_cast<float>(std::popcount(triangles));
            if (by_samples <= static_cast<float>(std::popcount(samples)))
                meet_sample_lanes(r, state.edges, leaf, triangles, vector, samples, state);
            else
                meet_triangle_lanes(r, state.edges, leaf, triangles, vector, samples, state);
        }
    }
}

}  // namespace HWY_NAMESPACE
}  // namespace trilens
HWY_AFTER_NAMESPACE();

#endif
