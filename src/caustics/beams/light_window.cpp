#include "caustics/beams/light_window.h"

#include <algorithm>
#include <cmath>

namespace trilens {
namespace {

/// Points of a grid lie on the surface, whose outline may run a little beyond theirs.
constexpr double kWiderWindow = 1.05;
/// The tangent of half the widest single window's angle: 60 degrees.
constexpr double kWidestWindow = 1.7320508;

std::array<Vec3, 2> across(const Vec3& axis) {
    const Vec3 u = unit_across(axis);
    return {u, cross(axis, u)};
}

/// Around the source, the sides of a cube that is turned a little, so that none of its edges, or their
/// divisions, lies along a box or a wall that is not: where a corner falls on an edge of glass, its ray slips
/// out between two faces.
std::vector<LightWindow> six_windows(const Vec3& origin) {
    constexpr double kTurn = 0.03;  // radians
    const Vec3 about = normalize(Vec3(1, 2, 3.5));
    const auto turned = [&](const Vec3& v) {  // Rodrigues' formula
        return std::cos(kTurn) * v + std::sin(kTurn) * cross(about, v) +
               (1 - std::cos(kTurn)) * dot(about, v) * about;
    };
    std::vector<LightWindow> windows;
    for (int k = 0; k < 3; ++k)
        for (const double side : {-1.0, 1.0}) {
            Vec3 axis(0), u(0), v(0);
            axis[k] = side, u[(k + 1) % 3] = 1, v[(k + 2) % 3] = 1;
            windows.push_back({false, origin, turned(axis), turned(u), turned(v)});
        }
    return windows;
}

LightWindow parallel_window(const Vec3& axis, std::span<const Vec3> points, double scene_size) {
    const auto [u, v] = across(axis);
    double low[3], high[3];
    std::fill_n(low, 3, INFINITY), std::fill_n(high, 3, -INFINITY);
    for (const Vec3& point : points) {
        const double at[3] = {dot(point, u), dot(point, v), dot(point, axis)};
        for (int k = 0; k < 3; ++k) low[k] = std::min(low[k], at[k]), high[k] = std::max(high[k], at[k]);
    }
    LightWindow window{true, {}, axis, {}, {}};
    window.origin =
        0.5 * (low[0] + high[0]) * u + 0.5 * (low[1] + high[1]) * v + (low[2] - scene_size) * axis;
    window.across_u = kWiderWindow * 0.5 * (high[0] - low[0]) * u;
    window.across_v = kWiderWindow * 0.5 * (high[1] - low[1]) * v;
    return window;
}

}  // namespace

Ray LightWindow::ray(const Vec2& place) const {
    const Vec3 off = place.x * across_u + place.y * across_v;
    if (is_parallel) return {origin + off, axis};
    return {origin, normalize(axis + off)};
}

double LightWindow::measure(const Vec2& a, const Vec2& b, const Vec2& c) const {
    const Vec2 ab = b - a, ac = c - a;
    if (is_parallel) return 0.5 * std::fabs(cross(ab, ac)) * length(cross(across_u, across_v));
    // Van Oosterom and Strackee, The Solid Angle of a Plane Triangle, 1983; the directions' triple product by
    // differences of places, so that small triangles keep their digits.
    const Vec3 x = axis + a.x * across_u + a.y * across_v, y = axis + b.x * across_u + b.y * across_v,
               z = axis + c.x * across_u + c.y * across_v;
    const double volume =
        std::fabs(triple(x, ab.x * across_u + ab.y * across_v, ac.x * across_u + ac.y * across_v));
    const double lx = length(x), ly = length(y), lz = length(z);
    return 2 * std::atan2(volume, lx * ly * lz + dot(x, y) * lz + dot(y, z) * lx + dot(z, x) * ly);
}

double LightWindow::density(const Vec2& place) const {
    if (is_parallel) return length(cross(across_u, across_v));
    const Vec3 at = axis + place.x * across_u + place.y * across_v;
    const double far = length(at);
    return std::fabs(triple(at, across_u, across_v)) / (far * far * far);
}

std::vector<LightWindow> windows_on(const BeamSource& source, std::span<const Vec3> points,
                                    double scene_size) {
    if (source.is_parallel) return {parallel_window(source.direction, points, scene_size)};
    Vec3 low(INFINITY), high(-INFINITY);
    for (const Vec3& point : points) low = glm::min(low, point), high = glm::max(high, point);
    const Vec3 axis = normalize_or_zero(0.5 * (low + high) - source.position);
    if (axis == Vec3(0)) return six_windows(source.position);
    const auto [u, v] = across(axis);
    Vec2 least(INFINITY), most(-INFINITY);
    for (const Vec3& point : points) {
        const Vec3 way = point - source.position;
        const double depth = dot(way, axis);
        if (!(depth > 0)) return six_windows(source.position);
        const Vec2 at(dot(way, u) / depth, dot(way, v) / depth);
        least = glm::min(least, at), most = glm::max(most, at);
    }
    if (std::max({-least.x, -least.y, most.x, most.y}) > kWidestWindow) return six_windows(source.position);
    const Vec2 middle = 0.5 * (least + most), half = kWiderWindow * 0.5 * (most - least);
    LightWindow window{false, source.position, axis + middle.x * u + middle.y * v, half.x * u, half.y * v};
    return {window};
}

}  // namespace trilens
