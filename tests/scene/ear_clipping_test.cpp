// Polygons as triangles: fans where they cover, ears elsewhere, against a count of borders crossed.
#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <set>

#include "scene/data/polygons.h"
#include "scene_text.h"

using namespace trilens;
using namespace trilens_test;

namespace {

using Polygon = std::vector<Vec2>;
using Triangles = std::vector<std::array<std::size_t, 3>>;

constexpr double kPi = 3.14159265358979323846;

/// Where the plane of a polygon lies in space.
struct Plane {
    Vec3 origin{0}, u{1, 0, 0}, v{0, 1, 0};
};

std::vector<Vec3> in_space(const Polygon& polygon, const Plane& plane) {
    std::vector<Vec3> corners;
    for (const Vec2& p : polygon) corners.push_back(plane.origin + p.x * plane.u + p.y * plane.v);
    return corners;
}

Plane random_plane(std::mt19937& random) {
    std::normal_distribution<double> normal;
    std::uniform_real_distribution<double> exponent(-12, 12);
    const auto vec = [&] { return Vec3(normal(random), normal(random), normal(random)); };
    const double scale = std::pow(10, exponent(random));
    const Vec3 u = normalize(vec()), w = normalize(cross(u, vec()));
    return {scale * vec(), scale * u, scale * cross(w, u)};
}

double cross_2(const Vec2& a, const Vec2& b) {
    return a.x * b.y - a.y * b.x;
}

double area_of(const Polygon& p) {
    double sum = 0;
    for (std::size_t k = 0; k < p.size(); ++k) sum += cross_2(p[k], p[(k + 1) % p.size()]);
    return sum / 2;
}

double triangle_area(const Polygon& p, const std::array<std::size_t, 3>& t) {
    return cross_2(p[t[1]] - p[t[0]], p[t[2]] - p[t[0]]) / 2;
}

bool inside_polygon(const Polygon& p, const Vec2& q) {
    bool inside = false;
    for (std::size_t k = 0; k < p.size(); ++k) {
        const Vec2 &a = p[k], &b = p[(k + 1) % p.size()];
        if ((a.y > q.y) != (b.y > q.y) && q.x < a.x + (q.y - a.y) / (b.y - a.y) * (b.x - a.x))
            inside = !inside;
    }
    return inside;
}

bool inside_triangle(const Polygon& p, const std::array<std::size_t, 3>& t, const Vec2& q) {
    for (std::size_t k = 0; k < 3; ++k)
        if (cross_2(p[t[(k + 1) % 3]] - p[t[k]], q - p[t[k]]) < 0) return false;
    return true;
}

/// Distance to the nearest of the lines that any two corners of triangles or polygon border on.
double distance_to_edges(const Polygon& p, const Triangles& triangles, const Vec2& q) {
    double nearest = std::numeric_limits<double>::infinity();
    const auto look = [&](const Vec2& a, const Vec2& b) {
        const Vec2 ab = b - a;
        const double share = dot(ab, ab) > 0 ? std::clamp(dot(q - a, ab) / dot(ab, ab), 0.0, 1.0) : 0;
        nearest = std::min(nearest, length(q - (a + share * ab)));
    };
    for (std::size_t k = 0; k < p.size(); ++k) look(p[k], p[(k + 1) % p.size()]);
    for (const auto& t : triangles)
        for (std::size_t k = 0; k < 3; ++k) look(p[t[k]], p[t[(k + 1) % 3]]);
    return nearest;
}

Triangles fan(std::size_t corners) {
    Triangles triangles;
    for (std::size_t k = 1; k + 1 < corners; ++k) triangles.push_back({0, k, k + 1});
    return triangles;
}

/// The law of a cut of a simple polygon (counter-clockwise, of size about 1).
void check_cut(const Polygon& polygon, const Triangles& triangles, std::mt19937& random) {
    REQUIRE(triangles.size() == polygon.size() - 2);
    double sum = 0;
    for (const auto& t : triangles) {
        REQUIRE(triangle_area(polygon, t) > -1e-8);
        sum += std::abs(triangle_area(polygon, t));
    }
    CHECK(sum == Approx(area_of(polygon)).epsilon(1e-7));

    std::uniform_real_distribution<double> coordinate(-1.2, 1.2);
    int wrong = 0, asked = 0;
    for (int i = 0; i < 200; ++i) {
        const Vec2 q(coordinate(random), coordinate(random));
        if (distance_to_edges(polygon, triangles, q) < 1e-6) continue;
        const auto covered = std::count_if(triangles.begin(), triangles.end(),
                                           [&](const auto& t) { return inside_triangle(polygon, t, q); });
        wrong += covered == (inside_polygon(polygon, q) ? 1 : 0) ? 0 : 1;
        ++asked;
    }
    CHECK(wrong == 0);
    CHECK(asked > 100);
}

Polygon random_star(std::mt19937& random) {
    std::uniform_real_distribution<double> radius(0.1, 1), jitter(0.05, 0.95);
    const std::size_t corners = 4 + random() % 60;
    Polygon polygon;
    for (std::size_t k = 0; k < corners; ++k) {
        const double angle =
            2 * kPi * (static_cast<double>(k) + jitter(random)) / static_cast<double>(corners);
        polygon.push_back(radius(random) * Vec2(std::cos(angle), std::sin(angle)));
    }
    return polygon;
}

/// Teeth of random lengths up from a thin back, then the corners begin anywhere.
Polygon random_comb(std::mt19937& random) {
    std::uniform_real_distribution<double> tip(-0.7, 1);
    const int teeth = 2 + static_cast<int>(random() % 30);
    Polygon polygon = {{-1, -1}, {1, -1}};
    for (int k = 0; k < teeth; ++k) {
        const double right = 1 - 2.0 * k / teeth, left = 1 - (2.0 * k + 1) / teeth;
        polygon.emplace_back(right, tip(random));
        polygon.emplace_back(left, -0.9);
    }
    polygon.emplace_back(-1, 0.5);
    std::rotate(polygon.begin(), polygon.begin() + static_cast<std::ptrdiff_t>(random() % polygon.size()),
                polygon.end());
    return polygon;
}

/// A spiral arm: nothing like a star from any of its points.
Polygon random_spiral(std::mt19937& random) {
    const int steps = 10 + static_cast<int>(random() % 50);
    const double turns = 1 + static_cast<double>(random() % 3);
    Polygon outer, inner;
    for (int k = 0; k <= steps; ++k) {
        const double angle = 2 * kPi * turns * k / steps, radius = 1 - 0.9 * k / steps;
        const double width = 0.3 * 0.9 / turns;
        outer.push_back(radius * Vec2(std::cos(angle), std::sin(angle)));
        inner.push_back((radius - width * (1 - 0.9 * k / steps)) * Vec2(std::cos(angle), std::sin(angle)));
    }
    Polygon polygon(outer.begin(), outer.end());
    polygon.insert(polygon.end(), inner.rbegin(), inner.rend());
    std::rotate(polygon.begin(), polygon.begin() + static_cast<std::ptrdiff_t>(random() % polygon.size()),
                polygon.end());
    return polygon;
}

}  // namespace

