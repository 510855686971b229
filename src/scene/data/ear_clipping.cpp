// The winding number law: triangles between the corners whose oriented boundaries sum to the polygon's cover
// each point as often as the polygon winds about it, if all have its orientation. So a cut into triangles of
// positive area is right, whatever way it was found.
#include "scene/data/ear_clipping.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>

namespace trilens {
namespace {

constexpr double kGrid = 1 << 29;  // half the extent, in steps: twice an area stays below 2^61

// Twice the area by which a flat corner may turn the wrong way once its points lie on the grid: half a step
// each over differences of up to 2^30.
constexpr std::int64_t kFlatArea = (std::int64_t{1} << 32) + 2;

struct GridPoint {
    std::int64_t x = 0, y = 0;
    bool operator==(const GridPoint& other) const { return x == other.x && y == other.y; }
};

/// Twice the signed area, exact.
std::int64_t area(const GridPoint& a, const GridPoint& b, const GridPoint& c) {
    return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

/// Scaled to extent 1 about corner 0, so that no product overflows.
std::vector<Vec3> scaled(std::span<const Vec3> corners) {
    double extent = 0;
    for (const Vec3& corner : corners)
        for (int k = 0; k < 3; ++k) extent = std::max(extent, std::fabs(corner[k] - corners[0][k]));
    std::vector<Vec3> result;
    for (const Vec3& corner : corners)
        result.push_back(extent > 0 ? (corner - corners[0]) / extent : Vec3(0));
    return result;
}

/// Newell's normal, not unit: twice the polygon's area along each axis. Based on: Sutherland, Sproull,
/// Schumacker, A Characterization of Ten Hidden-Surface Algorithms (1974).
Vec3 newell_normal(const std::vector<Vec3>& corners) {
    Vec3 sum(0);
    for (std::size_t k = 0; k < corners.size(); ++k)
        sum += cross(corners[k], corners[(k + 1) % corners.size()]);
    return sum;
}

std::vector<GridPoint> project(const std::vector<Vec3>& corners, const Vec3& normal) {
    const Vec3 w = normalize_or_zero(normal);
    const Vec3 axis = std::fabs(w.x) <= 0.75 ? Vec3(1, 0, 0) : Vec3(0, 1, 0);
    const Vec3 u = normalize(axis - dot(axis, w) * w), v = cross(w, u);
    Vec2 low(dot(corners[0], u), dot(corners[0], v)), high = low;
    for (const Vec3& corner : corners) {
        const Vec2 seen(dot(corner, u), dot(corner, v));
        low = glm::min(low, seen), high = glm::max(high, seen);
    }
    const Vec2 middle = 0.5 * (low + high);
    const double steps = kGrid / (0.5 * std::max(high.x - low.x, high.y - low.y));
    std::vector<GridPoint> result;
    for (const Vec3& corner : corners)
        result.push_back({std::llround((dot(corner, u) - middle.x) * steps),
                          std::llround((dot(corner, v) - middle.y) * steps)});
    return result;
}

bool fan_covers(const std::vector<GridPoint>& p) {
    for (std::size_t k = 1; k + 1 < p.size(); ++k)
        if (area(p[0], p[k], p[k + 1]) < -kFlatArea) return false;
    return true;
}

/// Whether the corner turns the polygon's way, and no other corner lies in its triangle or on its border.
bool is_ear(const std::vector<GridPoint>& p, const std::vector<std::size_t>& left, std::size_t k) {
    const GridPoint &a = p[left[(k + left.size() - 1) % left.size()]], &b = p[left[k]],
                    &c = p[left[(k + 1) % left.size()]];
    if (area(a, b, c) <= 0) return false;
    return std::none_of(left.begin(), left.end(), [&](std::size_t other) {
        const GridPoint& q = p[other];
        if (q == a || q == b || q == c) return false;
        return area(a, b, q) >= 0 && area(b, c, q) >= 0 && area(c, a, q) >= 0;
    });
}

/// Empty where it comes to an end without ears.
std::vector<std::array<std::size_t, 3>> clip_ears(const std::vector<GridPoint>& p) {
    std::vector<std::array<std::size_t, 3>> triangles;
    std::vector<std::size_t> left(p.size());
    std::iota(left.begin(), left.end(), std::size_t{0});
    while (left.size() >= 3) {
        std::size_t k = 0;
        while (k < left.size() && !is_ear(p, left, k)) ++k;
        if (k == left.size()) return {};
        triangles.push_back(
            {left[(k + left.size() - 1) % left.size()], left[k], left[(k + 1) % left.size()]});
        left.erase(left.begin() + static_cast<std::ptrdiff_t>(k));
    }
    return triangles;
}

/// Whether all corners lie on one line, so that there is nothing to cover.
bool is_flat(const std::vector<Vec3>& corners) {
    constexpr double kNoHeight = 1e-14;
    const auto farthest = std::max_element(
        corners.begin(), corners.end(), [](const Vec3& a, const Vec3& b) { return length(a) < length(b); });
    return std::all_of(corners.begin(), corners.end(),
                       [&](const Vec3& corner) { return length(cross(corner, *farthest)) <= kNoHeight; });
}

}  // namespace

PolygonTriangles triangulate_polygon(std::span<const Vec3> corners) {
    PolygonTriangles result;
    for (std::size_t k = 1; k + 1 < corners.size(); ++k) result.triangles.push_back({0, k, k + 1});
    if (corners.size() < 4) return result;

    constexpr double kNoPlane = 1e-14;  // of the extent squared
    const std::vector<Vec3> unit = scaled(corners);
    const Vec3 normal = newell_normal(unit);
    if (!(length(normal) > kNoPlane)) {
        result.covers = is_flat(unit);
        return result;
    }
    const std::vector<GridPoint> seen = project(unit, normal);
    if (fan_covers(seen)) return result;
    std::vector<std::array<std::size_t, 3>> ears = clip_ears(seen);
    result.covers = !ears.empty();
    if (result.covers) result.triangles = std::move(ears);
    return result;
}

}  // namespace trilens
