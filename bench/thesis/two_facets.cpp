#include "thesis/two_facets.h"

#include <algorithm>
#include <cmath>

#include "thesis/search.h"
#include "trilinear/outline.h"

namespace trilens {
namespace {

constexpr int kDraws = 20000, kSteps = 8000;
constexpr double kWantedGap = 0.12;  // of the shared edge

/// A triangle's part of one facet: its share of the facet, and where it lies on the edge from corner 0 to
/// corner 2.
struct Part {
    double area = 0, low = 1, high = 0;
};

/// `shared` are the facet's local numbers of the ends of the shared edge; none where the part is not one
/// polygon.
Part part_of(const FacetScene& scene, std::array<int, 2> shared) {
    ShapeParams params;
    params.curves = Curves::kStraight, params.clip = Clip::kScreen;
    const std::vector<Outline> outlines = project_triangle(scene.facet, scene.triangle, params);
    if (outlines.size() != 1) return {};
    Part part;
    const std::vector<ImageVertex>& v = outlines[0].vertex;
    const int opposite = 3 - shared[0] - shared[1];
    for (std::size_t i = 0; i < v.size(); ++i) {
        const Vec3 &p = v[i].weights, &q = v[(i + 1) % v.size()].weights;
        if (p[opposite] != 0 && std::min(p[shared[0]], p[shared[1]]) == 0) return {};  // beyond the film
        part.area += p.y * q.z - p.z * q.y;
        if (p[opposite] != 0) continue;
        part.low = std::min(part.low, p[shared[1]]), part.high = std::max(part.high, p[shared[1]]);
    }
    part.area = std::fabs(part.area);
    return part;
}

double score_of(TwoFacets& two) {
    const std::array<Ray, 4>& c = two.corner;
    const Part first = part_of({{{c[0], c[1], c[2]}}, two.triangle}, {0, 2});
    const Part second = part_of({{{c[0], c[2], c[3]}}, two.triangle}, {0, 1});
    const double shared = std::min(first.high - first.low, second.high - second.low);
    if (!(shared > 0.15) || std::min(first.low, second.low) < 0.05 ||
        std::max(first.high, second.high) > 0.95)
        return 0;
    two.gap = std::max(std::fabs(first.low - second.low), std::fabs(first.high - second.high));
    return std::min(first.area, second.area) + 3 * std::min(two.gap, kWantedGap);
}

TwoFacets random_two(Dice& dice) {
    TwoFacets two;
    const Vec3 square[4] = {{-1, 1, 0}, {1, 1, 0}, {1, -1, 0}, {-1, -1, 0}};
    for (std::size_t k = 0; k < 4; ++k) two.corner[k] = {square[k], Vec3(0, 0, -2) + 0.5 * dice.normal()};
    for (Vec3& corner : two.triangle.corner) corner = Vec3(0, 0, -2) + 0.9 * dice.normal();
    return two;
}

}  // namespace

TwoFacets search_discontinuity(std::uint64_t seed) {
    Dice dice(seed);
    TwoFacets best;
    double score = 0;
    for (int i = 0; i < kDraws + kSteps; ++i) {
        TwoFacets next = i < kDraws || score == 0 ? random_two(dice) : best;
        if (i >= kDraws && score > 0) {
            for (Ray& ray : next.corner) ray.direction += 0.05 * dice.normal();
            for (Vec3& corner : next.triangle.corner) corner += 0.05 * dice.normal();
        }
        const double reached = score_of(next);
        if (reached > score) best = next, score = reached;
    }
    return best;
}

}  // namespace trilens
