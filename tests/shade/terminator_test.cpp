// The edge of a smooth body's own shadow: where the smooth normals put it, not along the triangles.
#include <cmath>
#include <random>

#include "shade/shade.h"
#include "support/test.h"

using namespace trilens;

namespace {

constexpr double kGlobePi = 3.14159265358979323846;

/// A triangle mesh with corner normals, lit by one light whose shadow rays are answered triangle by triangle.
struct Body {
    TriangleScene triangles;
    ShadeScene shading;
};

/// Whether the segment from `from` to `to` passes through the triangle: its ends lie on different sides of
/// the plane, and its line on one side of all three edges.
bool passes_through(const Vec3& from, const Vec3& to, const std::array<Vec3, 3>& corner) {
    const Vec3 along = to - from;
    const Vec3 normal = cross(corner[1] - corner[0], corner[2] - corner[0]);
    if (dot(from - corner[0], normal) * dot(to - corner[0], normal) > 0) return false;
    const double s0 = triple(along, corner[0] - from, corner[1] - from),
                 s1 = triple(along, corner[1] - from, corner[2] - from),
                 s2 = triple(along, corner[2] - from, corner[0] - from);
    return (s0 >= 0 && s1 >= 0 && s2 >= 0) || (s0 <= 0 && s1 <= 0 && s2 <= 0);
}

std::array<Vec3, 3> corners(const TriangleScene& scene, std::size_t t) {
    const IdTriple& c = scene.triangles[t];
    return {scene.points[c[0]], scene.points[c[1]], scene.points[c[2]]};
}

/// A closed ellipsoid of `columns` x `rows` flat quadrilaterals, each two triangles, with its exact normals.
void add_ellipsoid(Body& body, const Vec3& axes, int columns, int rows) {
    TriangleScene& out = body.triangles;
    std::vector<Vec3> normals;
    for (int j = 0; j <= rows; ++j) {
        for (int i = 0; i < columns; ++i) {
            const double polar = kGlobePi * j / rows, longitude = 2 * kGlobePi * i / columns;
            const Vec3 unit(std::sin(polar) * std::cos(longitude), std::sin(polar) * std::sin(longitude),
                            std::cos(polar));
            out.points.push_back(axes * unit);
            normals.push_back(normalize(unit / axes));
        }
    }
    const auto add = [&](Id a, Id b, Id c) {
        if (length(cross(out.points[b] - out.points[a], out.points[c] - out.points[a])) < 1e-12) return;
        out.triangles.push_back({a, b, c});
        body.shading.normals.push_back({normals[a], normals[b], normals[c]});
    };
    for (int j = 0; j < rows; ++j) {
        for (int i = 0; i < columns; ++i) {
            const auto at = [&](int column, int row) {
                return static_cast<Id>(row * columns + column % columns);
            };
            add(at(i, j), at(i, j + 1), at(i + 1, j + 1));
            add(at(i, j), at(i + 1, j + 1), at(i + 1, j));
        }
    }
}

void finish(Body& body, const Light& light) {
    const std::size_t count = body.triangles.triangles.size();
    body.triangles.object.assign(count, 0);
    for (std::size_t t = 0; t < count; ++t) body.triangles.primitive.push_back(static_cast<Id>(t));
    body.shading.triangles = &body.triangles;
    body.shading.material.assign(count, 0);
    body.shading.normals.resize(count);
    body.shading.materials = {Material{}};
    body.shading.lights = {light};
    body.shading.size = 4;
    body.shading.occluded = [&body](const Segments& segments) {
        Segments::Bits hidden = 0;
        for (std::size_t i = 0; i < segments.count; ++i) {
            const auto [from, way] = segments.ray(i);
            for (std::size_t t = 0; t < body.triangles.triangles.size(); ++t)
                if (passes_through(from, from + way, corners(body.triangles, t)))
                    hidden |= Segments::Bits{1} << i;
        }
        return hidden;
    };
}

Vec3 random_unit(std::mt19937& random) {
    std::normal_distribution<double> normal;
    return normalize(Vec3(normal(random), normal(random), normal(random)));
}

Hit random_hit(std::mt19937& random, const TriangleScene& scene) {
    std::uniform_real_distribution<double> uniform(0, 1);
    double u = uniform(random), v = uniform(random);
    if (u + v > 1) u = 1 - u, v = 1 - v;
    const std::size_t t = random() % scene.triangles.size();
    return {static_cast<Id>(t), 1.0, Vec2(u, v)};
}

/// The triangle's unit normal and the interpolated one.
std::array<Vec3, 2> outward_normals(const Body& body, const Hit& hit) {
    const auto [a, b, c] = corners(body.triangles, hit.triangle);
    const auto& n = body.shading.normals[hit.triangle];
    const Vec3 smooth = normalize((1 - hit.barycentric.x - hit.barycentric.y) * n[0] +
                                  hit.barycentric.x * n[1] + hit.barycentric.y * n[2]);
    const Vec3 flat = normalize(cross(b - a, c - a));
    return {dot(flat, smooth) < 0 ? -flat : flat, smooth};
}

Light sun(const Vec3& toward) {
    Light light;
    light.kind = DirectionalLight{.direction = -toward};
    light.shadows = true;
    return light;
}

}  // namespace

