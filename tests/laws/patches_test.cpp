// Spline patches as optics: their limit surface is the polynomial, and what they mirror is what Embree finds.
#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "camera/linear/linear_cameras.h"
#include "json/json.h"
#include "laws/agreement.h"
#include "laws/worlds.h"
#include "scene/data/patches.h"
#include "specular/specular_search.h"
#include "support/bezier_patch.h"
#include "support/draw.h"
#include "support/test.h"
#include "surfaces/surfaces.h"

using namespace trilens;
using namespace trilens_test;

namespace {

std::string patch_text(const BezierPatch& patch) {
    std::string text;
    for (const Vec3& p : patch)
        text += (text.empty() ? "[" : ", [") + std::to_string(p.x) + ", " + std::to_string(p.y) + ", " +
                std::to_string(p.z) + "]";
    return R"({"type": "bezier", "points": [)" + text + "]}";
}

/// The cage whose limit surface is the uniform bicubic B-spline: faces along its border have no limit.
Cage cage_of(const SplineGrid& spline) {
    Cage cage;
    cage.interpolate_boundary = InterpolateBoundary::kNothing;
    cage.points = spline.points;
    for (int j = 0; j + 1 < spline.rows(); ++j)
        for (int i = 0; i + 1 < spline.columns; ++i) {
            const bool at_border = i == 0 || j == 0 || i + 2 == spline.columns || j + 2 == spline.rows();
            if (at_border) cage.hole_indices.push_back(static_cast<int>(cage.face_vertex_counts.size()));
            cage.face_vertex_counts.push_back(4);
            const int corner = j * spline.columns + i;
            for (const int vertex :
                 {corner, corner + 1, corner + spline.columns + 1, corner + spline.columns})
                cage.face_vertex_indices.push_back(vertex);
        }
    return cage;
}

std::string nurbs_text(const SplineGrid& grid) {
    const Json json = {{"type", "nurbs"},
                       {"columns", grid.columns},
                       {"degree", grid.degree},
                       {"weights", grid.weights},
                       {"knots", grid.knots}};
    std::string points;
    for (const Vec3& p : grid.points)
        points += (points.empty() ? "[" : ", [") + Json(p.x).dump() + ", " + Json(p.y).dump() + ", " +
                  Json(p.z).dump() + "]";
    std::string text = json.dump();
    text.pop_back();
    return text + ", \"points\": [" + points + "]}";
}

/// A room of things around an optic.
std::string room_with(const std::string& optic) {
    return R"({"version": 1, "film": {"width": 80, "height": 60},
        "cameras": [{"name": "main", "yfov": 40, "lookAt": {"eye": [0.4, 0.3, 5], "at": [0, 0, 0]}}],
        "materials": [{"name": "chrome", "metallicFactor": 1, "roughnessFactor": 0}],
        "meshes": [{"name": "ball", "role": "optic", "material": "chrome", )" +
           optic + R"(},
            {"name": "box", "role": "object", "primitive": {"type": "box", "center": [0.5, 0.8, 4], "size": [1.5, 1, 0.6]}},
            {"name": "wall", "role": "object", "primitive": {"type": "plane", "center": [0, 0, 9], "normal": [0, 0, -1], "size": [9, 7]}}]})";
}

}  // namespace

TEST_CASE("patches of a uniform B-spline are the limit surface of its cage, derivatives and normals too",
          "[patches][law]") {
    std::vector<Vec3> points;
    Draw draw(3);
    for (int k = 0; k < 35; ++k) points.emplace_back(k % 7 + 9, k / 7, draw.uniform(-1, 1));
    const SplineGrid grid = uniform_spline(7, points);
    const auto surface = make_patch_surface(beziers_of(grid), "patches");
    const auto limit_surface = make_limit_surface(cage_of(grid), "cage", ignore);
    REQUIRE(surface->face_count() == 4 * 2);
    REQUIRE(limit_surface->face_count() == surface->face_count());
    for (Id face = 0; face < surface->face_count(); ++face)
        for (const Vec2& uv : {Vec2(0, 0), Vec2(0.2, 0.9), Vec2(0.5, 0.5), Vec2(1, 0.4), Vec2(1, 1)}) {
            const SurfacePoint limit = limit_surface->eval(face, uv), exact = surface->eval(face, uv);
            CHECK(length(limit.position - exact.position) < 1e-12);
            CHECK(length(limit.du - exact.du) < 1e-11);
            CHECK(length(limit.dv - exact.dv) < 1e-11);
            CHECK(length(limit.duu - exact.duu) < 1e-10);
            CHECK(length(limit.duv - exact.duv) < 1e-10);
            CHECK(length(limit.dvv - exact.dvv) < 1e-10);
            CHECK(length(limit.normal - exact.normal) < 1e-11);
            const SurfacePoint first = surface->eval_first_order(face, uv);
            CHECK(first.position == exact.position);
            CHECK(first.du == exact.du);
            CHECK(first.normal == exact.normal);
        }
}

