// Evaluates a triangle's three edge conics over a block; where rounding could matter, decides the sample
// exactly.
#include "projector/triangle_in_block.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "base/side_of_edge.h"

namespace trilens {
namespace {

// An edge conic further from zero than this share of its terms has the sign of the exact decision. Counting
// roundings: 20 in the conic, 24 in the corners' positions on the ray's screen; each half a unit in the last
// place.
constexpr double kDoubt = 64 * std::numeric_limits<double>::epsilon();

double size_of(const Vec3& v) {
    return std::fabs(v.x) + std::fabs(v.y) + std::fabs(v.z);
}

/// Below this an edge conic's sign is in doubt. With p = weight corner - origin', the conic is
/// direction' . (p_a x p_b) / weight.
double doubt_of_edges(const BlockRays& block, const std::array<Vec3, 3>& corner) {
    if (!(block.weight_least > 0)) return std::numeric_limits<double>::infinity();
    const double size = std::max({size_of(corner[0]), size_of(corner[1]), size_of(corner[2])});
    const double p = block.weight_size * size + block.origin_size;
    return kDoubt * block.direction_size * p * p / block.weight_least;
}

/// t along the triangle's plane: (weight n . corner - n . origin') / (n . direction'), linear over linear.
struct PlaneDepth {
    std::array<double, 3> above{}, along{};

    PlaneDepth(const AffineRays& rays, const std::array<Vec3, 3>& corner) {
        const Vec3 n = cross(corner[1] - corner[0], corner[2] - corner[0]);
        const double height = dot(n, corner[0]);
        for (std::size_t k = 0; k < 3; ++k) {
            above[k] = rays.weight[k] * height - dot(n, rays.origin[k]);
            along[k] = dot(n, rays.direction[k]);
        }
    }
    double at(double u, double v) const {
        return (above[0] + u * above[1] + v * above[2]) / (along[0] + u * along[1] + v * along[2]);
    }
};

/// The same question answered for one ray with exact signs: the corners are projected along the ray on the
/// plane of two axes, where the ray is the origin. Every triangle with a corner gets the same projection of
/// it, so the rounded picture is still a mesh without gaps (Woop, Benthin, Wald, Watertight Ray/Triangle
/// Intersection, 2013).
std::optional<LineHit> decide_exactly(const BlockRays& block, const std::array<Vec3, 3>& corner,
                                      std::size_t s) {
    const double u = block.u[s], v = block.v[s];
    const Vec3 origin = block.rays.origin_at(u, v), direction = block.rays.direction_at(u, v);
    const double weight = block.rays.weight_at(u, v);
    const Vec3 speed = glm::abs(direction);
    const int z = speed.x > speed.y ? (speed.x > speed.z ? 0 : 2) : (speed.y > speed.z ? 1 : 2);
    const int x = (z + 1) % 3, y = (z + 2) % 3;
    if (!(speed[z] > 0)) return std::nullopt;

    std::array<Vec3, 3> flat;
    Vec3 t;
    for (std::size_t k = 0; k < 3; ++k) {
        const Vec3 p = weight * corner[k] - origin;
        flat[k] = {p[x] - direction[x] / direction[z] * p[z], p[y] - direction[y] / direction[z] * p[z], 1};
        t[static_cast<int>(k)] = p[z] / direction[z];
    }
    const int side = side_of_edge(flat[0], flat[1]);
    if (side == 0 || side_of_edge(flat[1], flat[2]) != side || side_of_edge(flat[2], flat[0]) != side)
        return std::nullopt;

    // Barycentrics and depth as convex combinations: never outside the triangle, however thin it is.
    const auto area = [&](std::size_t a, std::size_t b) {
        return difference_of_products(flat[a].x, flat[b].y, flat[a].y, flat[b].x);
    };
    Vec3 share(area(1, 2), area(2, 0), area(0, 1));
    share /= share.x + share.y + share.z;
    return LineHit{dot(share, t), {share.y, share.z}};
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
    const double doubt = doubt_of_edges(block, p);
    if (!may_be_seen(edge, doubt)) return;

    const PlaneDepth depth(block.rays, p);
    for (std::size_t s = 0; s < block.count; ++s) {
        const double u = block.u[s], v = block.v[s];
        const double s0 = edge[0].at(u, v), s1 = edge[1].at(u, v), s2 = edge[2].at(u, v);
        const double low = std::min({s0, s1, s2}), high = std::max({s0, s1, s2});
        if (low > doubt || high < -doubt) {
            const double sum = s0 + s1 + s2;
            hits.offer(s, {depth.at(u, v), {s1 / sum, s2 / sum}}, triangle.index, triangle.rank);
        } else if (!(low < -doubt && high > doubt)) {
            const std::optional<LineHit> hit = decide_exactly(block, p, s);
            if (hit) hits.offer(s, *hit, triangle.index, triangle.rank);
        }
    }
}

}  // namespace trilens
