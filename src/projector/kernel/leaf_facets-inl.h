// A leaf mode: lanes are the group's tiles, one triangle of the leaf after the other. For many tiles and few
// triangles.
// Included once per instruction set.
#if defined(TRILENS_KERNEL_LEAF_FACETS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef TRILENS_KERNEL_LEAF_FACETS_INL_H
#undef TRILENS_KERNEL_LEAF_FACETS_INL_H
#else
#define TRILENS_KERNEL_LEAF_FACETS_INL_H
#endif

#include "projector/kernel/leaf_triangles-inl.h"

HWY_BEFORE_NAMESPACE();
namespace trilens {
namespace HWY_NAMESPACE {

/// All tiles' rays as floats around a leaf's centre, lanes are tiles.
struct alignas(64) TilesInLeaf {
    float line[3][6][kLanes], moment[3][6][kLanes], origin[3][3][kLanes], direction[3][3][kLanes];
    float weight[3][kLanes];
    float edge_error[kLanes], above_error[kLanes], along_error[kLanes];  // TileErrorBounds
};

/// error_bounds_of() in lanes. The sums are over the coefficients of moments and origins.
HWY_INLINE void put_error_bounds(const TileLanes& lanes, const Leaf& leaf, const DoubleLanes3& d,
                                 const DoubleLanes3& moment_sum, const DoubleLanes3& origin_sum,
                                 TilesInLeaf& in_leaf) {
    const double h[3] = {leaf.half[0], leaf.half[1], leaf.half[2]};
    const double hh[3] = {h[1] * h[2], h[2] * h[0], h[0] * h[1]};
    const auto number = [](double v) HWY_ATTR { return hn::Set(kDouble, v); };
    DoubleLanes edge_error, above_error, along_error;
    for (std::size_t i = 0; i < kHalves; ++i) {
        const std::size_t at = i * kDoubles;
        const auto lane = [at](const double* from) HWY_ATTR { return hn::Load(kDouble, from + at); };
        Double edge = number(0), along = edge, above = edge, all = edge, reach = number(h[0] + h[1] + h[2]);
        for (int a = 0; a < 3; ++a) {
            const Double moment = moment_sum.axis[a].part[i], origin = origin_sum.axis[a].part[i],
                         line = lane(lanes.line_sum[a]);
            edge = hn::MulAdd(line, number(hh[a]), hn::MulAdd(moment, number(h[a]), edge));
            along = hn::MulAdd(lane(lanes.direction_sum[a]), number(hh[a]), along);
            above =
                hn::MulAdd(number(hh[a]), hn::MulAdd(lane(lanes.weight_sum), number(h[a]), origin), above);
            all = hn::Add(all, hn::Add(line, hn::Add(moment, origin)));
            reach = hn::Add(reach, hn::Abs(d.axis[a].part[i]));
        }
        const Double far = hn::MulAdd(lane(lanes.weight_terms), reach, lane(lanes.origin_terms));
        const Double tiny = hn::Mul(number(static_cast<double>(kUnderflow)), hn::Add(number(1), all));
        const Double decision =
            hn::Mul(number(1.0001), hn::Mul(lane(lanes.decision_error), hn::Mul(far, far)));
        edge_error.part[i] =
            hn::MulAdd(number(static_cast<double>(kEdgeErrorBound)), edge, hn::Add(decision, tiny));
        along_error.part[i] =
            hn::Mul(number(2), hn::MulAdd(number(static_cast<double>(kDepthErrorBound)), along, tiny));
        above_error.part[i] = hn::Mul(
            number(2),
            hn::MulAdd(number(static_cast<double>(kDepthErrorBound)), above,
                       hn::MulAdd(number(8 * kDecisionErrorBound * (hh[0] + hh[1] + hh[2])), far, tiny)));
    }
    store(narrow(edge_error), in_leaf.edge_error);
    store(narrow(along_error), in_leaf.along_error);
    store(narrow(above_error), in_leaf.above_error);
}

/// All lanes; those that hold no tile of the group are of no use.
HWY_NOINLINE void move_tiles_to_leaf(const TileLanes& lanes, const Leaf& leaf, TilesInLeaf& in_leaf) {
    DoubleLanes3 d, moment_sum, origin_sum;
    const Vector3 centre = {hn::Set(kDouble, leaf.centre[0]), hn::Set(kDouble, leaf.centre[1]),
                            hn::Set(kDouble, leaf.centre[2])};
    const Vector3 zero = {hn::Zero(kDouble), hn::Zero(kDouble), hn::Zero(kDouble)};
    for (std::size_t i = 0; i < kHalves; ++i) {
        d.set(i, minus(centre, load3(lanes.centre, i * kDoubles)));
        moment_sum.set(i, zero);
        origin_sum.set(i, zero);
    }
    for (int q = 0; q < 6; ++q) {
        DoubleLanes3 line, moment;
        for (std::size_t i = 0; i < kHalves; ++i) {
            const std::size_t at = i * kDoubles;
            line.set(i, load_part(lanes.line, q, at));
            moment.set(i, minus(load_part(lanes.moment, q, at), cross(d.at(i), line.at(i))));
            moment_sum.set(i, plus(moment_sum.at(i), absolute(moment.at(i))));
        }
        for (int a = 0; a < 3; ++a) {
            store(narrow(line.axis[a]), in_leaf.line[a][q]);
            store(narrow(moment.axis[a]), in_leaf.moment[a][q]);
        }
    }
    for (int p = 0; p < 3; ++p) {
        DoubleLanes3 origin, direction;
        DoubleLanes weight;
        for (std::size_t i = 0; i < kHalves; ++i) {
            const std::size_t at = i * kDoubles;
            weight.part[i] = hn::Load(kDouble, lanes.weight[p] + at);
            origin.set(i, minus(load_part(lanes.origin, p, at), times(weight.part[i], d.at(i))));
            direction.set(i, load_part(lanes.direction, p, at));
            origin_sum.set(i, plus(origin_sum.at(i), absolute(origin.at(i))));
        }
        for (int a = 0; a < 3; ++a) {
            store(narrow(origin.axis[a]), in_leaf.origin[a][p]);
            store(narrow(direction.axis[a]), in_leaf.direction[a][p]);
        }
        store(narrow(weight), in_leaf.weight[p]);
    }
    put_error_bounds(lanes, leaf, d, moment_sum, origin_sum, in_leaf);
}

/// One triangle's conics and depth through 16 tiles.
HWY_INLINE void facet_forms(const TilesInLeaf& tiles, const LeafEdges& edges, std::size_t j,
                            Floats (&conic)[3][6], Floats (&above)[3], Floats (&along)[3]) {
    for (int q = 0; q < 6; ++q) {
        const Floats dx = load(tiles.line[0][q]), dy = load(tiles.line[1][q]), dz = load(tiles.line[2][q]);
        const Floats mx = load(tiles.moment[0][q]), my = load(tiles.moment[1][q]),
                     mz = load(tiles.moment[2][q]);
        for (int k = 0; k < 3; ++k) {
            const auto& l = edges.edge[k];
            const auto& m = edges.moment[k];
            conic[k][q] = multiply_add(
                dx, set(m[0][j]),
                multiply_add(dy, set(m[1][j]),
                             multiply_add(dz, set(m[2][j]),
                                          multiply_add(mx, set(l[0][j]),
                                                       multiply_add(my, set(l[1][j]), mz * set(l[2][j]))))));
        }
    }
    const Floats nx = set(edges.normal[0][j]), ny = set(edges.normal[1][j]), nz = set(edges.normal[2][j]),
                 height = set(edges.height[j]);
    for (int p = 0; p < 3; ++p) {
        above[p] = subtract_product(
            nx, load(tiles.origin[0][p]),
            subtract_product(ny, load(tiles.origin[1][p]),
                             subtract_product(nz, load(tiles.origin[2][p]), load(tiles.weight[p]) * height)));
        along[p] =
            multiply_add(nx, load(tiles.direction[0][p]),
                         multiply_add(ny, load(tiles.direction[1][p]), nz * load(tiles.direction[2][p])));
    }
}

/// The triangle of forms' lane against the vectors of its tile that it may touch.
HWY_NOINLINE void meet_tile(const TileDrawing& drawing, const Forms& forms, const float (&bound)[3][kLanes],
                            std::size_t lane, Id triangle, bool whole) {
    constexpr std::uint32_t kFewVectors = 4;  // measured: no box is worth asking
    const SampleTile& tile = drawing.tile;
    const TileVectors vectors = vectors_of(drawing);
    for (std::uint32_t g = 0; g * kLanes < tile.vectors; ++g) {
        std::uint32_t near = first_lanes(tile.vectors - g * static_cast<std::uint32_t>(kLanes));
        if (!whole && tile.vectors > kFewVectors) {
            const VectorBoxes& box = drawing.scene.tiles->boxes[tile.first_boxes + g];
            const Floats cu = load(box.centre_u), cv = load(box.centre_v), hu = load(box.half_u),
                         hv = load(box.half_v);
            Mask outside = mask_of(0);
            for (int k = 0; k < 3; ++k) {
                const Floats a = set(forms.edge[k][1][lane]), b = set(forms.edge[k][2][lane]);
                const Floats highest =
                    multiply_add(absolute(a), hu,
                                 multiply_add(absolute(b), hv,
                                              multiply_add(a, cu, multiply_add(b, cv, set(bound[k][lane])))));
                outside = outside | (highest < set(0.0f));
            }
            near &= ~bits(outside);
        }
        for (Each vector(drawing.scene.pixels ? near : 0); vector; ++vector)
            meet_pixels(drawing, forms, lane, triangle, g * static_cast<std::uint32_t>(kLanes) + *vector);
        for (Each vector(drawing.scene.pixels ? 0 : near); vector; ++vector)
            meet_vector(drawing, vectors, forms, lane, triangle,
                        g * static_cast<std::uint32_t>(kLanes) + *vector);
    }
}

/// These triangles of the leaf through these tiles of the group.
HWY_NOINLINE void draw_facet_lanes(const KernelScene& scene, const Leaf& leaf, std::uint32_t triangles,
                                   std::uint32_t tiles, KernelState& state) {
    TilesInLeaf in_leaf;
    move_tiles_to_leaf(state.lanes, leaf, in_leaf);
    const Floats error = load(in_leaf.edge_error);
    for (Each triangle(triangles); triangle; ++triangle) {
        Floats conic[3][6], above[3], along[3];
        facet_forms(in_leaf, state.work.edges, *triangle, conic, above, along);
        const Sides sides = facing_sides(sides_of(conic, error), along, error, load(in_leaf.along_error));
        const std::uint32_t first_back = sides.back & ~sides.front, second_back = sides.back & sides.front;
        for (int pass = 0; pass < 2; ++pass) {
            std::uint32_t lanes = tiles & (pass == 0 ? sides.front | sides.back : second_back);
            if (!lanes) break;
            const Floats flip = choose(mask_of(pass == 0 ? first_back : second_back), set(-0.0f), set(0.0f));
            const TurnedDepth depth = turn_depth(above, along, flip);
            lanes &= ~bits(behind_tile(depth, load(in_leaf.above_error), load(in_leaf.along_error)));
            if (!lanes) continue;
            Forms forms;
            alignas(64) float bound[3][kLanes];
            for (int k = 0; k < 3; ++k) {
                const Floats middle = flip_signs(middle_of(conic[k]), flip), bend = bend_of(conic[k], error);
                store(middle + bend, bound[k]);
                for (int q = 0; q < 6; ++q) store(flip_signs(conic[k][q], flip), forms.edge[k][q]);
                store(depth.above[k], forms.above[k]);
                store(depth.along[k], forms.along[k]);
            }
            const std::uint32_t part = partly_outside(conic, error, flip);
            for (Each lane(lanes); lane; ++lane) {
                const SampleTile& tile = scene.tiles->tiles[state.group.first_tile + *lane];
                const TileErrorBounds errors{in_leaf.edge_error[*lane], in_leaf.above_error[*lane],
                                             in_leaf.along_error[*lane]};
                const bool whole = !(part >> *lane & 1);
                if (is_settled({forms, *lane, leaf.triangle[*triangle], *lane}, errors, whole, state))
                    continue;
                touch_tile(scene, *lane, state);
                meet_tile(
                    {scene, state, tile, errors, leaf, tile.first_vector - state.group.first_vector, nullptr},
                    forms, bound, *lane, leaf.triangle[*triangle], whole);
            }
        }
    }
}

}  // namespace HWY_NAMESPACE
}  // namespace trilens
HWY_AFTER_NAMESPACE();

#endif
