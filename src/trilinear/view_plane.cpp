// Which stretches of t a facet sees of a scene triangle.
#include "trilinear/view_plane.h"

#include <algorithm>
#include <cmath>

#include "base/math/roots.h"

namespace trilens {
namespace {

// Where the facet's rays turn back or run very far apart, t is followed up to this many times the distance to
// the triangle in units of the longest direction.
constexpr double kFarthestView = 1e6;

// Where the rays start from one point or line, t is followed from this share of that distance on.
constexpr double kNearestView = 1e-9;

// No ray with weights in [0, 1] meets the triangle after the window's end; its begin is near, but not zero.
Window reach_of(const Coplanarity& facet, const SceneTriangle& triangle) {
    const Vec3 o[3] = {facet.origin, facet.origin + facet.e1, facet.origin + facet.e2};
    const Vec3 d[3] = {facet.direction, facet.direction + facet.f1, facet.direction + facet.f2};
    double reach = 0, longest = 0;
    Vec3 axis(0);
    for (int k = 0; k < 3; ++k) {
        for (const Vec3& corner : triangle.corner) reach = std::max(reach, length(corner - o[k]));
        longest = std::max(longest, length(d[k]));
        axis += normalize_or_zero(d[k]);
    }
    if (longest == 0 || reach == 0) return {0, 0};

    // Along an axis that all directions share, every ray advances at least this much per t.
    axis = normalize_or_zero(axis);
    const double advance = std::min({dot(d[0], axis), dot(d[1], axis), dot(d[2], axis)});
    const double unit = reach / longest;
    const double farthest =
        advance > 0 ? std::min(reach / advance, kFarthestView * unit) : kFarthestView * unit;
    return {kNearestView * unit, farthest * (1 + kCollapseGap)};
}

}  // namespace

std::vector<Window> view_windows(const Coplanarity& facet, const SceneTriangle& triangle) {
    const auto [near, end] = reach_of(facet, triangle);
    if (!(end > 0)) return {};

    // Where the normal vanishes, so does its component along any of its own coefficients: a quadratic. Two
    // such roots that rounding keeps apart or makes complex lie about the quadratic's extremum.
    const Vec3 &n0 = facet.n0, &n1 = facet.n1, &n2 = facet.n2;
    const Vec3 along = length(n0) > 0 ? n0 : length(n1) > 0 ? n1 : n2;
    if (length(along) == 0) return {};
    const std::array<double, 3> q{dot(along, n0), dot(along, n1), dot(along, n2)};
    std::vector<double> candidates;
    if (q[2] != 0) candidates.push_back(-q[1] / q[2] / 2);
    for (const double t : real_roots({q[0], q[1], q[2], 0})) candidates.push_back(t);
    std::stable_sort(candidates.begin(), candidates.end());

    std::vector<Window> windows{Window{0, end}};
    const auto collapsed = [&](double t) {
        const double parts = length(n0) + t * (length(n1) + t * length(n2));
        return !(length(n0 + t * (n1 + t * n2)) > kCollapsed * parts);
    };
    if (collapsed(0)) windows[0].begin = near;
    for (const double t : candidates) {
        if (!(t > windows.back().begin && t < end) || !collapsed(t)) continue;
        windows.back().end = std::max(windows.back().begin, t * (1 - kCollapseGap));
        windows.push_back({t * (1 + kCollapseGap), end});
    }
    return windows;
}

}  // namespace trilens