TEST_CASE("a round body's own shadow begins where its smooth normals turn from the light", "[shade]") {
    // The exact body is convex: it shades itself only where it faces away, so Lambert's law on the smooth
    // normal is the whole answer, and any shadow ray that meets the triangles is an error.
    std::mt19937 random(41);
    std::uniform_real_distribution<double> stretch(std::log(0.5), std::log(2.0));
    int lit = 0, behind_triangle = 0;
    for (int trial = 0; trial < 24; ++trial) {
        const Vec3 axes = trial == 0 ? Vec3(1)
                                     : Vec3(std::exp(stretch(random)), std::exp(stretch(random)),
                                            std::exp(stretch(random)));
        const Vec3 toward = random_unit(random);
        Body body;
        add_ellipsoid(body, axes, 8 + static_cast<int>(random() % 20), 5 + static_cast<int>(random() % 10));
        finish(body, sun(toward));
        for (int k = 0; k < 2000; ++k) {
            const Hit hit = random_hit(random, body.triangles);
            const auto [flat, smooth] = outward_normals(body, hit);
            const double cosine = dot(smooth, toward);
            const double seen = shade_hit(body.shading, hit, {flat, -flat}).x;
            if (cosine <= 0) {
                CHECK(seen == 0);
                continue;
            }
            INFO("trial " << trial << ", cosine " << cosine << ", at the triangle " << dot(flat, toward));
            CHECK(seen == Approx(cosine / kGlobePi).epsilon(1e-12));
            ++lit;
            behind_triangle += dot(flat, toward) <= 0;
        }
    }
    // Points that their own triangle would darken must have been among them.
    CHECK(lit > 20000);
    CHECK(behind_triangle > 200);
}

TEST_CASE("a lifted shadow ray starts where a sphere's tangent planes say", "[shade]") {
    // On the edge between two corners of a unit sphere, at angles 0 and 2 alpha, the middle lies sin(alpha)^2
    // under either tangent plane; both corrections have equal weight, so it moves outward along the bisector
    // by sin(alpha)^2 cos(alpha).
    for (const double alpha : {0.5, 0.1, 1e-2, 1e-4}) {
        Body body;
        body.triangles.points = {Vec3(std::cos(alpha), std::sin(alpha), 0),
                                 Vec3(std::cos(alpha), -std::sin(alpha), 0), Vec3(std::cos(alpha), 0, -1)};
        body.triangles.triangles = {{0, 1, 2}};
        body.shading.normals = {{body.triangles.points[0], body.triangles.points[1], Vec3(1, 0, 0)}};
        Light light = sun(Vec3(1, 0, 0));
        finish(body, light);
        body.shading.size = 0;
        Vec3 start(0);
        body.shading.occluded = [&](const Segments& segments) -> Segments::Bits {
            start = segments.ray(0).origin;
            return 0;
        };
        shade_hit(body.shading, {0, 1.0, Vec2(0.5, 0)}, {Vec3(2, 0, 0), Vec3(-1, 0, 0)});
        const double rise = std::sin(alpha) * std::sin(alpha) * std::cos(alpha);
        CHECK(start.x - std::cos(alpha) == Approx(rise).epsilon(1e-6));
        CHECK(std::abs(start.y) < 1e-15);
        CHECK(std::abs(start.z) < 1e-15);
    }
}

TEST_CASE("a triangle without corner normals starts its shadow rays as it always did", "[shade][law]") {
    std::mt19937 random(42);
    for (int trial = 0; trial < 2000; ++trial) {
        Body body;
        for (int k = 0; k < 3; ++k) body.triangles.points.push_back(3.0 * random_unit(random));
        body.triangles.triangles = {{0, 1, 2}};
        const Vec3 toward = random_unit(random);
        finish(body, sun(toward));
        const auto [a, b, c] = corners(body.triangles, 0);
        Vec3 flat = normalize_or_zero(cross(b - a, c - a));
        const Vec3 eye = 5.0 * random_unit(random);
        const Hit hit = random_hit(random, body.triangles);
        const Ray ray{eye, position(body.triangles, hit) - eye};
        if (dot(flat, ray.direction) > 0) flat = -flat;
        int asked = 0;
        body.shading.occluded = [&](const Segments& segments) -> Segments::Bits {
            ++asked;
            CHECK(segments.ray(0).origin == position(body.triangles, hit) + 1e-5 * body.shading.size * flat);
            return false;
        };
        const double seen = shade_hit(body.shading, hit, ray).x;
        CHECK(asked == (dot(flat, toward) > 0 ? 1 : 0));
        CHECK(seen == Approx(std::max(0.0, dot(flat, toward)) / kGlobePi).epsilon(1e-12));
    }
}

TEST_CASE("a smooth body still receives the shadow of another", "[shade]") {
    std::mt19937 random(43);
    Body body;
    add_ellipsoid(body, Vec3(1), 16, 8);
    const std::size_t own = body.triangles.triangles.size();
    // A wide plate above the ball, the light over it.
    for (const Vec3& p : {Vec3(-9, -9, 1.5), Vec3(9, -9, 1.5), Vec3(0, 18, 1.5)})
        body.triangles.points.push_back(p);
    const Id first = static_cast<Id>(body.triangles.points.size() - 3);
    body.triangles.triangles.push_back({first, first + 1, first + 2});
    finish(body, sun(Vec3(0, 0, 1)));
    for (int k = 0; k < 2000; ++k) {
        Hit hit = random_hit(random, body.triangles);
        hit.triangle = static_cast<Id>(hit.triangle % own);
        const auto [flat, smooth] = outward_normals(body, hit);
        CHECK(shade_hit(body.shading, hit, {flat, -flat}) == Vec3(0));
    }
}
