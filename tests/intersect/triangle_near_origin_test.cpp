// The rejection by edges' lines against the distance itself, in long double, of any triangle.
#include "intersect/tracer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <vector>

#include "support/test.h"

using namespace trilens;

namespace {

using Long = long double;

/// The distance of the origin from an edge, without the code under test.
Long distance_from_edge(const Vec2& from, const Vec2& to) {
    const Long ax = from.x, ay = from.y, ex = Long(to.x) - ax, ey = Long(to.y) - ay;
    const Long size = ex * ex + ey * ey;
    const Long share = size > 0 ? std::clamp(-(ax * ex + ay * ey) / size, Long(0), Long(1)) : Long(0);
    return std::hypot(ax + share * ex, ay + share * ey);
}

Long area(const Vec2& a, const Vec2& b) {
    return Long(a.x) * b.y - Long(a.y) * b.x;
}

Long distance_from_triangle(const PlaneTriangle& p) {
    const Long one = area(p[0], p[1]), two = area(p[1], p[2]), three = area(p[2], p[0]);
    if ((one > 0 && two > 0 && three > 0) || (one < 0 && two < 0 && three < 0)) return 0;
    return std::min(
        {distance_from_edge(p[0], p[1]), distance_from_edge(p[1], p[2]), distance_from_edge(p[2], p[0])});
}

/// Triangles of every kind: fat, slivers, on a line, in a point, far away, around the origin or with it on an
/// edge or a corner.
std::vector<PlaneTriangle> triangles() {
    std::mt19937 random(41);
    std::uniform_real_distribution<double> anywhere(-1, 1), exponent(-12, 3);
    const auto place = [&](double size) { return Vec2(anywhere(random), anywhere(random)) * size; };
    std::vector<PlaneTriangle> made;
    for (int i = 0; i < 20'000; ++i) {
        const double size = std::pow(10, exponent(random)), thin = std::pow(10, exponent(random));
        const Vec2 at = place(1), along = place(size), across = place(size * thin);
        made.push_back({at, at + along, at + across});
        made.push_back({at, at + along, at + anywhere(random) * along + across});
        made.push_back({at, at + along, at + anywhere(random) * along});
        made.push_back({at, at, at + along});
        made.push_back({at, at, at});
        made.push_back({place(size), place(size), place(size)});
        made.push_back({along, -anywhere(random) * along, across});
        made.push_back({Vec2(0), along, across});
        made.push_back({1e8 * at, 1e8 * at + along, 1e8 * at + across});
    }
    return made;
}

}  // namespace

TEST_CASE("no triangle is rejected that comes as near to the origin as is asked", "[intersect][law]") {
    constexpr std::array<double, 6> shares{1, 1 + 1e-12, 1 + 1e-6, 1.01, 2, 100};
    for (const PlaneTriangle& triangle : triangles()) {
        const Long exact = distance_from_triangle(triangle);
        for (const double share : shares) {
            // A double that is not below the exact distance.
            const double asked = std::nextafter(static_cast<double>(exact) * share, 1e300);
            const bool is_rejected = is_surely_beyond(triangle, asked);
            const PlaneTriangle turned{triangle[0], triangle[2], triangle[1]};
            REQUIRE_FALSE((is_rejected || is_surely_beyond(turned, asked)));
        }
    }
}

TEST_CASE("what is rejected is what the nearest point would reject", "[intersect]") {
    std::size_t rejected = 0, beyond = 0;
    std::mt19937 random(43);
    std::uniform_real_distribution<double> anywhere(0, 2);
    for (const PlaneTriangle& triangle : triangles()) {
        const double distance = nearest_to_origin(triangle).distance;
        const double asked = anywhere(random) * distance;
        const bool is_beyond = !(distance <= asked);
        beyond += is_beyond;
        rejected += is_surely_beyond(triangle, asked);
        const bool is_safe = is_beyond || !is_surely_beyond(triangle, asked);
        REQUIRE(is_safe);
    }
    CHECK(4 * rejected > beyond);  // it is worth its while
}

TEST_CASE("triangles clearly away from the origin are rejected by an edge", "[intersect]") {
    const PlaneTriangle away{Vec2(1, -1), Vec2(2, 0), Vec2(1, 1)};
    CHECK(is_surely_beyond(away, 0.4));
    CHECK_FALSE(is_surely_beyond(away, 1));
    const PlaneTriangle around{Vec2(-1, -1), Vec2(1, -1), Vec2(0, 2)};
    CHECK_FALSE(is_surely_beyond(around, 0));
    CHECK(nearest_to_origin(around).distance == 0);
    CHECK(nearest_to_origin(away).distance == 1);
}
