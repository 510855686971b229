// What the stages of the vector engine hand to each other: plain arrays, 16 lanes each.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <vector>

#include "projector/exact/exact_hit.h"
#include "projector/kernel/kernel.h"

namespace trilens {

// A float decision is trusted beyond this many half units in the last place of its terms' absolute sum.
// Counting roundings, with u = 2^-24, h the leaf's half sizes, sums over the components c and the six
// coefficients:
// - A corner's float is off by u h; an edge l = p_b - p_a by 4 u h_c, its terms up to 2 h_c; its moment m =
// p_a x
//   p_b by 8 u h_j h_k, its terms up to 2 h_j h_k.
// - A coefficient D . m + M . l of an edge's conic therefore is off by (8 + 2) u |D_c| h_j h_k + (4 + 2) u
// |M_c| h_c
//   by its inputs, and by 6 u T in its sum of six products, T = 2 |D_c| h_j h_k + 2 |M_c| h_c.
// - Horner's rule adds 10 u T (without fused multiply-add), the local coordinates' own rounding 6 u T, the
// bounds
//   that the leaf modes take over a tile 6 u T. With D taken three times:
//   in all at most (10 + 56) u sum |D_c| h_j h_k + (6 + 56) u sum |M_c| h_c.
inline constexpr float kEdgeErrorBound = 72 * 0x1p-24f;
// - The normal n = l_1 x l_2 is off by 56 u h_j h_k, its terms are up to 8 h_j h_k; N = n . d, linear in u
// and v,
//   by 56 u and 10 u of 8 h_j h_k |d_c|; A = W n . p_0 - n . O by 56 u and 13 u of 8, times |O_c| + W h_c.
inline constexpr float kDepthErrorBound = 176 * 0x1p-24f;
// t = A / N by a reciprocal of 2^-22 and a product. Far more than kDepthTie.
inline constexpr float kTimeErrorBound = 0x1p-19f;
// Products below the normal range lose up to this, times what they are multiplied with.
inline constexpr float kUnderflow = 1e-36f;

// A box is beyond a plane by floats only if it is by this share of the coordinates: eight roundings.
inline constexpr double kPlaneErrorBound = 16 * 0x1p-24;

inline constexpr float kNever = std::numeric_limits<float>::infinity();
inline constexpr std::uint32_t kAllLanes = 65535;

/// Beams, one per lane: the hull of four corner rays, from a centre of each, and planes around it.
struct alignas(64) TileFrusta {
    double centre[3][kLanes];     // world frame
    double origin_terms[kLanes];  // the origins are sums of terms of this size
    double origin[4][3][kLanes], direction[4][3][kLanes];
    float plane[4][3][kLanes], offset[4][kLanes];  // into the beam; positions from the tree's centre
};

/// 16 tiles, one per lane, as functions of their local coordinates (parts 1, u, v; quadratics 1, u, v, u^2, u
/// v, v^2), scaled to weight 1 where it is largest of the samples'; positions from each facet's centre.
struct alignas(64) TileLanes {
    double centre[3][kLanes];                                                 // of the facet, world frame
    double weight[3][kLanes], origin[3][3][kLanes], direction[3][3][kLanes];  // [axis][part][lane]
    double line[3][6][kLanes], moment[3][6][kLanes];  // Pluecker coordinates times weight^2
    // Bounds over the tile.
    double line_sum[3][kLanes];       // of the absolute coefficients of `line`
    double direction_sum[3][kLanes];  // of `direction`
    double weight_sum[kLanes];
    double weight_low[kLanes], weight_high[kLanes];     // of the samples; high before it is scaled to 1
    double origin_terms[kLanes], weight_terms[kLanes];  // as BlockRays' sizes
    double decision_error[kLanes];  // times (weight_terms reach + origin_terms)^2: the decision's own error

    TileFrusta hull;

