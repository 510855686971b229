// Spline patches: exact conversions, derivatives, blends, and the polygons of objects.
#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "scene/data/patches.h"
#include "scene/info.h"
#include "scene/patch_scene_text.h"
#include "scene/scene_text.h"
#include "support/bezier_patch.h"
#include "support/draw.h"
#include "support/test.h"

using namespace trilens;
using namespace trilens_test;

namespace {

/// De Casteljau's construction.
Vec3 on_curve(BezierCurve points, double t) {
    for (std::size_t left = 3; left > 0; --left)
        for (std::size_t k = 0; k < left; ++k) points[k] = (1 - t) * points[k] + t * points[k + 1];
    return points[0];
}

Vec3 on_patch(const BezierPatch& p, const Vec2& uv) {
    BezierCurve column;
    for (std::size_t j = 0; j < 4; ++j)
        column[j] = on_curve({p[4 * j], p[4 * j + 1], p[4 * j + 2], p[4 * j + 3]}, uv.x);
    return on_curve(column, uv.y);
}

/// The B-spline of a degree at t, by the recursion of Cox and de Boor; the last knots close their interval.
double basis(const std::vector<double>& knots, std::size_t i, int degree, double t) {
    if (degree == 0) return knots[i] <= t && t < knots[i + 1] ? 1 : 0;
    const auto p = static_cast<std::size_t>(degree);
    double sum = 0;
    if (const double wide = knots[i + p] - knots[i]; wide > 0)
        sum += (t - knots[i]) / wide * basis(knots, i, degree - 1, t);
    if (const double wide = knots[i + p + 1] - knots[i + 1]; wide > 0)
        sum += (knots[i + p + 1] - t) / wide * basis(knots, i + 1, degree - 1, t);
    return sum;
}

Vec3 on_nurbs(const SplineGrid& grid, double s, double t) {
    Vec3 sum(0);
    double weights = 0;
    for (std::size_t k = 0; k < grid.points.size(); ++k) {
        const auto columns = static_cast<std::size_t>(grid.columns);
        const double b = grid.weights[k] * basis(grid.knots[0], k % columns, grid.degree[0], s) *
                         basis(grid.knots[1], k / columns, grid.degree[1], t);
        sum += b * grid.points[k];
        weights += b;
    }
    return sum / weights;
}

/// The steps between knots that have a length, within the surface.
std::vector<std::array<double, 2>> steps_of(const std::vector<double>& knots, int degree) {
    std::vector<std::array<double, 2>> steps;
    const auto p = static_cast<std::size_t>(degree);
    for (std::size_t k = p; k + p + 1 < knots.size(); ++k)
        if (knots[k] < knots[k + 1]) steps.push_back({knots[k], knots[k + 1]});
    return steps;
}

constexpr std::array<Vec2, 5> kPlaces{Vec2(0, 0), Vec2(1, 0.25), Vec2(0.3, 0.7), Vec2(0.5, 0.5),
                                      Vec2(0.9, 1)};

}  // namespace

TEST_CASE("a Bezier patch is where de Casteljau's construction finds it", "[scene][patches]") {
    const BezierPatch patch = random_patch(1, 0.4, 1);
    for (const Vec2& uv : kPlaces) CHECK(length(on_first(patch, uv).position - on_patch(patch, uv)) < 1e-13);
}

