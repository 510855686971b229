#include "render/engines/border_pixels.h"

#include <algorithm>
#include <cmath>

namespace trilens {
namespace {

constexpr double kOpenRoom = 1e-10;       // of a product: far more than it rounds by, or an exact decision
constexpr float kOpenRoomInTime = 1e-5f;  // of t, as much
constexpr std::size_t kMostFacets = 16;

/// A facet as the rays of a pixel's outermost samples meet it.
struct MetFacet {
    Id facet = kNone;
    bool front = true;
    std::array<bool, 3> open{};  // whether the pixel may reach over the edge from corner k to the next
    bool holds_corner = false;   // of the pixel, surely
    float low = 0, high = 0;     // of t of its plane
};

enum class PixelMeets { kMet, kMissed, kUnclear };

PixelMeets meet(const SurfaceGrid& grid, const std::array<Ray, 4>& corner, MetFacet& met) {
    const IdTriple& facet = grid.facets[met.facet];
    std::array<Vec3, 3> p;
    for (std::size_t k = 0; k < 3; ++k) p[k] = grid.points[grid.corner_point[facet[k]]];
    const Vec3 normal = cross(p[1] - p[0], p[2] - p[0]);
    std::array<int, 3> inside{}, outside{};
    double low = INFINITY, high = -INFINITY;
    int front = 0;
    for (const Ray& ray : corner) {
        const double along = dot(normal, ray.direction);
        if (!(std::fabs(along) > kOpenRoom * length(normal) * length(ray.direction)))
            return PixelMeets::kUnclear;
        const int sign = along < 0 ? 1 : -1;
        if (front != 0 && sign != front) return PixelMeets::kUnclear;
        front = sign;
        const double t = dot(normal, p[0] - ray.origin) / along;
        low = std::min(low, t), high = std::max(high, t);
        bool in_all = true;
        for (std::size_t k = 0; k < 3; ++k) {
            const Vec3 a = p[k] - ray.origin, b = p[(k + 1) % 3] - ray.origin;
            const double side = -sign * triple(a, b, ray.direction),
                         room = kOpenRoom * length(a) * length(b) * length(ray.direction);
            inside[k] += side > room;
            outside[k] += side < -room;
            in_all = in_all && side > room;
        }
        met.holds_corner = met.holds_corner || in_all;
    }
    if (!(low > 0)) return PixelMeets::kUnclear;
    for (std::size_t k = 0; k < 3; ++k) {
        if (outside[k] == 4) return PixelMeets::kMissed;
        met.open[k] = inside[k] < 4;
    }
    met.front = front > 0;
    met.low = static_cast<float>(low) * (1 - kOpenRoomInTime);
    met.high = static_cast<float>(high) * (1 + kOpenRoomInTime);
    return PixelMeets::kMet;
}

/// The one of the facets that shares the edge from corner k of `one` to the next, seen from the same side.
const MetFacet* beyond_edge(const SurfaceGrid& grid, std::span<const MetFacet> met, const MetFacet& one,
                            std::size_t k) {
    const auto point = [&](const MetFacet& of, std::size_t c) {
        return grid.corner_point[grid.facets[of.facet][c % 3]];
    };
    for (const MetFacet& other : met)
        for (std::size_t m = 0; m < 3; ++m)
            if (other.front == one.front && point(other, m) == point(one, k + 1) &&
                point(other, m + 1) == point(one, k))
                return &other;
    return nullptr;
}

}  // namespace

std::optional<JointFacets> joint_facets(const SurfaceGrid& grid, std::span<const PixelTriangle> candidates,
                                        const std::array<Ray, 4>& corner) {
    std::vector<MetFacet> met;
    for (const PixelTriangle& candidate : candidates) {
        MetFacet one;
        one.facet = candidate.triangle;
        const PixelMeets meeting = meet(grid, corner, one);
        if (meeting == PixelMeets::kUnclear || met.size() == kMostFacets) return std::nullopt;
        if (meeting == PixelMeets::kMet) met.push_back(one);
    }
    if (met.empty()) return std::nullopt;
    // From the nearest over all edges in the pixel.
    const MetFacet* const nearest = &*std::min_element(
        met.begin(), met.end(), [](const MetFacet& a, const MetFacet& b) { return a.low < b.low; });
    std::vector<const MetFacet*> joint{nearest};
    const auto is_joint = [&](const MetFacet* one) {
        return std::find(joint.begin(), joint.end(), one) != joint.end();
    };
    for (std::size_t i = 0; i < joint.size(); ++i)
        for (std::size_t k = 0; k < 3; ++k) {
            if (!joint[i]->open[k]) continue;
            const MetFacet* const other = beyond_edge(grid, met, *joint[i], k);
            if (!other) return std::nullopt;
            if (!is_joint(other)) joint.push_back(other);
        }
    JointFacets found{{nearest->facet, nearest->low, nearest->high}, {}};
    bool covers = false;
    for (const MetFacet* one : joint) {
        if (grid.facet_face[one->facet] != grid.facet_face[nearest->facet]) return std::nullopt;
        found.seen.t_high = std::max(found.seen.t_high, one->high);
        found.facets.push_back(one->facet);
        covers = covers || one->holds_corner;
    }
    for (const MetFacet& other : met)
        if (!is_joint(&other) && !(other.low > found.seen.t_high)) return std::nullopt;
    if (!covers) return std::nullopt;
    return found;
}

}  // namespace trilens
