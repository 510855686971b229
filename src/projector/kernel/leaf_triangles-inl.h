// A leaf mode: lanes are the leaf's triangles, for one tile. Triangles with few samples walk over them lane
// by lane; the others meet vectors of samples one by one.
// Included once per instruction set.
#if defined(TRILENS_KERNEL_LEAF_TRIANGLES_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef TRILENS_KERNEL_LEAF_TRIANGLES_INL_H
#undef TRILENS_KERNEL_LEAF_TRIANGLES_INL_H
#else
#define TRILENS_KERNEL_LEAF_TRIANGLES_INL_H
#endif

#include "projector/kernel/coverage-inl.h"

HWY_BEFORE_NAMESPACE();
namespace trilens {
namespace HWY_NAMESPACE {

/// One tile, one leaf, and the state they are drawn into.
struct TileDrawing {
    const KernelScene& scene;
    KernelState& state;
    const SampleTile& tile;
    const TileErrorBounds& errors;
    const Leaf& leaf;
    std::uint32_t first_vector;  // of the tile, in the group
    const VectorLimits* limits;  // of its vectors; none where no pairs are listed
};

/// What meets vectors of a tile needs, in registers.
struct TileVectors {
    const SampleVector* vectors;
    const std::uint16_t* valid;
    Nearest* nearest;
    TileErrorBounds errors;
};

HWY_INLINE TileVectors vectors_of(const TileDrawing& drawing) {
    return {&drawing.scene.tiles->vectors[drawing.tile.first_vector],
            &drawing.scene.tiles->valid[drawing.tile.first_vector],
            &drawing.state.seen.nearest[drawing.first_vector], drawing.errors};
}

/// A triangle, whose forms are in `lane`, against one vector of the tile.
HWY_INLINE void meet_vector(const TileDrawing& drawing, const TileVectors& tile, const Forms& forms,
                            std::size_t lane, Id triangle, std::uint32_t vector) {
    const SampleVector& samples = tile.vectors[vector];
    const Floats u = load(samples.u), v = load(samples.v);
    const auto conic = [&](const float(&c)[6][kLanes]) HWY_ATTR {
        return multiply_add(
            u, multiply_add(u, set(c[3][lane]), multiply_add(v, set(c[4][lane]), set(c[1][lane]))),
            multiply_add(v, multiply_add(v, set(c[5][lane]), set(c[2][lane])), set(c[0][lane])));
    };
    const auto linear = [&](const float(&c)[3][kLanes]) HWY_ATTR {
        return multiply_add(u, set(c[1][lane]), multiply_add(v, set(c[2][lane]), set(c[0][lane])));
    };
    const TileErrorBounds& errors = tile.errors;
    const Floats low = least(conic(forms.edge[0]), least(conic(forms.edge[1]), conic(forms.edge[2])));
    const Floats along = linear(forms.along), inverse = reciprocal(along), t = linear(forms.above) * inverse;
    const Meeting meeting{low<set(-errors.edge), low> set(errors.edge), along > set(errors.along), t,
                          error_of_time(t, inverse, set(errors.above), set(errors.along))};
    const std::uint32_t ambiguous =
        tile.valid[vector] & keep_nearest(tile.nearest[vector], triangle, meeting);
    if (HWY_UNLIKELY(ambiguous != 0))
        list_ambiguous(drawing.state, drawing.first_vector + vector, ambiguous, triangle);
}

/// The same where lanes are pixels: what is sure is so for all samples of a pixel.
HWY_INLINE void meet_pixels(const TileDrawing& drawing, const Forms& forms, std::size_t lane, Id triangle,
                            std::uint32_t vector) {
    const SampleTile& tile = drawing.tile;
    const SampleVector& samples = drawing.scene.tiles->vectors[tile.first_vector + vector];
    const Floats u = load(samples.u), v = load(samples.v);
    Floats inside = set(kNever), outside = inside;
    for (const auto& c : forms.edge) {
        const Floats conic = multiply_add(
            u, multiply_add(u, set(c[3][lane]), multiply_add(v, set(c[4][lane]), set(c[1][lane]))),
            multiply_add(v, multiply_add(v, set(c[5][lane]), set(c[2][lane])), set(c[0][lane])));
        const Floats swing = set(conic_swing(c, lane, tile));
        inside = least(inside, conic - swing);
        outside = least(outside, conic + swing);
    }
    const auto linear = [&](const float(&c)[3][kLanes]) HWY_ATTR {
        return multiply_add(u, set(c[1][lane]), multiply_add(v, set(c[2][lane]), set(c[0][lane])));
    };
    // As errors of depth are: twice what it is off by.
    const float above_error = drawing.errors.above + 2 * linear_swing(forms.above, lane, tile),
                along_error = drawing.errors.along + 2 * linear_swing(forms.along, lane, tile);
    const Floats along = linear(forms.along), inverse = reciprocal(along), t = linear(forms.above) * inverse;
    const Meeting meeting{outside<set(-drawing.errors.edge), inside> set(drawing.errors.edge),
                          along > set(along_error), t,
                          error_of_time(t, inverse, set(above_error), set(along_error))};
    const std::uint32_t in_group = drawing.first_vector + vector;
    const std::uint32_t doubtful = keep_nearest(drawing.state.seen.nearest[in_group], triangle, meeting);
    if (doubtful == 0) return;
    keep_doubts(drawing.state.seen.doubts[in_group], meeting, doubtful);
    if (drawing.scene.open)
        list_ambiguous(drawing.state, in_group,
                       doubtful & drawing.scene.tiles->valid[tile.first_vector + vector], triangle);
}

/// Of the tile of lane j. None: the group has no tiles.
HWY_INLINE VectorLimits* limits_of(const KernelScene& scene, std::size_t j, KernelState& state) {
    if (state.seen.limits.empty()) return nullptr;
    const SampleTile* tiles = &scene.tiles->tiles[state.group.first_tile];
    return &state.seen.limits[tiles[j].first_boxes - tiles[state.group.first_lane].first_boxes];
}

/// Cells of the tile's lattice.
struct Cells {
    Floats x_low, x_high, y_low, y_high;
};

HWY_INLINE Cells cells_in(const Extent& extent, const SampleTile& tile) {
    const float middle_x = static_cast<float>(tile.width - 1) / 2, half_x = std::max(0.5f, middle_x);
    const float middle_y = static_cast<float>(tile.height - 1) / 2, half_y = std::max(0.5f, middle_y);
    const Floats zero = set(0.0f), slack = set(1e-3f);
    return {
        largest(zero, round_up(multiply_add(extent.u_low, set(half_x), set(middle_x)) - slack)),
        least(set(2 * middle_x), round_down(multiply_add(extent.u_high, set(half_x), set(middle_x)) + slack)),
        largest(zero, round_up(multiply_add(extent.v_low, set(half_y), set(middle_y)) - slack)),
        least(set(2 * middle_y),
              round_down(multiply_add(extent.v_high, set(half_y), set(middle_y)) + slack))};
}

/// Each lane walks over its own cells.
HWY_NOINLINE void walk_cells(const TileDrawing& drawing, const Forms& forms, const Cells& cells,
                             std::uint32_t lanes) {
    const SampleTile& tile = drawing.tile;
    const float middle_x = static_cast<float>(tile.width - 1) / 2,
                middle_y = static_cast<float>(tile.height - 1) / 2;
    const Floats scale_u = set(1 / std::max(0.5f, middle_x)), scale_v = set(1 / std::max(0.5f, middle_y));
    const std::uint16_t* slots = &drawing.scene.tiles->slot[tile.first_slot];
    const TileErrorBounds& errors = drawing.errors;
    Floats x = cells.x_low, y = cells.y_low;
    while (lanes) {
        const Floats u = (x - set(middle_x)) * scale_u, v = (y - set(middle_y)) * scale_v;
        const auto conic = [&](const float(&c)[6][kLanes]) HWY_ATTR {
            return multiply_add(u, multiply_add(u, load(c[3]), multiply_add(v, load(c[4]), load(c[1]))),
                                multiply_add(v, multiply_add(v, load(c[5]), load(c[2])), load(c[0])));
        };
        const Floats low = least(conic(forms.edge[0]), least(conic(forms.edge[1]), conic(forms.edge[2])));
        const std::uint32_t near = lanes & ~bits(low < set(-errors.edge));
        if (near) {
            const auto linear = [&](const float(&c)[3][kLanes]) HWY_ATTR {
                return multiply_add(u, load(c[1]), multiply_add(v, load(c[2]), load(c[0])));
            };
            const Floats along = linear(forms.along), inverse = reciprocal(along);
            const Floats t = linear(forms.above) * inverse;
            const Floats off = error_of_time(t, inverse, set(errors.above), set(errors.along));
            const std::uint32_t inside = bits(low > set(errors.edge)),
                                placed = bits(along > set(errors.along));
            alignas(64) float t_low[kLanes], t_high[kLanes], at_x[kLanes], at_y[kLanes];
            store(t - off, t_low);
            store(t + off, t_high);
            store(x, at_x);
            store(y, at_y);
            for (Each lane(near); lane; ++lane) {
                const std::size_t j = *lane;
                const std::uint16_t slot =
                    slots[static_cast<int>(at_y[j]) * tile.width + static_cast<int>(at_x[j])];
                if (slot == kNoSlot) continue;
                offer_one(drawing.state, drawing.first_vector + slot / kLanes, slot % kLanes,
                          drawing.leaf.triangle[j], t_low[j], t_high[j], inside >> j & 1, placed >> j & 1);
            }
        }
        x = x + set(1.0f);
        const Mask row_done = x > cells.x_high;
        x = choose(row_done, cells.x_low, x);
        y = choose(row_done, y + set(1.0f), y);
        lanes &= bits(y <= cells.y_high);
    }
}

/// Draws the lanes that are turned one way.
HWY_NOINLINE void draw_turned(const TileDrawing& drawing, const Forms& forms, const EdgeBounds& bounds,
                              std::uint32_t lanes) {
    constexpr float kFewCells = 4;  // measured: above, vectors are faster
    const Extent extent = extent_of(bounds);
    const Cells cells = cells_in(extent, drawing.tile);
    lanes &= ~bits((cells.x_low > cells.x_high) | (cells.y_low > cells.y_high));
    if (!lanes) return;
    const Floats one = set(1.0f);
    const Floats area = (cells.x_high - cells.x_low + one) * (cells.y_high - cells.y_low + one);
    const bool pixels = drawing.scene.pixels;
    const std::uint32_t small = pixels ? 0 : lanes & bits(area <= set(kFewCells));
    if (small) walk_cells(drawing, forms, cells, small);
    if (!(lanes & ~small)) return;
    std::vector<std::uint32_t>& list = drawing.state.work.pairs;
    if (list.size() < (drawing.tile.vectors + 1) * kLanes) list.resize((drawing.tile.vectors + 1) * kLanes);
    const VectorBoxes* boxes = &drawing.scene.tiles->boxes[drawing.tile.first_boxes];
    const std::size_t pairs = list_pairs({boxes, drawing.limits, drawing.tile.vectors}, bounds, extent,
                                         lanes & ~small, list.data());
    const TileVectors tile = vectors_of(drawing);
    const std::uint32_t* const pair = list.data();
    for (std::size_t p = 0; pixels && p < pairs; ++p)
        meet_pixels(drawing, forms, pair[p] % kLanes, drawing.leaf.triangle[pair[p] % kLanes],
                    pair[p] / static_cast<std::uint32_t>(kLanes));
    for (std::size_t p = 0; !pixels && p < pairs; ++p)
        meet_vector(drawing, tile, forms, pair[p] % kLanes, drawing.leaf.triangle[pair[p] % kLanes],
                    pair[p] / static_cast<std::uint32_t>(kLanes));
}

/// A leaf through an untouched tile.
struct LeafThroughTile {
    const Leaf& leaf;
    const TileErrorBounds& errors;
    std::size_t tile;
};

/// Those of the lanes that need a look at the tile's vectors. `partly`: those that may not cover the tile;
/// they are asked last.
HWY_NOINLINE std::uint32_t unsettled(const Forms& forms, std::uint32_t lanes, std::uint32_t partly,
                                     const LeafThroughTile& through, KernelState& state) {
    std::uint32_t left = 0;
    for (const std::uint32_t some : {lanes & ~partly, lanes & partly}) {
        for (Each lane(some); lane; ++lane) {
            const bool whole = !(partly >> *lane & 1);
            if (!is_settled({forms, *lane, through.leaf.triangle[*lane], through.tile}, through.errors, whole,
                            state))
                left |= 1u << *lane;
        }
    }
    return left;
}

/// The leaf's triangles through the tile of lane `j`.
HWY_NOINLINE void draw_triangle_lanes(const KernelScene& scene, const Leaf& leaf, std::size_t j,
                                      KernelState& state) {
    TileInLeaf in_leaf;
    if (!(state.lanes.transposed >> j & 1)) transpose_tile(j, state.lanes);
    move_tile_to_leaf(state.lanes, j, leaf, in_leaf);
    Floats conic[3][6], above[3], along[3];
    triangle_forms(in_leaf, state.work.edges, conic, above, along);
    const Floats error = set(in_leaf.errors.edge);
    const Sides sides = facing_sides(sides_of(conic, error), along, error, set(in_leaf.errors.along));
    const std::uint32_t live = first_lanes(leaf.count);
    const SampleTile& tile = scene.tiles->tiles[state.group.first_tile + j];
    const TileDrawing drawing{scene,
                              state,
                              tile,
                              in_leaf.errors,
                              leaf,
                              tile.first_vector - state.group.first_vector,
                              limits_of(scene, j, state)};

    // Front where it may be seen, else back; then the back of those that may be seen from both sides.
    const std::uint32_t first_back = sides.back & ~sides.front, second_back = sides.back & sides.front;
    for (int pass = 0; pass < 2; ++pass) {
        std::uint32_t lanes = live & (pass == 0 ? sides.front | sides.back : second_back);
        if (!lanes) break;
        const Floats flip = choose(mask_of(pass == 0 ? first_back : second_back), set(-0.0f), set(0.0f));
        const TurnedDepth depth = turn_depth(above, along, flip);
        lanes &= ~bits(behind_tile(depth, set(in_leaf.errors.above), set(in_leaf.errors.along)));
        if (!lanes) continue;
        Forms forms;
        EdgeBounds bounds;
        bounds.nearest = least_depth(depth, set(in_leaf.errors.above), set(in_leaf.errors.along));
        for (int k = 0; k < 3; ++k) {
            bounds.slope_u[k] = flip_signs(conic[k][1], flip);
            bounds.slope_v[k] = flip_signs(conic[k][2], flip);
            bounds.bound[k] = flip_signs(middle_of(conic[k]), flip) + bend_of(conic[k], error);
            for (int q = 0; q < 6; ++q) store(flip_signs(conic[k][q], flip), forms.edge[k][q]);
            store(depth.above[k], forms.above[k]);
            store(depth.along[k], forms.along[k]);
        }
        if (state.seen.untouched >> j & 1) {
            lanes =
                unsettled(forms, lanes, partly_outside(conic, error, flip), {leaf, in_leaf.errors, j}, state);
            if (!lanes) continue;
            touch_tile(scene, j, state);
        }
        draw_turned(drawing, forms, bounds, lanes);
    }
}

}  // namespace HWY_NAMESPACE
}  // namespace trilens
HWY_AFTER_NAMESPACE();

#endif
