// Sets up a block's rays: weights, origins and directions as linear functions of local screen coordinates.
#include "projector/block_rays.h"

#include <algorithm>
#include <cmath>

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

double sum_of_sizes(const std::array<Vec3, 3>& v) {
    double sum = 0;
    for (const Vec3& part : v) sum += std::fabs(part.x) + std::fabs(part.y) + std::fabs(part.z);
    return sum;
}

/// The facet's unnormalised weights e as 1, u and v parts, scaled so that they sum to 1 or -1 at `reference`.
std::array<Vec3, 3> local_weights(const FacetWeights& weights, const Rectangle& rectangle,
                                  const Vec3& reference) {
    const double sum = std::fabs(reference.x + reference.y + reference.z);
    const double scale = sum > 0 ? 1 / sum : 1;
    return {scale * weights.unnormalised(rectangle.centre.x, rectangle.centre.y),
            scale * rectangle.half.x * weights.weights_from_screen[0],
            scale * rectangle.half.y * weights.weights_from_screen[1]};
}

}  // namespace

BlockRays make_block_rays(const FacetOnScreen& facet, const SampleGrid& grid, std::span<const Id> samples) {
    BlockRays block;
    block.count = samples.size();
    std::array<Vec2, kBlockSamples> position{};
    for (std::size_t s = 0; s < samples.size(); ++s) position[s] = grid.position(samples[s]);
    const Rectangle rectangle =
        bounding_rectangle(std::span(position).first(samples.size()), 0.125 / grid.side);
    for (std::size_t s = 0; s < samples.size(); ++s) {
        const Vec2 from_centre = position[s] - rectangle.centre;
        block.u[s] = from_centre.x / rectangle.half.x;
        block.v[s] = from_centre.y / rectangle.half.y;
    }

    // The local origin is where the middle sample's ray starts: a sample, since the rectangle's own centre
    // may lie beyond the facet's horizon.
    const Vec2 middle = position[samples.size() / 2];
    const Vec3 reference = facet.weights.unnormalised(middle.x, middle.y);
    const double sum = reference.x + reference.y + reference.z;
    block.centre = interpolated_ray(facet.mesh, facet.facet, reference / (sum != 0 ? sum : 1)).origin;

    // Interpolate the corner rays with each part of the weights.
    const std::array<Vec3, 3> e = local_weights(facet.weights, rectangle, reference);
    for (std::size_t part = 0; part < 3; ++part) {
        for (int k = 0; k < 3; ++k) {
            const Ray& ray = facet.mesh.rays[facet.mesh.facets[facet.facet][static_cast<std::size_t>(k)]];
            block.rays.origin[part] += e[part][k] * (ray.origin - block.centre);
            block.rays.direction[part] += e[part][k] * ray.direction;
            block.rays.weight[part] += e[part][k];
        }
    }
    block.line = line_quadratic(block.rays);

    const std::array<double, 3>& w = block.rays.weight;
    block.origin_size = sum_of_sizes(block.rays.origin);
    block.direction_size = sum_of_sizes(block.rays.direction);
    block.weight_size = std::fabs(w[0]) + std::fabs(w[1]) + std::fabs(w[2]);
    block.weight_least = w[0] - std::fabs(w[1]) - std::fabs(w[2]);
    return block;
}

}  // namespace trilens
