// The tree over a surface's patches: its bounds hold what they say, and its visits miss nothing.
#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "intersect/patch_tree.h"
#include "intersect/random_scene.h"
#include "support/test.h"
#include "surfaces/surfaces.h"

using namespace trilens;
using namespace trilens_test;

namespace {

std::unique_ptr<Surface> primitive(const PrimitiveKind& kind) {
    return make_primitive_surface({.kind = kind});
}

/// A cage's unit cube, all its edges creased, without its last `open` faces.
std::unique_ptr<Surface> cube(double sharpness, std::size_t open = 0) {
    Cage cage;
    for (int i = 0; i < 8; ++i) cage.points.push_back({i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1});
    const std::vector<std::vector<int>> faces{{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                                              {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
    for (std::size_t f = 0; f + open < faces.size(); ++f) {
        cage.face_vertex_counts.push_back(4);
        for (std::size_t k = 0; k < 4; ++k) {
            cage.face_vertex_indices.push_back(faces[f][k]);
            // Each edge from one of its faces.
            if (!(sharpness > 0) || faces[f][k] > faces[f][(k + 1) % 4]) continue;
            cage.crease_indices.insert(cage.crease_indices.end(), {faces[f][k], faces[f][(k + 1) % 4]});
            cage.crease_lengths.push_back(2);
            cage.crease_sharpnesses.push_back(sharpness);
        }
    }
    return make_limit_surface(cage, "cube", {});
}

void check_bounds(const Surface& surface, int n, Random& random) {
    const SurfaceGrid grid = make_grid(surface, n);
    const PatchTree tree(surface, grid);
    REQUIRE(tree.patches().size() == grid.facets.size());
    std::size_t outside = 0, turned = 0;
    for (int i = 0; i < 4000; ++i) {
        const std::size_t f = random.below(grid.facets.size());
        const SurfacePatch& patch = tree.patches()[f];
        const double a = std::sqrt(random.uniform(0, 1)), b = random.uniform(0, 1);
        const Vec3 w(1 - a, a * (1 - b), a * b);
        Vec2 uv(0);
        Vec3 chord(0);
        for (std::size_t k = 0; k < 3; ++k) {
            uv += w[static_cast<int>(k)] * grid.facet_uv[f][k];
            chord += w[static_cast<int>(k)] * patch.corner[k];
        }
        const SurfacePoint at = surface.eval(grid.facet_face[f], uv);
        outside += !(length(at.position - chord) <= patch.stray + 1e-12);
        const Vec3 normal = normalize_or_zero(cross(at.du, at.dv));
        if (normal == Vec3(0) || patch.normal == Vec3(0)) continue;
        const double off = std::min(length(normal - patch.normal), length(-normal - patch.normal));
        turned += !(off <= patch.normal_radius + 1e-12);
        CHECK(tree.bounds().holds(at.position));
    }
    CHECK(outside == 0);
    CHECK(turned == 0);
}

}  // namespace

TEST_CASE("Patches bound the surface and its normals", "[intersect]") {
    Random random(3);
    for (const PrimitiveKind& kind : std::initializer_list<PrimitiveKind>{
             SpherePrimitive(), ParaboloidPrimitive(), CylinderPrimitive(), ConePrimitive()})
        for (const int n : {3, 8}) check_bounds(*primitive(kind), n, random);
    for (const double sharpness : {0.0, 1.5, 10.0}) check_bounds(*cube(sharpness), 4, random);
    check_bounds(*cube(0, 2), 4, random);
}

TEST_CASE("Borders and creases are rims, and closed surfaces are known", "[intersect]") {
    const auto tree_of = [](const Surface& surface) { return PatchTree(surface, make_grid(surface, 4)); };
    const PatchTree ball = tree_of(*primitive(SpherePrimitive()));
    CHECK(ball.rims().empty());
    CHECK(ball.is_closed());
    CHECK_FALSE(ball.is_height_field());
    const PatchTree plane = tree_of(*primitive(PlanePrimitive()));
    CHECK_FALSE(plane.is_closed());
    CHECK(plane.is_height_field());
    CHECK(plane.rims().size() == 16);
    const PatchTree smooth = tree_of(*cube(0)), creased = tree_of(*cube(10)), open = tree_of(*cube(0, 1));
    CHECK(smooth.is_closed());
    CHECK(smooth.rims().empty());
    CHECK(creased.is_closed());
    CHECK(creased.rims().size() >= 12 * 4);  // each crease once for either side, where normals jump
    CHECK_FALSE(open.is_closed());
    CHECK(open.rims().size() == 4 * 4);
}

TEST_CASE("A surface that winds over itself is no graph, nor is one with a hole", "[intersect]") {
    // A helical ramp of two turns: all normals look up.
    Cage ramp;
    constexpr int kAround = 24, kTurns = 2;
    for (int i = 0; i <= kAround * kTurns; ++i)
        for (const double radius : {1.0, 2.0}) {
            const double angle = 2 * 3.14159265358979 * i / kAround;
            ramp.points.push_back({radius * std::cos(angle), 0.03 * i, radius * std::sin(angle)});
        }
    for (int i = 0; i < kAround * kTurns; ++i) {
        ramp.face_vertex_counts.push_back(4);
        for (const int k : {2 * i, 2 * i + 1, 2 * i + 3, 2 * i + 2}) ramp.face_vertex_indices.push_back(k);
    }
    const auto winding = make_limit_surface(ramp, "ramp", {});
    CHECK_FALSE(PatchTree(*winding, make_grid(*winding, 2)).is_height_field());
}

TEST_CASE("Visits reach every patch whose box is asked for", "[intersect][law]") {
    Random random(17);
    const auto surface = cube(1.5);
    const PatchTree tree(*surface, make_grid(*surface, 8));
    for (int i = 0; i < 200; ++i) {
        const Vec3 middle = random.in_box(1.5), half = Vec3(random.log_uniform(0.01, 1));
        const auto may_touch = [&](const Box& box) {
            return glm::all(glm::lessThanEqual(box.low, middle + half)) &&
                   glm::all(glm::lessThanEqual(middle - half, box.high));
        };
        std::vector<char> visited(tree.patches().size(), 0);
        CHECK(tree.all_of(may_touch, [&](const PatchTree::Item& item) {
            if (item.patch != kNone) visited[item.patch] = 1;
            return true;
        }));
        std::size_t missed = 0;
        for (std::size_t p = 0; p < visited.size(); ++p) {
            const SurfacePatch& patch = tree.patches()[p];
            Box box;
            for (const Vec3& corner : patch.corner) box.include(corner);
            missed += may_touch({box.low - patch.stray, box.high + patch.stray}) && !visited[p];
        }
        CHECK(missed == 0);
        // It ends at the first that refuses.
        std::size_t visits = 0;
        const bool all = tree.all_of(may_touch, [&](const PatchTree::Item&) { return ++visits < 1; });
        CHECK((all ? visits == 0 : visits == 1));
    }
}
