// Where in a tile a leaf's triangles can be: tiles that one triangle covers wholly, and pairs of vectors and
// triangles. Included once per instruction set.
#if defined(TRILENS_KERNEL_COVERAGE_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef TRILENS_KERNEL_COVERAGE_INL_H
#undef TRILENS_KERNEL_COVERAGE_INL_H
#else
#define TRILENS_KERNEL_COVERAGE_INL_H
#endif

#include <bit>
#include <cmath>

#include "projector/kernel/filter-inl.h"

HWY_BEFORE_NAMESPACE();
namespace trilens {
namespace HWY_NAMESPACE {

HWY_INLINE void clear_nearest(Nearest& nearest) {
    store(set(kNever), nearest.low);
    store(set(kNever), nearest.high);
    store_words(set_word(kNone), nearest.triangle);
}

/// At the vector's samples, which are the tile's.
HWY_INLINE void put_whole(const WholeTile& whole, const SampleTile& tile, const SampleVector& samples,
                          Nearest& nearest) {
    const Floats u = load(samples.u), v = load(samples.v);
    const auto linear = [&](const float(&c)[3]) HWY_ATTR {
        return multiply_add(u, set(c[1]), multiply_add(v, set(c[2]), set(c[0])));
    };
    const Floats inverse = reciprocal(linear(whole.along)), t = linear(whole.above) * inverse;
    const Floats off = error_of_time(t, inverse, set(whole.above_error + 2 * swing_of(whole.above, tile)),
                                     set(whole.along_error + 2 * swing_of(whole.along, tile)));
    store(t - off, nearest.low);
    store(t + off, nearest.high);
    store_words(set_word(whole.triangle), nearest.triangle);
}

HWY_NOINLINE void set_nearest(const KernelScene& scene, std::size_t j, KernelState& state) {
    state.seen.untouched &= ~(1u << j);
    const bool covered = state.seen.covered >> j & 1;
    const std::size_t k = j - state.group.first_lane;
    const SampleTile& tile = scene.tiles->tiles[state.group.first_tile + j];
    for (std::uint32_t i = state.group.tile_vectors[k]; i < state.group.tile_vectors[k + 1]; ++i) {
        if (covered)
            put_whole(state.seen.whole[j], tile, scene.tiles->vectors[state.group.first_vector + i],
                      state.seen.nearest[i]);
        else
            clear_nearest(state.seen.nearest[i]);
    }
    state.seen.covered &= ~(1u << j);
}

/// Before `nearest` of the vectors of the tile of lane j is used.
HWY_INLINE void touch_tile(const KernelScene& scene, std::size_t j, KernelState& state) {
    if (state.seen.untouched >> j & 1) set_nearest(scene, j, state);
}

/// What is known of a triangle's depth over a whole tile: least <= t <= most, if `known`.
struct WholeDepth {
    bool known = false;
    float least = 0, most = 0;
};

/// Of forms' lane, if every ray of the tile surely meets the triangle's plane in front of it.
HWY_INLINE WholeDepth whole_depth(const Forms& forms, std::size_t lane, const TileErrorBounds& errors) {
    const auto swing = [lane](const float(&c)[3][kLanes])
                           HWY_ATTR { return std::fabs(c[1][lane]) + std::fabs(c[2][lane]); };
    const float along_swing = swing(forms.along), above_swing = swing(forms.above);
    const float slowest = forms.along[0][lane] - along_swing, fastest = forms.along[0][lane] + along_swing;
    const float lowest = forms.above[0][lane] - above_swing, highest = forms.above[0][lane] + above_swing;
    if (!(slowest > kSureDepth * errors.along && lowest > kSureDepth * errors.above)) return {};
    return {true, (1 - kDepthRound) * (lowest - errors.above) / (fastest + errors.along),
            (1 + kDepthRound) * (highest + errors.above) / (slowest - errors.along)};
}

/// A triangle, whose forms are in `lane`, over the tile of lane `tile`.
struct TileTriangle {
    const Forms& forms;
    std::size_t lane;
    std::uint32_t triangle;  // index into PreparedScene::Data
    std::size_t tile;
};

/// Takes note that the triangle covers the tile, which is untouched.
HWY_INLINE void cover_tile(const TileTriangle& t, const TileErrorBounds& errors, const WholeDepth& depth,
                           KernelState& state) {
    WholeTile& whole = state.seen.whole[t.tile];
    whole.triangle = t.triangle;
    for (int p = 0; p < 3; ++p) {
        whole.above[p] = t.forms.above[p][t.lane];
        whole.along[p] = t.forms.along[p][t.lane];
    }
    whole.above_error = errors.above;
    whole.along_error = errors.along;
    whole.farthest = depth.most;
    state.seen.covered |= 1u << t.tile;
}

/// Whether the triangle needs no look at the tile's vectors, because it covers an empty tile or lies behind
/// the triangle that covers it. `whole`: all samples of the tile are surely inside it.
HWY_INLINE bool is_settled(const TileTriangle& t, const TileErrorBounds& errors, bool whole,
                           KernelState& state) {
    if (!(state.seen.untouched >> t.tile & 1)) return false;
    const bool covered = state.seen.covered >> t.tile & 1;
    if (!covered && !whole) return false;
    const WholeDepth depth = whole_depth(t.forms, t.lane, errors);
    if (!depth.known) return false;
    if (covered) return depth.least > state.seen.whole[t.tile].farthest;
    cover_tile(t, errors, depth, state);
    return true;
}

// Where in a tile a leaf's triangles can be: a rectangle for each, and pairs of vectors and triangles that
// may meet.

/// The rectangle of local coordinates outside which no lane's triangle is seen.
struct Extent {
    Floats u_low, u_high, v_low, v_high;
};

/// From the corners where two of the edges' bounds meet. Where their determinant is less than 2^-7 of its
/// terms or so small that products are below the normal range, or a bound is far outside the square, nothing
/// is known. Else a corner inside 1.5 times the square is right to 2^-11: the determinant to 2^-14 of itself,
/// the numerators to 2^-12 of it.
HWY_NOINLINE Extent extent_of(const EdgeBounds& e) {
    Floats u[3], v[3];
    Mask turned_right = mask_of(kAllLanes), turned_left = turned_right;
    for (int k = 0; k < 3; ++k) {
        const int i = (k + 1) % 3, j = (k + 2) % 3;
        const Floats determinant = multiply_subtract(e.slope_u[i], e.slope_v[j], e.slope_v[i] * e.slope_u[j]);
        const Floats size_i = absolute(e.slope_u[i]) + absolute(e.slope_v[i]),
                     size_j = absolute(e.slope_u[j]) + absolute(e.slope_v[j]);
        const Floats trust = largest(set(0x1p-7f) * (size_i * size_j), set(kUnderflow));
        const Floats inverse = reciprocal(determinant);
        turned_right =
            turned_right & (determinant > trust) &
            (absolute(e.bound[k]) <= set(4.0f) * (absolute(e.slope_u[k]) + absolute(e.slope_v[k])));
        turned_left = turned_left & (set(0.0f) - determinant > trust) &
                      (absolute(e.bound[k]) <= set(4.0f) * (absolute(e.slope_u[k]) + absolute(e.slope_v[k])));
        u[k] = multiply_subtract(e.slope_v[i], e.bound[j], e.slope_v[j] * e.bound[i]) * inverse;
        v[k] = multiply_subtract(e.slope_u[j], e.bound[i], e.slope_u[i] * e.bound[j]) * inverse;
    }
    const Mask known = turned_right | turned_left;
    const Floats one = set(1.0f), minus_one = set(-1.0f), pad = set(0x1p-10f);
    const auto bounded_below = [&](const Floats* c) HWY_ATTR {
        return choose(known, largest(minus_one, least(c[0], least(c[1], c[2])) - pad), minus_one);
    };
    const auto bounded_above = [&](const Floats* c) HWY_ATTR {
        return choose(known, least(one, largest(c[0], largest(c[1], c[2])) + pad), one);
    };
    return {bounded_below(u), bounded_above(u), bounded_below(v), bounded_above(v)};
}

/// A tile's vectors' boxes, 16 in each element.
struct TileBoxes {
    const VectorBoxes* boxes;
    const VectorLimits* limits;
    std::uint32_t vectors;
};

/// Rectangles of local coordinates: middles and half sizes.
struct BoxLanes {
    Floats u, v, half_u, half_v, farthest;
};

/// Where the triangle is surely not in the box. Lanes are triangles with one box, or boxes with one triangle.
HWY_INLINE Mask outside_box(const EdgeBounds& bounds, const Extent& extent, const BoxLanes& box) {
    Mask outside = (box.u + box.half_u < extent.u_low) | (box.u - box.half_u > extent.u_high) |
                   (box.v + box.half_v < extent.v_low) | (box.v - box.half_v > extent.v_high) |
                   (bounds.nearest > box.farthest);
    for (int k = 0; k < 3; ++k) {
        const Floats u = bounds.slope_u[k], v = bounds.slope_v[k];
        const Floats highest =
            multiply_add(absolute(u), box.half_u,
                         multiply_add(absolute(v), box.half_v,
                                      multiply_add(u, box.u, multiply_add(v, box.v, bounds.bound[k]))));
        outside = outside | (highest < set(0.0f));
    }
    return outside;
}

/// The bounds and the extents of 16 triangles, for one of them at a time.
struct alignas(64) StoredBounds {
    float slope_u[3][kLanes], slope_v[3][kLanes], bound[3][kLanes];
    float u_low[kLanes], u_high[kLanes], v_low[kLanes], v_high[kLanes], nearest[kLanes];
};

HWY_INLINE void store_bounds(const EdgeBounds& bounds, const Extent& extent, StoredBounds& stored) {
    for (int k = 0; k < 3; ++k) {
        store(bounds.slope_u[k], stored.slope_u[k]);
        store(bounds.slope_v[k], stored.slope_v[k]);
        store(bounds.bound[k], stored.bound[k]);
    }
    store(bounds.nearest, stored.nearest);
    store(extent.u_low, stored.u_low);
    store(extent.u_high, stored.u_high);
    store(extent.v_low, stored.v_low);
    store(extent.v_high, stored.v_high);
}

/// One triangle against 16 boxes.
HWY_INLINE Mask one_outside_boxes(const StoredBounds& stored, std::size_t lane, const BoxLanes& boxes) {
    EdgeBounds bounds;
    bounds.nearest = set(stored.nearest[lane]);
    for (int k = 0; k < 3; ++k) {
        bounds.slope_u[k] = set(stored.slope_u[k][lane]);
        bounds.slope_v[k] = set(stored.slope_v[k][lane]);
        bounds.bound[k] = set(stored.bound[k][lane]);
    }
    return outside_box(bounds,
                       {set(stored.u_low[lane]), set(stored.u_high[lane]), set(stored.v_low[lane]),
                        set(stored.v_high[lane])},
                       boxes);
}

/// Writes the pairs of vectors and triangles that may meet: 16 vector + lane of the triangle. There is room
/// for all, and a vector's more. Returns how many.
HWY_NOINLINE std::size_t list_pairs(const TileBoxes& tile, const EdgeBounds& all_bounds,
                                    const Extent& all_extents, std::uint32_t lanes, std::uint32_t* pairs) {
    const EdgeBounds bounds = all_bounds;
    const Extent extent = all_extents;
    StoredBounds stored;
    store_bounds(bounds, extent, stored);
    const Mask of = mask_of(lanes);
    const Floats none_low = set(9.0f), none_high = set(-9.0f);
    const Floats u_low = set(least_lane(choose(of, extent.u_low, none_low))),
                 u_high = set(largest_lane(choose(of, extent.u_high, none_high))),
                 v_low = set(least_lane(choose(of, extent.v_low, none_low))),
                 v_high = set(largest_lane(choose(of, extent.v_high, none_high)));
    const int triangles = std::popcount(lanes);
    std::size_t count = 0;
    for (std::uint32_t first = 0; first < tile.vectors; first += kLanes) {
        const VectorBoxes& box = tile.boxes[first / kLanes];
        const float* const limits = tile.limits[first / kLanes].farthest;
        const BoxLanes boxes{load(box.centre_u), load(box.centre_v), load(box.half_u), load(box.half_v),
                             load(limits)};
        const Mask near = (boxes.u + boxes.half_u >= u_low) & (boxes.u - boxes.half_u <= u_high) &
                          (boxes.v + boxes.half_v >= v_low) & (boxes.v - boxes.half_v <= v_high);
        const std::uint32_t vectors = bits(near);
        constexpr std::uint32_t kLaneStep = kLanes;
        if (triangles < std::popcount(vectors)) {
            for (Each lane(lanes); lane; ++lane)
                count += list_lanes<kLaneStep>(without(near, one_outside_boxes(stored, *lane, boxes)),
                                               first * kLaneStep + *lane, pairs + count);
            continue;
        }
        for (Each vector(vectors); vector; ++vector) {
            const std::size_t z = *vector;
            const BoxLanes one{set(box.centre_u[z]), set(box.centre_v[z]), set(box.half_u[z]),
                               set(box.half_v[z]), set(limits[z])};
            count += list_lanes(without(of, outside_box(bounds, extent, one)), (first + *vector) * kLaneStep,
                                pairs + count);
        }
    }
    return count;
}

}  // namespace HWY_NAMESPACE
}  // namespace trilens
HWY_AFTER_NAMESPACE();

#endif