TEST_CASE("derivatives and normals of a patch are those of small steps", "[scene][patches]") {
    const BezierPatch cubic = random_patch(2, 0.4, 1);
    RationalPatch patch = beziers_of(spline_of(cubic)).at(0);
    Draw draw(21);
    for (Vec4& point : patch.points) point *= draw.uniform(0.9, 1.1);
    const double h = 1e-4;
    const auto at = [&](double u, double v) { return on_first(patch, Vec2(u, v)).position; };
    for (const Vec2& uv : kPlaces) {
        const double u = uv.x, v = uv.y;
        const SurfacePoint p = on_first(patch, uv);
        const Vec3 du = (at(u + h, v) - at(u - h, v)) / (2 * h), dv = (at(u, v + h) - at(u, v - h)) / (2 * h);
        CHECK(length(p.du - du) < 1e-6);
        CHECK(length(p.dv - dv) < 1e-6);
        CHECK(length(p.duu - (at(u + h, v) - 2. * at(u, v) + at(u - h, v)) / (h * h)) < 1e-5);
        CHECK(length(p.dvv - (at(u, v + h) - 2. * at(u, v) + at(u, v - h)) / (h * h)) < 1e-5);
        CHECK(length(p.duv - (at(u + h, v + h) - at(u - h, v + h) - at(u + h, v - h) + at(u - h, v - h)) /
                                 (4 * h * h)) < 1e-5);
        CHECK(length(p.normal - normalize(cross(du, dv))) < 1e-6);
    }
}

TEST_CASE("NURBS of any degree and knots are where the recursion of Cox and de Boor has them",
          "[scene][patches][law]") {
    const std::array<std::array<int, 4>, 5> shapes{
        {{3, 3, 7, 6}, {2, 1, 5, 3}, {5, 2, 9, 4}, {1, 4, 2, 7}, {9, 3, 12, 5}}};
    for (std::size_t shape = 0; shape < shapes.size(); ++shape) {
        const auto& [p, q, columns, rows] = shapes[shape];
        const SplineGrid grid = random_nurbs(30 + shape, {p, q}, {columns, rows});
        REQUIRE(knot_fault(grid.knots[0], p, columns).empty());
        const std::vector<RationalPatch> patches = beziers_of(grid);
        const auto along_u = steps_of(grid.knots[0], p), along_v = steps_of(grid.knots[1], q);
        REQUIRE(patches.size() == along_u.size() * along_v.size());
        double worst = 0;
        for (std::size_t k = 0; k < patches.size(); ++k) {
            const auto& [s0, s1] = along_u[k % along_u.size()];
            const auto& [t0, t1] = along_v[k / along_u.size()];
            for (const Vec2& uv : kPlaces) {
                if (uv.x == 1 || uv.y == 1) continue;
                const Vec3 there = on_nurbs(grid, s0 + uv.x * (s1 - s0), t0 + uv.y * (t1 - t0));
                worst = std::max(worst, length(on_first(patches[k], uv).position - there));
            }
        }
        CAPTURE(p, q);
        CHECK(worst < 1e-12);
    }
}

TEST_CASE("a NURBS surface turned around is the same one from its other end", "[scene][patches]") {
    SplineGrid grid = random_nurbs(40, {3, 2}, {6, 4});
    const std::vector<RationalPatch> one = beziers_of(grid);
    turn_around(grid);
    const std::vector<RationalPatch> other = beziers_of(grid);
    const std::size_t row = steps_of(grid.knots[0], 3).size();
    REQUIRE(one.size() == other.size());
    for (std::size_t k = 0; k < one.size(); ++k) {
        const SurfacePoint a = on_first(one[k], {0.3, 0.6}),
                           b = on_first(other[k / row * row + row - 1 - k % row], {0.7, 0.6});
        CHECK(length(a.position - b.position) < 1e-13);
        CHECK(length(a.normal + b.normal) < 1e-12);
    }
}

