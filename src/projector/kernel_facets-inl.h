// A leaf mode: lanes are the group's tiles, one triangle of the leaf after the other. For many tiles and few
// triangles.
// Included once per instruction set.
#if defined(TRILENS_KERNEL_FACETS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef TRILENS_KERNEL_FACETS_INL_H
#undef TRILENS_KERNEL_FACETS_INL_H
#else
#define TRILENS_KERNEL_FACETS_INL_H
#endif

#include "projector/kernel_triangles-inl.h"

HWY_BEFORE_NAMESPACE();
namespace trilens {
namespace HWY_NAMESPACE {

/// All tiles' rays as floats around a leaf's centre, lanes are tiles.
struct alignas(64) TilesInLeaf {
    float line[3][6][kLanes], moment[3][6][kLanes], origin[3][3][kLanes], direction[3][3][kLanes];
    float weight[3][kLanes], edge_doubt[kLanes];
    TileDoubts doubts[kLanes];
};

HWY_NOINLINE void move_tiles_to_leaf(const TileLanes& lanes, std::uint32_t tiles, const Leaf& leaf,
                                     TilesInLeaf& in_leaf) {
    alignas(64) double d[3][kLanes], moment_sum[3][kLanes] = {}, origin_sum[3][kLanes] = {};
    for (int a = 0; a < 3; ++a)
        for (std::size_t j = 0; j < kLanes; ++j) d[a][j] = leaf.centre[a] - lanes.centre[a][j];
    for (int a = 0; a < 3; ++a) {
        const int b = (a + 1) % 3, c = (a + 2) % 3;
        for (int q = 0; q < 6; ++q) {
            for (std::size_t j = 0; j < kLanes; ++j) {
                const double m =
                    lanes.moment[a][q][j] - (d[b][j] * lanes.line[c][q][j] - d[c][j] * lanes.line[b][q][j]);
                in_leaf.line[a][q][j] = static_cast<float>(lanes.line[a][q][j]);
                in_leaf.moment[a][q][j] = static_cast<float>(m);
                moment_sum[a][j] += std::fabs(m);
            }
        }
        for (int p = 0; p < 3; ++p) {
            for (std::size_t j = 0; j < kLanes; ++j) {
                const double o = lanes.origin[a][p][j] - lanes.weight[p][j] * d[a][j];
                in_leaf.origin[a][p][j] = static_cast<float>(o);
                in_leaf.direction[a][p][j] = static_cast<float>(lanes.direction[a][p][j]);
                origin_sum[a][j] += std::fabs(o);
            }
        }
    }
    for (int p = 0; p < 3; ++p)
        for (std::size_t j = 0; j < kLanes; ++j)
            in_leaf.weight[p][j] = static_cast<float>(lanes.weight[p][j]);
    for (Each lane(tiles); lane; ++lane) {
        const std::size_t j = *lane;
        TileSums sums;
        sums.reach = leaf.half[0] + leaf.half[1] + leaf.half[2];
        for (int a = 0; a < 3; ++a) {
            sums.moment[a] = moment_sum[a][j];
            sums.origin[a] = origin_sum[a][j];
            sums.reach += std::fabs(d[a][j]);
        }
        in_leaf.doubts[j] = doubts_of(lanes, j, leaf, sums);
        in_leaf.edge_doubt[j] = in_leaf.doubts[j].edge;
    }
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
        for (Each vector(near); vector; ++vector)
            meet_vector(drawing, forms, lane, triangle, g * static_cast<std::uint32_t>(kLanes) + *vector);
    }
}

/// These triangles of the leaf through these tiles of the group.
HWY_NOINLINE void draw_facet_lanes(const KernelScene& scene, const Leaf& leaf, std::uint32_t triangles,
                                   std::uint32_t tiles, KernelState& state) {
    TilesInLeaf in_leaf;
    std::fill_n(in_leaf.edge_doubt, kLanes, 0.0f);
    move_tiles_to_leaf(state.lanes, tiles, leaf, in_leaf);
    const Floats doubt = load(in_leaf.edge_doubt);
    for (Each triangle(triangles); triangle; ++triangle) {
        Floats conic[3][6], above[3], along[3];
        facet_forms(in_leaf, state.edges, *triangle, conic, above, along);
        const Sides sides = sides_of(conic, doubt);
        const std::uint32_t first_back = sides.back & ~sides.front, second_back = sides.back & sides.front;
        for (int pass = 0; pass < 2; ++pass) {
            const std::uint32_t lanes = tiles & (pass == 0 ? sides.front | sides.back : second_back);
            if (!lanes) break;
            const Floats flip = choose(mask_of(pass == 0 ? first_back : second_back), set(-0.0f), set(0.0f));
            Forms forms;
            alignas(64) float bound[3][kLanes];
            Mask partly = mask_of(0);
            for (int k = 0; k < 3; ++k) {
                const Floats middle = flip_signs(middle_of(conic[k]), flip), bend = bend_of(conic[k], doubt);
                store(middle + bend, bound[k]);
                partly = partly | (middle - bend - absolute(conic[k][1]) - absolute(conic[k][2]) < set(0.0f));
                for (int q = 0; q < 6; ++q) store(flip_signs(conic[k][q], flip), forms.edge[k][q]);
                store(flip_signs(above[k], flip), forms.above[k]);
                store(flip_signs(along[k], flip), forms.along[k]);
            }
            const std::uint32_t part = bits(partly);
            for (Each lane(lanes); lane; ++lane) {
                const SampleTile& tile = scene.tiles->tiles[state.first_tile + *lane];
                meet_tile(
                    {scene, state, tile, in_leaf.doubts[*lane], leaf, tile.first_vector - state.first_vector},
                    forms, bound, *lane, leaf.triangle[*triangle], !(part >> *lane & 1));
            }
        }
    }
}

}  // namespace HWY_NAMESPACE
}  // namespace trilens
HWY_AFTER_NAMESPACE();

#endif
