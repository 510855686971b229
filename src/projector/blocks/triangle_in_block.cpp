// Bounds a triangle's three edge conics over a block; where the triangle may be seen, each sample decides.
#include "projector/blocks/triangle_in_block.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace trilens {
namespace {

double sum_of_parts(const Vec3& v) {
    return std::fabs(v.x) + std::fabs(v.y) + std::fabs(v.z);
}

/// Below this an edge conic's sign is in doubt.
double doubt_of_edges(const BlockRays& block, const std::array<Vec3, 3>& corner) {
    if (!(block.weight_least > 0)) return std::numeric_limits<double>::infinity();
    const double size = std::max({sum_of_parts(corner[0]), sum_of_parts(corner[1]), sum_of_parts(corner[2])});
    const double p = block.weight_size * size + block.origin_size;
    return kDecisionDoubt * block.direction_size * p * p / block.weight_least;
}

/// Whether some ray of the block may see all three edges from one side.
bool may_be_seen(const std::array<EdgeConic, 3>& edge, double doubt) {
    bool all_positive = true, all_negative = true;
    for (const EdgeConic& conic : edge) {
        const Range range = range_over_square(conic);
        if (range.high < -doubt) all_positive = false;
        if (range.low > doubt) all_negative = false;
    }
    return all_positive || all_negative;
}

}  // namespace

void draw_triangle(const BlockRays& block, const LocalTriangle& triangle, FirstHits& hits) {
    const std::array<Vec3, 3>& p = triangle.corner;
    const std::array<EdgeConic, 3> edge{edge_conic(block.line, p[1], p[2]),
                                        edge_conic(block.line, p[2], p[0]),
                                        edge_conic(block.line, p[0], p[1])};
    if (!may_be_seen(edge, doubt_of_edges(block, p))) return;
    for (std::size_t s = 0; s < block.count; ++s) {
        const std::optional<LineHit> hit = decide(block.sample[s], p);
        if (hit) hits.offer(s, *hit, triangle.index, triangle.rank);
    }
}

}  // namespace trilens
