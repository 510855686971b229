// Moves a facet's rays to the local coordinates of a block of its samples.
#include "projector/blocks/block_rays.h"

#include <algorithm>
#include <cmath>

#include "projector/exact/decide.h"

namespace trilens {
namespace {

struct Rectangle {
    Vec2 centre{0}, half{0};
};

/// The positions' bounding rectangle; no thinner than `least` each way, so that its rays' hull has sides.
Rectangle bounding_rectangle(std::span<const Vec2> positions, double least) {
    Vec2 lo = positions[0], hi = positions[0];
    for (const Vec2& p : positions) {
        lo = glm::min(lo, p);
        hi = glm::max(hi, p);
    }
    return {(lo + hi) * 0.5, glm::max((hi - lo) * 0.5, Vec2(least))};
}

double size_of_part(double v) {
    return std::fabs(v);
}

double size_of_part(const Vec3& v) {
    return std::fabs(v.x) + std::fabs(v.y) + std::fabs(v.z);
}

/// c[0] + x c[1] + y c[2] as a function of u and v, with x = from.x + u half.x, y likewise. Returns the sum
/// of its absolute terms over the rectangle.
template <typename T>
double move_to(const std::array<T, 3>& c, const Vec2& from, const Vec2& half, std::array<T, 3>& moved) {
    moved = {c[0] + from.x * c[1] + from.y * c[2], half.x * c[1], half.y * c[2]};
    return size_of_part(c[0]) + (std::fabs(from.x) + half.x) * size_of_part(c[1]) +
           (std::fabs(from.y) + half.y) * size_of_part(c[2]);
}

}  // namespace

BlockRays make_block_rays(const FacetRays& facet, const SampleGrid& grid, std::span<const Id> samples) {
    BlockRays block;
    block.centre = facet.centre;
    block.count = samples.size();
    std::array<Vec2, kBlockSamples> position{};
    for (std::size_t s = 0; s < samples.size(); ++s) {
        position[s] = grid.position(samples[s]);
        block.sample[s] = facet.at(position[s]);
    }
    const Rectangle rectangle =
        bounding_rectangle(std::span(position).first(samples.size()), 0.125 / grid.side);

    const Vec2 from = rectangle.centre - facet.screen;
    block.origin_size = move_to(facet.rays.origin, from, rectangle.half, block.rays.origin);
    block.direction_size = move_to(facet.rays.direction, from, rectangle.half, block.rays.direction);
    block.weight_size = move_to(facet.rays.weight, from, rectangle.half, block.rays.weight);
    block.line = line_quadratic(block.rays);

    const std::array<double, 3>& w = block.rays.weight;
    block.weight_least = w[0] - std::fabs(w[1]) - std::fabs(w[2]) - kDecisionDoubt * block.weight_size;
    return block;
}

}  // namespace trilens
