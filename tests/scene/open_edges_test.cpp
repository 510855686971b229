// Edges of patches: which are joined, which are open, and which of those lie along or near another.
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

BezierPatch flat_patch(const Vec3& corner, const Vec3& along_u, const Vec3& along_v) {
    BezierPatch patch;
    for (std::size_t k = 0; k < 16; ++k)
        patch[k] =
            corner + static_cast<double>(k % 4) / 3 * along_u + static_cast<double>(k / 4) / 3 * along_v;
    return patch;
}

/// Of a lattice in space or in a plane: patches that meet, are apart by rounding, by a little or by much,
/// some of them bilinear, with fronts on either side.
std::vector<RationalPatch> scattered_patches(std::uint64_t seed) {
    Draw draw(200 + seed);
    constexpr std::array<double, 4> kApart{0, 1e-12, 2e-3, 0.3};
    const std::array<Vec3, 3> axes{Vec3(0, 1, 0), Vec3(0, 0, 1), Vec3(1, 0, 0)};
    std::vector<RationalPatch> patches;
    for (int k = 0; k < 60; ++k) {
        const auto whole = [&](int most) { return static_cast<int>(draw.uniform(0, most)); };
        const int turn = seed % 2 == 0 ? 0 : whole(3);
        const Vec3 u = axes[static_cast<std::size_t>(turn)], v = axes[static_cast<std::size_t>(turn + 1) % 3];
        Vec3 corner(seed % 2 == 0 ? 0 : whole(3), whole(5), whole(5));
        corner += kApart[static_cast<std::size_t>(whole(4))] * draw.in_cube(1);
        SplineGrid grid = spline_of(flat_patch(corner, u, v));
        if (whole(3) == 0)
            grid = {2,
                    {corner, corner + u, corner + v, corner + u + v},
                    {},
                    {1, 1},
                    {{{0, 0, 1, 1}, {0, 0, 1, 1}}}};
        if (whole(2) == 0) turn_around(grid);
        patches.push_back(beziers_of(grid).at(0));
    }
    return patches;
}

/// The control points of a side, and where it is at quarters.
struct ForcedSide {
    std::size_t patch = 0;
    std::vector<Vec3> controls, places;
    bool joined = false;
};

bool all_near(const std::vector<Vec3>& a, const std::vector<Vec3>& b, double tolerance) {
    const auto near = [&](const Vec3& p, const Vec3& q) { return length(p - q) <= tolerance; };
    return a.size() == b.size() && (std::equal(a.begin(), a.end(), b.begin(), near) ||
                                    std::equal(a.begin(), a.end(), b.rbegin(), near));
}

std::vector<ForcedSide> sides_of(const std::vector<RationalPatch>& patches) {
    std::vector<ForcedSide> sides;
    for (std::size_t p = 0; p < patches.size(); ++p)
        for (int side = 0; side < 4; ++side) {
            ForcedSide one{p, {}, {}};
            const auto place = [&](double t) {
                const double end = side / 2;
                return side % 2 == 0 ? Vec2(t, end) : Vec2(end, t);
            };
            const int degree = side % 2 == 0 ? patches[p].degree_u : patches[p].degree_v;
            for (int k = 0; k <= degree; ++k) {
                const Vec2 at = place(static_cast<double>(k) / degree);
                one.controls.push_back(patches[p].control(
                    static_cast<std::size_t>(std::lround(at.y * patches[p].degree_v)) * patches[p].row() +
                    static_cast<std::size_t>(std::lround(at.x * patches[p].degree_u))));
            }
            for (int k = 0; k <= 4; ++k) one.places.push_back(on_first(patches[p], place(k / 4.)).position);
            sides.push_back(one);
        }
    return sides;
}

OpenEdges open_edges_by_force(const std::vector<RationalPatch>& patches) {
    std::vector<ForcedSide> sides = sides_of(patches);
    Box box;
    for (const RationalPatch& patch : patches) box.include(bounds_of(patch));
    const double same = joint_tolerance(box);
    for (ForcedSide& a : sides)
        for (const ForcedSide& b : sides)
            a.joined = a.joined || (&a != &b && all_near(a.controls, b.controls, same));
    OpenEdges edges;
    for (const ForcedSide& a : sides) {
        if (a.joined) continue;
        bool is_coincident = false, is_near = false;
        for (const ForcedSide& b : sides) {
            if (b.joined || b.patch == a.patch) continue;
            const auto ends = [](const std::vector<Vec3>& p) { return std::vector<Vec3>{p[0], p[2], p[4]}; };
            const double size = length(a.places[2] - a.places[0]) + length(a.places[4] - a.places[2]);
            is_coincident = is_coincident || all_near(a.places, b.places, same);
            is_near = is_near || all_near(ends(a.places), ends(b.places), kNearEdge * size);
        }
        ++edges.open;
        if (is_coincident)
            ++edges.coincident;
        else if (is_near)
            ++edges.near;
    }
    return edges;
}

}  // namespace