TEST_CASE("Bezier patches and B-splines are NURBS with knots of their own", "[scene][patches]") {
    const BezierPatch patch = random_patch(3, 0.4, 1);
    const std::vector<RationalPatch> back = beziers_of(spline_of(patch));
    REQUIRE(back.size() == 1);
    for (std::size_t k = 0; k < 16; ++k) CHECK(length(back[0].control(k) - patch[k]) < 1e-15);

    // Patches of one B-spline meet with equal derivatives up to the second.
    Draw draw(4);
    std::vector<Vec3> points;
    for (int k = 0; k < 30; ++k) points.emplace_back(k % 6, k / 6, draw.uniform(-1, 1));
    const std::vector<RationalPatch> patches = beziers_of(uniform_spline(6, points));
    REQUIRE(patches.size() == 3 * 2);
    for (const double v : {0.0, 0.3, 1.0}) {
        const SurfacePoint a = on_first(patches[1], Vec2(1, v)), b = on_first(patches[2], Vec2(0, v));
        CHECK(length(a.position - b.position) < 1e-13);
        CHECK(length(a.du - b.du) < 1e-13);
        CHECK(length(a.duu - b.duu) < 1e-12);
    }
    // The uniform cubic B-spline's value at a knot.
    const Vec3 corner = on_first(patches[0], Vec2(0, 0)).position;
    Vec3 mean(0);
    for (int j = 0; j < 3; ++j)
        for (int i = 0; i < 3; ++i)
            mean +=
                (i == 1 ? 4. : 1.) * (j == 1 ? 4. : 1.) / 36 * points[static_cast<std::size_t>(6 * j + i)];
    CHECK(length(corner - mean) < 1e-14);
}

TEST_CASE("a Coons patch is the blend of its four curves everywhere", "[scene][patches]") {
    Draw draw(5);
    const auto between = [&](const Vec3& a, const Vec3& b) {
        BezierCurve curve{a, a + (b - a) / 3., a + 2. * (b - a) / 3., b};
        for (const std::size_t k : {1u, 2u})
            curve[k] += Vec3(draw.uniform(-1, 1), draw.uniform(-1, 1), draw.uniform(-1, 1));
        return curve;
    };
    const Vec3 p00(0, 0, 0.3), p10(3, 0, -0.2), p01(0, 2, 0.1), p11(3.5, 2, 0.9);
    const std::array<BezierCurve, 4> curves{between(p00, p10), between(p01, p11), between(p00, p01),
                                            between(p10, p11)};
    const BezierPatch patch = coons_patch(curves);
    for (int j = 0; j <= 8; ++j)
        for (int i = 0; i <= 8; ++i) {
            const double u = i / 8., v = j / 8.;
            const Vec3 bilinear = (1 - v) * ((1 - u) * p00 + u * p10) + v * ((1 - u) * p01 + u * p11);
            const Vec3 blend = (1 - v) * on_curve(curves[0], u) + v * on_curve(curves[1], u) +
                               (1 - u) * on_curve(curves[2], v) + u * on_curve(curves[3], v) - bilinear;
            REQUIRE(length(on_patch(patch, Vec2(u, v)) - blend) < 1e-13);
        }
}

TEST_CASE("objects of patches are polygons with the patch's normals", "[scene][patches]") {
    BezierPatch cap = random_patch(6, 0.4, 1);
    for (std::size_t k = 0; k < 4; ++k) cap[k] = Vec3(1.5, -1, 0);  // one edge is a point
    const Scene scene = load_text(patch_scene(bezier_text(random_patch(7, 0.4, 1)) + ", " + bezier_text(cap),
                                              R"("role": "object", "resolution": 5)"));
    const Mesh& mesh = scene.meshes[0];
    CHECK(mesh.face_count == 2);
    CHECK(make_scene_info(scene).meshes[0].shape == "patches");
    CHECK(mesh.object.triangles.size() == 2 * 25 + 2 * 20 + 5);
    for (std::size_t t = 0; t < mesh.object.triangles.size(); ++t) {
        const auto& [a, b, c] = mesh.object.triangles[t];
        const Vec3 front = cross(mesh.object.points[b] - mesh.object.points[a],
                                 mesh.object.points[c] - mesh.object.points[a]);
        CHECK(length(front) > 0);
        for (const Vec3& normal : mesh.object.normals[t]) {
            CHECK(length(normal) == Approx(1));
            CHECK(dot(normal, front) > 0);
        }
    }
}