TEST_CASE("circles of NURBS turned about an axis are spheres and tori to rounding", "[patches][law]") {
    const auto sphere = make_patch_surface(beziers_of(nurbs_sphere(2)), "sphere");
    const auto torus = make_patch_surface(beziers_of(nurbs_torus(3, 1)), "torus");
    REQUIRE(sphere->face_count() == 8);
    REQUIRE(torus->face_count() == 16);
    Draw draw(7);
    for (int k = 0; k < 2000; ++k) {
        const Vec2 uv(draw.uniform(0, 1), draw.uniform(0, 1));
        const SurfacePoint p = sphere->eval(static_cast<Id>(k % 8), uv);
        CHECK(std::fabs(length(p.position) - 2) < 1e-14);
        CHECK(length(p.normal - normalize(p.position)) < 1e-13);
        const SurfacePoint q = torus->eval(static_cast<Id>(k % 16), uv);
        const Vec3 middle = 3. * normalize(Vec3(q.position.x, q.position.y, 0));
        CHECK(std::fabs(length(q.position - middle) - 1) < 1e-14);
        CHECK(length(q.normal - normalize(q.position - middle)) < 1e-13);
    }
}

TEST_CASE("patches whose sides agree are joined: one point at a corner, one edge, fronts kept",
          "[patches][law]") {
    // A torus has no border, a sphere none but its poles; grids of them are closed.
    const auto torus = make_patch_surface(beziers_of(nurbs_torus(3, 1)), "torus");
    const SurfaceGrid grid = make_grid(*torus, 5);
    CHECK(grid.points.size() == 16 * 25);  // Euler: as many points as squares
    CHECK(grid.facets.size() == 2 * 16 * 25);
    // Moved apart by less than the tolerance, neighbours still meet, exactly.
    std::vector<RationalPatch> moved = beziers_of(nurbs_torus(3, 1));
    for (Vec4& point : moved[5].points) point.x += 1e-10 * point.w;
    const auto joined = make_patch_surface(moved, "torus");
    CHECK(make_grid(*joined, 5).points.size() == 16 * 25);
    for (const double t : {0.0, 0.37, 1.0})
        CHECK(length(joined->eval(5, {0, t}).position - joined->eval(4, {1, t}).position) < 1e-15);
    for (Vec4& point : moved[5].points) point.x += 1e-6 * point.w;
    CHECK(make_grid(*make_patch_surface(moved, "torus"), 5).points.size() == 16 * 25 + 20);
}

TEST_CASE("a sphere of NURBS mirrors as the primitive does: images, and proofs that there are no more",
          "[patches][law]") {
    const auto nurbs =
        world_from("nurbs", room_with("\"patches\": [" + nurbs_text(nurbs_sphere(1)) + "]"), 10);
    const auto ball = world_from("ball", room_with(R"("primitive": {"type": "sphere", "radius": 1})"), 10);
    const SpecularSearcher one(*nurbs->optics[0].surface), other(*ball->optics[0].surface);
    Draw draw(12);
    int proven = 0;
    for (int k = 0; k < 300; ++k) {
        SpecularQuery query;
        PerspectiveParams camera;
        camera.look_at = {2. * draw.unit() + draw.in_cube(0.3), Vec3(0), {0.1, 1, 0.2}};
        query.camera = make_perspective(camera);
        query.point = 1.5 * draw.unit() + draw.in_cube(0.25);
        query.event = SpecularEvent::kReflect;
        const SpecularSearch a = one.find(query), b = other.find(query);
        proven += a.complete;
        REQUIRE(b.complete);
        REQUIRE(a.images.size() == b.images.size());
        for (std::size_t i = 0; i < a.images.size(); ++i)
            CHECK(length(nurbs->optics[0].surface->eval(a.images[i].at.face, a.images[i].at.uv).position -
                         ball->optics[0].surface->eval(b.images[i].at.face, b.images[i].at.uv).position) <
                  1e-10);
    }
    // All but those whose image is at a pole, where parameters are singular.
    CHECK(proven >= 297);
    const Agreement agreement = compare_engines(*nurbs), as_ball = compare_engines(*ball);
    INFO(agreement.first_off_edge);
    CHECK(agreement.optic_pixels == as_ball.optic_pixels);
    CHECK(agreement.optic_pixels > 600);
    CHECK(agreement.off_edge == 0);
}

