// First hits against brute force, on closed meshes, on ties, on degenerate input, and over instruction sets.
#include "intersect/tracer.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <limits>
#include <memory>

#include "base/util/error.h"
#include "random_scene.h"
#include "support/test.h"

using namespace trilens;
using namespace trilens_test;

namespace {

constexpr double kEdge =
    1e-6;  // a hit nearer to an edge than this share of the triangle may go to a neighbour

using Real = long double;
struct Real3 {
    Real x, y, z;
};
Real3 real(const Vec3& v) {
    return {v.x, v.y, v.z};
}
Real3 operator-(const Real3& a, const Real3& b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
}
Real3 cross(const Real3& a, const Real3& b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
Real dot(const Real3& a, const Real3& b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

/// A hit and how far inside its triangle it lies: the smallest of the three weights.
struct BruteHit {
    Id triangle = kNone;
    Real t = std::numeric_limits<Real>::infinity();
    Real inside = 0;
};

// Moeller and Trumbore in long double; triangles that are missed by less than `slack` of their size count
// too.
BruteHit brute_triangle(const TriangleScene& scene, Id triangle, const Ray& ray, Real slack) {
    const IdTriple& c = scene.triangles[triangle];
    const Real3 a = real(scene.points[c[0]]), e1 = real(scene.points[c[1]]) - a,
                e2 = real(scene.points[c[2]]) - a;
    const Real3 d = real(ray.direction), p = cross(d, e2), s = real(ray.origin) - a, q = cross(s, e1);
    const Real det = dot(e1, p);
    if (det == 0) return {};
    const Real u = dot(s, p) / det, v = dot(d, q) / det, t = dot(e2, q) / det;
    const Real inside = std::min({u, v, 1 - u - v});
    if (inside < -slack || t < 0) return {};
    return {triangle, t, inside};
}

BruteHit brute_first(const TriangleScene& scene, const Ray& ray, Real slack) {
    BruteHit best;
    for (Id i = 0; i < scene.size(); ++i) {
        const BruteHit hit = brute_triangle(scene, i, ray, slack);
        if (hit.triangle != kNone && hit.t < best.t) best = hit;
    }
    return best;
}

// The tracer's answer must be the brute one, unless edges are so near that both are right.
void check_against_brute(const TriangleScene& scene, const Tracer& tracer, const Ray& ray, int* edge_ties) {
    const Hit hit = tracer.first_hit(ray);
    const BruteHit exact = brute_first(scene, ray, 0), generous = brute_first(scene, ray, kEdge);
    const bool clear =
        exact.triangle == generous.triangle && (exact.triangle == kNone || exact.inside > kEdge);
    if (!clear) {
        ++*edge_ties;
        return;
    }
    REQUIRE(hit.triangle == exact.triangle);
    if (hit.seen()) {
        const BruteHit same = brute_triangle(scene, hit.triangle, ray, 0);
        const Vec3 there = ray.origin + hit.t * ray.direction;
        const double size = length(there) + length(ray.origin);
        CHECK(std::fabs(hit.t - static_cast<double>(same.t)) * length(ray.direction) <= 1e-11 * size);
        CHECK(length(position(scene, hit) - there) <= 1e-9 * size);
    }
}

bool same_bits(const Hit& a, const Hit& b) {
    return a.triangle == b.triangle && (!a.seen() || (a.t == b.t && a.barycentric == b.barycentric));
}

}  // namespace

TEST_CASE("first hits are those of brute force in long double, at every scale", "[intersect][oracle][law]") {
    Random random(1);
    int edge_ties = 0, rays = 0;
    for (int trial = 0; trial < 24; ++trial) {
        const double scale = random.log_uniform(1e-4, 1e4);
        const TriangleScene scene = random_triangles(random, 150, scale);
        const Tracer tracer(scene);
        for (int i = 0; i < 400; ++i, ++rays) {
            const double reach = random.log_uniform(0.1, 100);
            const Vec3 origin = scale * reach * random.direction(), target = scale * random.in_box(1.2);
            check_against_brute(scene, tracer, {origin, random.log_uniform(1e-3, 1e3) * (target - origin)},
                                &edge_ties);
        }
    }
    INFO(edge_ties << " edge ties of " << rays);
    CHECK(edge_ties < rays / 500);
}

TEST_CASE("coherent rays over a mesh see what brute force sees", "[intersect][oracle]") {
    Random random(2);
    int edge_ties = 0;
    for (const double scale : {1e-4, 1.0, 1e4}) {
        const TriangleScene scene = sphere_of_triangles(12, scale * Vec3(0.3, -0.2, 0.1), scale);
        const Tracer tracer(scene);
        const Vec3 eye = scale * Vec3(0.4, 0.7, 3.1);
        for (int y = 0; y < 40; ++y) {
            for (int x = 0; x < 40; ++x) {
                const Vec3 through = scale * Vec3(0.06 * x - 1.1717, 0.06 * y - 1.2131, 0);
                check_against_brute(scene, tracer, {eye, through - eye}, &edge_ties);
            }
        }
    }
    CHECK(edge_ties < 20);
}

TEST_CASE("closed meshes never leak, not even through their edges and corners", "[intersect][law]") {
    Random random(3);
    for (int trial = 0; trial < 12; ++trial) {
        const double radius = random.log_uniform(1e-4, 1e4);
        const Vec3 centre = radius * random.log_uniform(1e-2, 1e4) * random.direction();
        const TriangleScene scene = sphere_of_triangles(8, centre, radius);
        const Tracer tracer(scene);
        int leaks = 0, behind = 0;
        for (int i = 0; i < 3000; ++i) {
            const Ray any{centre + 0.4 * radius * random.direction(), radius * random.direction()};
            leaks += tracer.first_hit(any).seen() ? 0 : 1;

            // Straight at a corner and at a random point of an edge: rounding puts them on either side.
            const IdTriple& corner = scene.triangles[random.below(scene.size())];
            const Vec3 a = scene.points[corner[0]], b = scene.points[corner[1]];
            const double share = i % 3 == 0 ? 0 : i % 3 == 1 ? 0.5 : random.uniform(0, 1);
            const Ray at_edge{any.origin, a + share * (b - a) - any.origin};
            const Hit hit = tracer.first_hit(at_edge);
            leaks += hit.seen() ? 0 : 1;
            behind += hit.seen() && std::fabs(hit.t - 1) > 1e-9 * (1 + length(centre) / radius) ? 1 : 0;
        }
        CHECK(leaks == 0);
        CHECK(behind == 0);
    }
}

TEST_CASE("coincident triangles show the one with the smaller object, then the smaller primitive",
          "[intersect]") {
    Random random(4);
    for (int trial = 0; trial < 200; ++trial) {
        const double scale = random.log_uniform(1e-4, 1e4);
        TriangleScene scene;
        for (int k = 0; k < 3; ++k) scene.points.push_back(scale * random.in_box(1));
        // The same triangle many times, its corners turned, its ids shuffled.
        std::array<std::array<Id, 2>, 6> ids{{{2, 0}, {1, 9}, {1, 4}, {3, 1}, {1, 7}, {2, 2}}};
        for (std::size_t i = ids.size(); i > 1; --i) std::swap(ids[i - 1], ids[random.below(i)]);
        for (std::size_t i = 0; i < ids.size(); ++i) {
            const Id turn = static_cast<Id>(random.below(3));
            IdTriple corner{turn, (turn + 1) % 3, (turn + 2) % 3};
            if (random.below(2)) std::swap(corner[0], corner[1]);
            add_triangle(scene, corner, ids[i][0], ids[i][1]);
        }
        const Tracer tracer(scene);
        const double u = random.uniform(0.1, 0.4), v = random.uniform(0.1, 0.4);
        const Vec3 at = (1 - u - v) * scene.points[0] + u * scene.points[1] + v * scene.points[2];
        const Vec3 eye = at + scale * random.log_uniform(0.1, 10) * random.direction();
        const Hit hit = tracer.first_hit({eye, at - eye});
        REQUIRE(hit.seen());
        CHECK(scene.object[hit.triangle] == 1);
        CHECK(scene.primitive[hit.triangle] == 4);
    }
}

TEST_CASE("depths that differ by more than the tie are told apart, whatever the ids", "[intersect][law]") {
    TriangleScene scene;
    for (const double z : {0.0, -1e-8, -2e-8}) {
        for (const Vec2& xy : {Vec2(-1, -1), Vec2(1, -1), Vec2(0, 1)})
            scene.points.emplace_back(xy.x, xy.y, z);
    }
    add_triangle(scene, {0, 1, 2}, 5, 5);
    add_triangle(scene, {3, 4, 5}, 1, 1);
    add_triangle(scene, {6, 7, 8}, 0, 0);
    const Tracer tracer(scene);
    CHECK(tracer.first_hit({{0.1, 0.1, 1}, {0, 0, -1}}).triangle == 0);
    CHECK(tracer.first_hit({{0.1, 0.1, 15}, {0, 0, -1}}).triangle == 1);  // 1e-8 of 15 is a tie, 2e-8 is none
    CHECK(tracer.first_hit({{0.1, 0.1, -1}, {0, 0, 1}}).triangle == 2);
}

TEST_CASE("every instruction set and every number of threads gives the same bits", "[intersect][law]") {
    Random random(5);
    const TriangleScene scene = random_triangles(random, 3000, 7.0);
    const Tracer best(scene);
    set_tracer_threads(1);
    const Tracer alone(scene);
    set_tracer_threads(0);
    const Tracer sse2(scene, "sse2");
    int seen = 0;
    for (int i = 0; i < 5000; ++i) {
        const Ray ray{random.in_box(10), random.direction()};
        const Hit hit = best.first_hit(ray);
        seen += hit.seen() ? 1 : 0;
        REQUIRE(same_bits(hit, sse2.first_hit(ray)));
        REQUIRE(same_bits(hit, alone.first_hit(ray)));
    }
    CHECK(seen > 2000);
}

TEST_CASE("neighbours that share a box are seen as if each stood alone, whoever holds the triangles",
          "[intersect]") {
    // A mesh in its own order, where neighbours follow each other, with triangles without area between them;
    // and the same in any order.
    Random random(15);
    TriangleScene in_order = sphere_of_triangles(16, Vec3(0.2, -0.1, 0.4), 2);
    for (std::size_t i = 0; i < in_order.size(); i += 5) in_order.triangles[i][1] = in_order.triangles[i][0];
    TriangleScene shuffled = in_order;
    for (std::size_t i = shuffled.size(); i > 1; --i) {
        const std::size_t k = random.below(i);
        std::swap(shuffled.triangles[i - 1], shuffled.triangles[k]);
        std::swap(shuffled.primitive[i - 1], shuffled.primitive[k]);
    }
    const Tracer own(in_order), shared(std::make_shared<const TriangleScene>(in_order)), other(shuffled);
    int seen = 0;
    for (int i = 0; i < 5000; ++i) {
        const Ray ray{random.in_box(2.5), random.direction()};
        const Hit hit = own.first_hit(ray), any_order = other.first_hit(ray);
        REQUIRE(same_bits(hit, shared.first_hit(ray)));
        REQUIRE(hit.seen() == any_order.seen());
        CHECK(own.occluded(ray, 0, 1) == other.occluded(ray, 0, 1));
        if (!hit.seen()) continue;
        ++seen;
        CHECK(in_order.primitive[hit.triangle] == shuffled.primitive[any_order.triangle]);
        CHECK(hit.t == any_order.t);
        CHECK(hit.barycentric == any_order.barycentric);
    }
    CHECK(seen > 1000);
}

TEST_CASE("t_min leaves out what is nearer and keeps what is there", "[intersect]") {
    TriangleScene scene;
    for (const double z : {-1.0, -2.0}) {
        for (const Vec2& xy : {Vec2(-1, -1), Vec2(1, -1), Vec2(0, 1)})
            scene.points.emplace_back(xy.x, xy.y, z);
    }
    add_triangle(scene, {0, 1, 2}, 0, 0);
    add_triangle(scene, {3, 4, 5}, 0, 1);
    const Tracer tracer(scene);
    const Ray ray{{0, 0, 0}, {0, 0, -0.5}};
    CHECK(tracer.first_hit(ray).t == 2);
    CHECK(tracer.first_hit(ray, 2).triangle == 0);
    CHECK(tracer.first_hit(ray, 2.0000001).triangle == 1);
    CHECK(tracer.first_hit(ray, 4).triangle == 1);
    CHECK_FALSE(tracer.first_hit(ray, 4.0000001).seen());
    CHECK(tracer.first_hit({{0, 0, -1}, {0, 0, -1}}).t == 0);

    CHECK(tracer.occluded(ray, 0, 3));
    CHECK_FALSE(tracer.occluded(ray, 0, 2));
    CHECK_FALSE(tracer.occluded(ray, 2, 4));
    CHECK(tracer.occluded(ray, 2, 4.0000001));
    CHECK_FALSE(tracer.occluded({{0, 0, 0}, {0, 0, 1}}, 0, std::numeric_limits<double>::infinity()));
}

TEST_CASE("occluded agrees with first_hit", "[intersect][oracle]") {
    Random random(6);
    const TriangleScene scene = random_triangles(random, 100, 1e-3);
    const Tracer tracer(scene);
    for (int i = 0; i < 3000; ++i) {
        const Ray ray{random.in_box(3e-3), random.direction()};
        const Hit hit = tracer.first_hit(ray);
        CHECK(tracer.occluded(ray, 0, std::numeric_limits<double>::infinity()) == hit.seen());
        if (!hit.seen()) continue;
        CHECK(tracer.occluded(ray, 0, hit.t * (1 + 1e-8)));
        CHECK_FALSE(tracer.occluded(ray, 0, hit.t * (1 - 1e-8)));
    }
}

TEST_CASE("empty scenes, triangles without area and rays that are none see nothing",
          "[intersect][bad-input]") {
    const double nan = std::numeric_limits<double>::quiet_NaN(),
                 infinity = std::numeric_limits<double>::infinity();
    CHECK_FALSE(Tracer(TriangleScene{}).first_hit({{0, 0, 0}, {0, 0, 1}}).seen());

    TriangleScene scene;
    scene.points = {{0, 0, 0}, {1, 1, 0}, {2, 2, 0}, {0.1, 0.7, 0.3}, {nan, 0, 0}, {0, infinity, 0}};
    add_triangle(scene, {0, 1, 2}, 0, 0);
    add_triangle(scene, {3, 3, 1}, 0, 1);
    add_triangle(scene, {0, 1, 4}, 0, 2);
    add_triangle(scene, {0, 5, 3}, 0, 3);
    CHECK_FALSE(Tracer(scene).first_hit({{1, 1, 1}, {0, 0, -1}}).seen());

    add_triangle(scene, {0, 1, 3}, 0, 4);
    const Tracer tracer(scene);
    const Vec3 inside = (scene.points[0] + scene.points[1] + scene.points[3]) / 3.0;
    const Ray ray{{0.2, 0.3, 5}, inside - Vec3(0.2, 0.3, 5)};
    CHECK(tracer.first_hit(ray).triangle == 4);
    CHECK_FALSE(tracer.first_hit({ray.origin, Vec3(0)}).seen());
    CHECK_FALSE(tracer.first_hit({ray.origin, Vec3(nan, 0, 1)}).seen());
    CHECK_FALSE(tracer.first_hit({Vec3(nan), ray.direction}).seen());
    CHECK_FALSE(tracer.first_hit({ray.origin, Vec3(infinity, 0, 0)}).seen());
    for (const double size : {1e-150, 1e-30, 1e30, 1e150}) {
        const Hit hit = tracer.first_hit({ray.origin, size * ray.direction});
        REQUIRE(hit.triangle == 4);
        CHECK(hit.t * size == Approx(1).epsilon(1e-12));
    }
    for (const double far : {1e2, 1e4, 1e6, 1e8}) {
        const Vec3 origin = inside + far * Vec3(0.3, -0.2, 0.9);
        CHECK(tracer.first_hit({origin, inside - origin}).triangle == 4);
    }
}

TEST_CASE("Embree's version is known, and unknown instruction sets are refused",
          "[intersect][bad-input][oracle]") {
    CHECK(tracer_library_version().rfind("Embree ", 0) == 0);
    CHECK(tracer_library_version().size() > 10);
    CHECK_THROWS_AS(Tracer(TriangleScene{}, "abacus"), UsageError);
}