TEST_CASE("law: concave polygons are covered once and nothing beside them", "[scene][law]") {
    std::mt19937 random(40);
    std::size_t not_fans = 0, tried = 0;
    for (const auto& make : {random_star, random_comb, random_spiral}) {
        for (int round = 0; round < 150; ++round) {
            Polygon polygon = make(random);
            REQUIRE(area_of(polygon) > 0);
            const PolygonTriangles cut = triangulate_polygon(in_space(polygon, random_plane(random)));
            REQUIRE(cut.covers);
            check_cut(polygon, cut.triangles, random);
            not_fans += cut.triangles != fan(polygon.size()) ? 1 : 0;
            ++tried;
        }
    }
    CHECK(not_fans > tried * 9 / 10);
}

TEST_CASE("law: convex polygons stay the fan from their first corner", "[scene][law]") {
    std::mt19937 random(41);
    std::uniform_real_distribution<double> share(0, 1);
    for (int round = 0; round < 3000; ++round) {
        // Points of an ellipse as thin as 1e-6; some corners lie on the line between their neighbours, some
        // twice at one place.
        std::set<double> angles;
        for (unsigned k = 3 + random() % 40; k > 0; --k) angles.insert(2 * kPi * share(random));
        const double thin = std::pow(10, -6 * share(random));
        Polygon polygon;
        for (const double angle : angles) polygon.emplace_back(std::cos(angle), thin * std::sin(angle));
        for (unsigned k = random() % 4; k > 0; --k) {
            const std::size_t at = random() % polygon.size();
            const Vec2 a = polygon[at], b = polygon[(at + 1) % polygon.size()];
            polygon.insert(polygon.begin() + static_cast<std::ptrdiff_t>(at) + 1,
                           a + (random() % 2 == 0 ? 0.0 : share(random)) * (b - a));
        }
        const PolygonTriangles cut = triangulate_polygon(in_space(polygon, random_plane(random)));
        REQUIRE(cut.covers);
        REQUIRE(cut.triangles == fan(polygon.size()));
    }
}