TEST_CASE("where an edge of a patch is a point its normal is that of places beside it", "[patches][law]") {
    // A quarter of a dome: all of the first row is its top.
    BezierPatch dome;
    const double k = 0.5523;
    const std::array<Vec2, 4> around{Vec2(1, 0), Vec2(1, k), Vec2(k, 1), Vec2(0, 1)};
    const std::array<Vec2, 4> profile{Vec2(0, 1), Vec2(k, 1), Vec2(1, k), Vec2(1, 0)};
    for (std::size_t j = 0; j < 4; ++j)
        for (std::size_t i = 0; i < 4; ++i)
            dome[4 * j + i] = Vec3(profile[j].x * around[i].x, profile[j].x * around[i].y, profile[j].y);
    const auto surface = make_patch_surface(beziers_of(spline_of(dome)), "dome");
    for (const double u : {0.0, 0.4, 1.0}) {
        const SurfacePoint top = surface->eval(0, Vec2(u, 0));
        CHECK(length(top.position - Vec3(0, 0, 1)) < 1e-13);
        CHECK(std::fabs(top.normal.z) > 1 - 1e-9);
    }
}

TEST_CASE("mirrors of patches show what Embree finds in their facets", "[patches][law]") {
    const std::string json = room_with("\"patches\": [" + patch_text(random_patch(4, 0.2, 0.3)) + ", " +
                                       nurbs_text(random_nurbs(5, {2, 3}, {4, 5})) + "]");
    const auto world = world_from("patches", json, 10);
    const Agreement agreement = compare_engines(*world);
    INFO(agreement.first_off_edge);
    CHECK(agreement.optic_pixels > 1000);
    CHECK(agreement.off_edge == 0);
    CHECK(agreement.seen <= agreement.pixels / 100);
}

TEST_CASE("the teapot is 32 patches, its rows closed around the axis", "[patches][law]") {
    std::string missing;
    const auto world = shipped_world("patches/teapot", 4, 60, 45, &missing);
    REQUIRE(world);
    const Mesh& pot = world->scene.meshes[0];
    CHECK(pot.face_count == 32);
    CHECK(pot.of_patches);
    const Agreement agreement = compare_engines(*world);
    INFO(agreement.first_off_edge);
    CHECK(agreement.optic_pixels > 400);
    CHECK(agreement.off_edge == 0);
}

TEST_CASE("no image at a seam of the teapot's patches is missed, and lists are proven complete",
          "[patches][law]") {
    const auto world = shipped_world("patches/teapot", 4, 60, 45);
    REQUIRE(world);
    const Surface& pot = *world->optics[0].surface;
    const SpecularSearcher searcher(pot);
    PerspectiveParams camera;
    camera.look_at = {{2.2, 4.6, 11.4}, {0.25, 1.25, 0}, {0, 1, 0}};
    SpecularQuery query;
    query.camera = make_perspective(camera);
    query.event = SpecularEvent::kReflect;
    query.viewed = ViewedSide::kFront;
    Draw draw(17);
    int asked = 0, found = 0, proven = 0;
    while (asked < 300) {
        const auto face = static_cast<Id>(draw.uniform(0, static_cast<double>(pot.face_count())));
        const auto side = static_cast<std::size_t>(draw.uniform(0, 4));
        if (pot.border(face).sides[side].edge == kNone) continue;
        const double along = draw.uniform(0, 1);
        const std::array<Vec2, 4> places{{{along, 0}, {1, along}, {along, 1}, {0, along}}};
        const SurfacePoint at = pot.eval(face, places[side]);
        const Vec3 way = normalize(at.position - query.camera.eye);
        if (dot(way, at.normal) > -0.05) continue;
        query.point = at.position + draw.uniform(0.5, 4) * (way - 2 * dot(way, at.normal) * at.normal);
        const SpecularSearch search = searcher.find(query);
        const auto is_it = [&](const SpecularPoint& image) {
            return length(pot.eval(image.at.face, image.at.uv).position - at.position) < 1e-6;
        };
        ++asked;
        found += std::any_of(search.images.begin(), search.images.end(), is_it);
        proven += search.complete;
    }
    CHECK(found == asked);
    CHECK(proven >= asked - 3);
}