TEST_CASE("edges without a neighbour are counted, points are no edges", "[scene][patches]") {
    const BezierPatch patch = random_patch(8, 0.4, 1);
    const auto count = [](const std::vector<BezierPatch>& patches) {
        std::vector<RationalPatch> all;
        for (const BezierPatch& one : patches) all.push_back(beziers_of(spline_of(one)).at(0));
        return find_open_edges(all).open;
    };
    CHECK(count({patch}) == 4);
    BezierPatch beside = random_patch(9, 0.4, 1);
    for (std::size_t j = 0; j < 4; ++j) beside[4 * j] = patch[4 * (3 - j) + 3];  // against it
    CHECK(count({patch, beside}) == 6);
    beside[0] += Vec3(1e-3, 0, 0);
    CHECK(count({patch, beside}) == 8);
    BezierPatch cap = patch;
    for (std::size_t k = 1; k < 4; ++k) cap[k] = cap[0];
    CHECK(count({cap}) == 3);
    CHECK(find_open_edges(beziers_of(nurbs_sphere(2))).open == 0);
    CHECK(find_open_edges(beziers_of(nurbs_torus(3, 1))).open == 0);

    const Scene scene = load_text(patch_scene(bezier_text(patch), R"("role": "optic", "material": "glass")"));
    bool warned = false;
    for (const std::string& warning : scene.warnings)
        warned = warned || contains(warning, "4 edges of patches have no other along them");
    CHECK(warned);
    CHECK(make_scene_info(scene).meshes[0].faces == 1);
    Box hull;
    for (const Vec3& point : patch) hull.include(point);
    const Box bounds = make_scene_info(scene).meshes[0].bounds;
    CHECK(length(bounds.low - hull.low) < 1e-5);  // the scene's text has six digits
    CHECK(length(bounds.high - hull.high) < 1e-5);
}

TEST_CASE("gaps between edges of patches are counted, whatever the way that the edges run",
          "[scene][patches]") {
    const BezierPatch patch = random_patch(8, 0.4, 1);
    BezierPatch along = random_patch(9, 0.4, 1), against = along;
    for (std::size_t j = 0; j < 4; ++j) {
        along[4 * j] = patch[4 * j + 3];
        against[4 * j] = patch[4 * (3 - j) + 3];
    }
    const auto near = [&](BezierPatch beside, double gap) {
        for (std::size_t j = 0; j < 4; ++j) beside[4 * j] += Vec3(0, 0, gap);
        const OpenEdges edges =
            find_open_edges({beziers_of(spline_of(patch)).at(0), beziers_of(spline_of(beside)).at(0)});
        CHECK(edges.open == (gap == 0 ? 6 : 8));
        return edges.near;
    };
    for (const BezierPatch& beside : {along, against}) {
        CHECK(near(beside, 0) == 0);
        CHECK(near(beside, 1e-7) == 2);
        CHECK(near(beside, 1e-3) == 2);
        CHECK(near(beside, 0.1) == 0);
    }
    BezierPatch beside = along;
    beside[0] += Vec3(1e-3, 0, 0);
    for (const std::string role : {R"("role": "optic", "material": "glass")", R"("role": "object")"}) {
        CAPTURE(role);
        const Scene scene = load_text(patch_scene(bezier_text(patch) + ", " + bezier_text(beside), role));
        CHECK(std::count(scene.warnings.begin(), scene.warnings.end(),
                         "room.json: /meshes/0: 2 edges of patches lie within a hundredth of their length of "
                         "another's and are apart from it: there may be gaps") == 1);
    }
}

TEST_CASE("edges of one place and two degrees are not joined, which is no gap", "[scene][patches]") {
    const std::string bezier = bezier_text(flat_patch({0, 0, 0}, {3, 0, 0}, {0, 3, 0})),
                      linear = R"({"type": "nurbs", "columns": 2, "degree": [1, 1],
                          "points": [[3,0,0],[6,0,0],[3,3,0],[6,3,0]], "knots": [[0,0,1,1],[0,0,1,1]]})";
    const auto warnings_of = [&](const std::string& mesh) {
        std::string about;
        for (const std::string& warning : load_text(patch_scene(bezier + ", " + linear, mesh)).warnings)
            if (contains(warning, "of patches")) about += warning + "\n";
        return about;
    };
    const std::string place = "room.json: /meshes/0: ",
                      apart = place +
                              "2 edges of patches lie along another's and are not joined to it: their "
                              "degrees, weights or control points are not the same\n";
    CHECK(warnings_of(R"("role": "object")").empty());
    CHECK(warnings_of(R"("role": "optic", "material": "chrome")") == apart);
    CHECK(warnings_of(R"("role": "optic", "material": "glass")") ==
          apart + place +
              "6 edges of patches have no other along them: this glass is one interface, or a body with "
              "holes\n");
}

TEST_CASE("edges are joined, lie at one place and lie near each other as brute force finds them",
          "[scene][patches][law]") {
    OpenEdges sum;
    std::size_t all = 0;
    for (std::uint64_t seed = 0; seed < 30; ++seed) {
        CAPTURE(seed);
        const std::vector<RationalPatch> patches = scattered_patches(seed);
        const OpenEdges found = find_open_edges(patches), truth = open_edges_by_force(patches);
        CHECK(found.open == truth.open);
        CHECK(found.coincident == truth.coincident);
        CHECK(found.near == truth.near);
        sum.open += truth.open, sum.coincident += truth.coincident, sum.near += truth.near;
        all += 4 * patches.size();
    }
    CHECK(sum.open < 0.9 * static_cast<double>(all));
    CHECK(sum.coincident > 100);
    CHECK(sum.near > 100);
}

TEST_CASE("ten thousand patches in a plane across x are joined", "[scene][patches]") {
    constexpr int kSide = 100;
    std::vector<RationalPatch> patches;
    for (int k = 0; k < kSide * kSide; ++k)
        patches.push_back(
            beziers_of(spline_of(flat_patch({0, k % kSide, k / kSide}, {0, 1, 0}, {0, 0, 1}))).at(0));
    const OpenEdges edges = find_open_edges(patches);
    CHECK(edges.open == 4 * kSide);
    CHECK(edges.coincident == 0);
    CHECK(edges.near == 0);
}