    // The same by tile, so that the coefficients of one are together: line 0..2, moment 3..5, origin 6..8,
    // direction 9..11, weight 12. Made for the tiles of `transposed`.
    double tile[kLanes][13][8];
    std::uint32_t transposed;
    std::uint32_t broken;  // bit j: the vector engine cannot bound this tile
};

/// A group's beam, and what it knows of depth.
struct GroupBeam {
    float plane[6][3], offset[6];
    int planes = 0;
    float axis[3] = {0, 0, 0};
    float start = 0, speed_inverse = 0;  // t >= (axis . x - start) * speed_inverse for every x on a ray
    // Of the middle tile: how far apart neighbouring samples' rays are: u at t = 0, per t; v likewise.
    float pitch[4];
};

/// The nearest sure hit of each sample of a vector so far: its t lies in [low, high].
struct alignas(64) Nearest {
    float low[kLanes], high[kLanes];
    std::uint32_t triangle[kLanes];  // index into PreparedScene::Data, or kNone
};

/// A triangle that every sample of a tile surely meets: t = above / along, in local coordinates, and no more
/// than `farthest`.
struct WholeTile {
    std::uint32_t triangle = 0;  // index into PreparedScene::Data
    float above[3], along[3];
    float above_error, along_error;
    float farthest;
};

/// Where lanes are pixels: no triangle that some of a lane's samples may see, and others may not, is nearer.
struct alignas(64) Doubts {
    float low[kLanes];
};

/// A triangle that may be what a sample sees, or may not.
struct AmbiguousHit {
    std::uint32_t vector, lane, triangle;
};

/// A leaf's edges and their moments, lanes are triangles; edge k is opposite to corner k.
struct alignas(64) LeafEdges {
    float edge[3][3][kLanes], moment[3][3][kLanes];  // [edge][axis]
    float normal[3][kLanes], height[kLanes];         // n and n . p_0
};

/// A node or leaf that waits, the smallest t at which a ray of the group can meet it, and where its box is:
/// in which node, in which lane.
struct Waiting {
    float nearest;
    std::int32_t child;
    std::uint32_t parent, lane;
};

/// The rays of a vector's samples, weight divided out, from their facet's centre; 1 / direction, and origin /
/// direction.
struct alignas(64) VectorRays {
    double origin[3][kLanes], direction[3][kLanes];
    float inverse[3][kLanes], start[3][kLanes];
};

/// The rays of a mixed vector's samples as FacetRays::at gives them, and their facets' centres.
struct alignas(64) MixedRays {
    double centre[3][kLanes];  // world frame
    double origin[3][kLanes], direction[3][kLanes], weight[kLanes];
};

/// Beams around 16 vectors.
struct alignas(64) VectorBeams {
    float plane[4][3][kLanes], offset[4][kLanes];  // positions from the tree's centre
    float farthest[kLanes];                        // no farther hit can matter to the vector
};

/// A triangle's frame for one facet.
struct CachedFrame {
    TriangleFrame frame;
    Id triangle = kNone;                 // index into the scene
    std::uint8_t second = 1, third = 2;  // which sorted corners are the scene's second and third
};

/// The frames of some triangles that one facet sees, by the index into PreparedScene::Data modulo
/// kCachedFrames.
inline constexpr std::size_t kCachedFrames = 16;
struct FrameCache {
    Id rays = kNone;  // of the facet
    std::array<Id, kCachedFrames> triangle{};
    std::array<CachedFrame, kCachedFrames> frame;
};

/// By vector of a tile, like VectorBoxes: no farther hit can matter.
struct alignas(64) VectorLimits {
    float farthest[kLanes];
};

/// Which tiles and vectors are drawn: a group of a batch, or some vectors of a mixed group. Set before each
/// walk.
struct GroupSpan {
    std::uint32_t first_tile = 0;             // of the batch
    std::uint32_t first_lane = 0, tiles = 0;  // the group's lanes
    std::uint32_t first_vector = 0, vectors = 0;
    std::array<std::uint32_t, kLanes + 1> tile_vectors{};  // where the tiles' vectors begin, in the group
};

/// What the group's samples see so far, and how far hits can still matter.
struct GroupSeen {
    alignas(64) float farthest[kLanes];  // by tile: no farther hit can matter
    std::vector<VectorLimits> limits;    // like the boxes of the group's tiles
    float all_farthest = kNever;
    // By tile: what is known of all its samples at once, until one of its vectors meets another triangle.
    std::array<WholeTile, kLanes> whole;
    std::uint32_t untouched = 0;   // bit j: `nearest` of the vectors of the tile of lane j is not set
    std::uint32_t covered = 0;     // of those: bit j: whole[j] is seen, else nothing
    std::vector<Nearest> nearest;  // by vector of the group
    std::vector<Doubts> doubts;    // likewise, where lanes are pixels
    std::vector<AmbiguousHit> ambiguous;
    std::size_t most_ambiguous = 0;     // beyond that the group is left to the scalar engine
    std::size_t ambiguous_samples = 0;  // of all groups so far
};

/// What stages work with; nothing of it outlives a group.
struct KernelWork {
    std::vector<Waiting> stack;        // of the walk
    LeafEdges edges;                   // of the leaf at hand
    std::vector<std::uint32_t> pairs;  // vectors and triangles that may meet
    std::vector<VectorRays> rays;      // by vector of the group, where rays_made says so
    std::vector<std::uint8_t> rays_made, tile_of_vector;
    std::vector<MixedRays> mixed;    // by vector of the group
    std::vector<VectorBeams> beams;  // by 16 vectors of the group, where beams_made
    bool beams_made = false;
};

/// Everything that one thread needs for one batch.
struct KernelState {
    TileLanes lanes;  // the batch's set-up: written by set_up_batch(), read by all stages
    GroupBeam beam;   // the group's frustum: written before the walk, read by it
    GroupSpan group;
    GroupSeen seen;
    KernelWork work;
    FrameCache cache;  // triangles' frames for the facet at hand, kept over groups
};

}  // namespace trilens