TEST_CASE("patches that cannot be are refused with their place", "[scene][patches][bad-input]") {
    const std::vector<Vec3> some(17, Vec3(1, 2, 3));
    const auto refusal = [](const std::string& patch, const std::string& mesh = R"("role": "object")") {
        return error_of(patch_scene(patch, mesh));
    };
    CHECK(contains(refusal(R"({"type": "bezier", "points": )" + numbers(some) + "}"),
                   "/meshes/0/patches/0/points: a Bezier patch has 16 points, not 17"));
    CHECK(contains(refusal(R"({"type": "bspline", "columns": 5, "points": )" + numbers(some) + "}"),
                   "/meshes/0/patches/0/points: 17 points are not at least 4 rows of 5"));
    const auto nurbs = [&](const std::string& rest) {
        return refusal(R"({"type": "nurbs", "columns": 3, "degree": [2, 1],
            "points": [[0,0,0],[1,0,0],[2,0,0],[0,1,0],[1,1,0],[2,1,0]], )" +
                       rest + "}");
    };
    const std::string knots = R"("knots": [[0,0,0,1,1,1], [0,0,1,1]])";
    CHECK(nurbs(knots).empty());
    CHECK(contains(nurbs(R"("knots": [[0,0,1,0.5,1,1], [0,0,1,1]])"),
                   "/meshes/0/patches/0/knots/0: knots fall at number 4"));
    CHECK(contains(nurbs(R"("knots": [[0,0,0,1,1,1], [0,0,1,1,1]])"),
                   "/meshes/0/patches/0/knots/1: 5 knots, not 4"));
    CHECK(contains(nurbs(R"("knots": [[0,0,0,0,1,1], [0,0,1,1]])"),
                   "/meshes/0/patches/0/knots/0: more than 3 knots stand at one place, at number 4"));
    CHECK(contains(nurbs(R"("knots": [[0,0,0,1,1,1], [0,1,1,2]])"),
                   "/meshes/0/patches/0/knots/1: all knots between the ends stand at one place"));
    CHECK(contains(nurbs(R"("weights": [1,1,1,1,0,1], )" + knots),
                   "/meshes/0/patches/0/weights/4: a weight must be above 0"));
    CHECK(contains(nurbs(R"("weights": [1,1,1,1,1], )" + knots),
                   "/meshes/0/patches/0/weights: 5 weights of 6 points"));
    CHECK(contains(nurbs(R"("weights": [1,1,1,1,1,1e-10], )" + knots),
                   "/meshes/0/patches/0/weights: the greatest"));
    CHECK(contains(
        refusal(R"({"type": "nurbs", "columns": 3, "points": )" + numbers(some) + ", " + knots + "}"),
        "/meshes/0/patches/0/points: 17 points are not rows of 3"));
    CHECK(contains(refusal(R"({"type": "nurbs", "points": )" + numbers(some) + "}"), "/meshes/0/patches/0"));
    CHECK(contains(refusal(R"({"type": "mesh", "points": )" + numbers(some) + "}"),
                   "/meshes/0/patches/0/type"));
    CHECK(contains(refusal(R"({"type": "coons", "points": [[0,0,0]]})"), "/meshes/0/patches/0"));
    CHECK(contains(
        refusal(
            R"({"type": "coons", "curves": [[[0,0,0],[1,0,0],[2,0,0],[3,0,0]], [[0,3,0],[1,3,0],[2,3,0],[3,3,0]],
                                [[0,0,0],[0,1,0],[0,2,0],[0,3,0]], [[3,0,0],[3,1,0],[3,2,0],[3,3,1]]]})"),
        "/meshes/0/patches/0/curves: the curves' ends do not agree: those along u end at [3,3,0], "
        "those along v at [3,3,1]"));
    CHECK(contains(
        refusal(bezier_text(random_patch(1, 0.4, 1)), R"("role": "object", "subdivisionScheme": "loop")"),
        "/meshes/0/subdivisionScheme"));
    CHECK(contains(refusal(bezier_text(random_patch(1, 0.4, 1)), R"("role": "object", "file": "a.obj")"),
                   "/meshes/0"));
}