TEST_CASE("a dart is cut at its reflex corner, wherever it begins", "[scene]") {
    const Polygon dart = {{0, 1}, {-1, -1}, {0, -0.5}, {1, -1}};
    for (std::size_t first = 0; first < 4; ++first) {
        Polygon turned = dart;
        std::rotate(turned.begin(), turned.begin() + static_cast<std::ptrdiff_t>(first), turned.end());
        const PolygonTriangles cut = triangulate_polygon(in_space(turned, {}));
        CHECK(cut.covers);
        const std::size_t reflex = (6 - first) % 4;
        for (const auto& t : cut.triangles) {
            CHECK(triangle_area(turned, t) > 0);
            CHECK(std::count(t.begin(), t.end(), reflex) == 1);
        }
        // Where the fan covers (it begins at the notch or opposite to it), the fan it is.
        CHECK((cut.triangles == fan(4)) == (first % 2 == 0));
    }
}

TEST_CASE("a square with a hole, joined by a bridge that is walked twice", "[scene]") {
    std::mt19937 random(42);
    const Polygon keyhole = {{-1, -1},     {1, -1},     {1, 1},     {-1, 1},     {-1, -1},
                             {-0.5, -0.5}, {-0.5, 0.5}, {0.5, 0.5}, {0.5, -0.5}, {-0.5, -0.5}};
    const PolygonTriangles cut = triangulate_polygon(in_space(keyhole, random_plane(random)));
    REQUIRE(cut.covers);
    check_cut(keyhole, cut.triangles, random);
}

TEST_CASE("a bent quad is cut along the diagonal that its outline allows", "[scene]") {
    // Seen from above a dart with its notch at corner 1; the notch stands high above the rest.
    const std::vector<Vec3> corners = {{0, 1, 0}, {0, -0.5, 3}, {1, -1, 0}, {-1, -1, 0}};
    std::vector<Vec3> turned = {corners[3], corners[0], corners[1], corners[2]};
    const PolygonTriangles cut = triangulate_polygon(turned);
    CHECK(cut.triangles.size() == 2);
    for (const auto& [a, b, c] : cut.triangles)
        CHECK((a == 2 || b == 2 || c == 2));  // the notch is a corner of both
}

TEST_CASE("polygons that no triangles cover are fans and counted", "[scene]") {
    const auto covers = [](const std::vector<Vec3>& corners) {
        const PolygonTriangles cut = triangulate_polygon(corners);
        CHECK(cut.triangles == fan(corners.size()));
        return cut.covers;
    };
    CHECK_FALSE(covers({{0, 0, 0}, {1, 1, 0}, {1, 0, 0}, {0, 1, 0}}));  // a bow tie without a plane
    CHECK_FALSE(covers({{0, 0, 0}, {3, 3, 0}, {3, 0, 0}, {0, 2, 0}}));  // and one with
    CHECK(covers({{0, 0, 0}, {1, 1, 1}, {2, 2, 2}, {0.5, 0.5, 0.5}}));  // nothing to cover
    CHECK(covers({{1, 2, 3}, {1, 2, 3}, {1, 2, 3}, {1, 2, 3}}));
    CHECK(covers({{-1e30, -1e30, 0}, {1e30, -1e30, 0}, {1e30, 1e30, 0}, {-1e30, 1e30, 0}}));
    CHECK(covers({{0, 0, 0}, {5e-324, 0, 0}, {5e-324, 5e-324, 0}, {0, 5e-324, 0}}));
}

TEST_CASE("a mesh counts n - 2 triangles per polygon in face order, whatever their shape", "[scene][law]") {
    const std::string mesh = R"({"name":"thing","role":"object","material":"red",
        "points":[[0,1,0],[-1,-1,0],[0,-0.5,0],[1,-1,0],[5,0,0],[6,0,0],[5,1,0]],"faceVertexCounts":[4,3,4],
        "faceVertexIndices":[1,2,3,0,4,5,6,4,6,5,4]})";
    const Scene scene = load_text(kRoom, {{"/meshes/2", mesh}});
    CHECK(scene.meshes[2].object.triangles ==
          std::vector<IdTriple>{{0, 1, 2}, {0, 2, 3}, {4, 5, 6}, {4, 6, 5}, {4, 5, 4}});
    const std::string crossed = R"({"name":"thing","role":"object","material":"red",
        "points":[[0,0,0],[3,3,0],[3,0,0],[0,2,0]],"faceVertexCounts":[4],"faceVertexIndices":[0,1,2,3]})";
    const Scene bow_tie = load_text(kRoom, {{"/meshes/2", crossed}});
    CHECK(
        std::count(bow_tie.warnings.begin(), bow_tie.warnings.end(),
                   "room.json: /meshes/2: 1 faces cross themselves: they are drawn as fans from their first "
                   "corners") == 1);
}
