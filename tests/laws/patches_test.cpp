// Spline patches as optics: their limit surface is the polynomial, and what they mirror is what Embree finds.
#include <array>
#include <cmath>
#include <string>

#include "laws/agreement.h"
#include "laws/worlds.h"
#include "scene/data/patches.h"
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

}  // namespace

TEST_CASE("the limit surface of patches is their polynomial, derivatives and normals too", "[patches][law]") {
    std::vector<BezierPatch> patches{random_patch(1, 0.2, 0.3), random_patch(2, 0.2, 0.3)};
    for (Vec3& point : patches[1]) point += Vec3(5, 0, 0);
    SplineGrid grid{7, {}};
    Draw draw(3);
    for (int k = 0; k < 35; ++k) grid.points.emplace_back(k % 7 + 9, k / 7, draw.uniform(-1, 1));
    const auto surface = make_limit_surface(spline_cage({spline_of(patches[0]), spline_of(patches[1]), grid}),
                                            "patches", ignore);
    for (const BezierPatch& patch : beziers_of(grid)) patches.push_back(patch);
    REQUIRE(surface->face_count() == patches.size());
    for (Id face = 0; face < patches.size(); ++face)
        for (const Vec2& uv : {Vec2(0, 0), Vec2(0.2, 0.9), Vec2(0.5, 0.5), Vec2(1, 0.4), Vec2(1, 1)}) {
            const SurfacePoint limit = surface->eval(face, uv), exact = evaluate(patches[face], uv);
            CHECK(length(limit.position - exact.position) < 1e-12);
            CHECK(length(limit.du - exact.du) < 1e-11);
            CHECK(length(limit.dv - exact.dv) < 1e-11);
            CHECK(length(limit.duu - exact.duu) < 1e-10);
            CHECK(length(limit.duv - exact.duv) < 1e-10);
            CHECK(length(limit.dvv - exact.dvv) < 1e-10);
            CHECK(length(limit.normal - exact.normal) < 1e-11);
        }
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
    const auto surface = make_limit_surface(spline_cage({spline_of(dome)}), "dome", ignore);
    for (const double u : {0.0, 0.4, 1.0}) {
        const SurfacePoint top = surface->eval(0, Vec2(u, 0));
        CHECK(length(top.position - Vec3(0, 0, 1)) < 1e-13);
        CHECK(std::fabs(top.normal.z) > 1 - 1e-9);
    }
}

TEST_CASE("mirrors of patches show what Embree finds in their facets", "[patches][law]") {
    const std::string json = R"({"version": 1, "film": {"width": 80, "height": 60},
        "cameras": [{"name": "main", "yfov": 40, "lookAt": {"eye": [0.4, 0.3, 5], "at": [0, 0, 0]}}],
        "materials": [{"name": "chrome", "metallicFactor": 1, "roughnessFactor": 0}],
        "meshes": [{"name": "sheet", "role": "optic", "material": "chrome", "patches": [)" +
                             patch_text(random_patch(4, 0.2, 0.3)) + R"(]},
            {"name": "box", "role": "object", "primitive": {"type": "box", "center": [0.5, 0.8, 4], "size": [1.5, 1, 0.6]}},
            {"name": "wall", "role": "object", "primitive": {"type": "plane", "center": [0, 0, 9], "normal": [0, 0, -1], "size": [9, 7]}}]})";
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
