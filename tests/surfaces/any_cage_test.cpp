// No cage crashes: what cannot be used is refused with its place, everything else has a surface and a grid.
#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "base/util/error.h"
#include "support/test.h"
#include "surfaces/surfaces.h"
#include "test_cages.h"

using namespace trilens;
using namespace trilens_test;

namespace {

std::string refusal(const Cage& cage) {
    try {
        make_limit_surface(cage, "box.obj", {});
    } catch (const InputError& error) {
        return error.what();
    }
    return "";
}

int below(std::mt19937& random, int n) {
    return static_cast<int>(random() % static_cast<unsigned>(n));
}

void add_random_tags(std::mt19937& random, Cage& cage) {
    const int points = static_cast<int>(cage.points.size());
    const int faces = static_cast<int>(cage.face_vertex_counts.size());
    const double kSharpness[] = {0, 0.5, 1, 2.75, 9.5, 10, 100};
    for (int i = below(random, 8); i > 0; --i) {
        // Mostly along an edge of some face.
        const std::size_t at = random() % (cage.face_vertex_indices.size() - 1);
        const int a = cage.face_vertex_indices[at], b = cage.face_vertex_indices[at + 1];
        add_crease(cage, {a, below(random, 5) == 0 ? below(random, points) : b},
                   kSharpness[below(random, 7)]);
    }
    for (int i = below(random, 3); i > 0; --i) {
        cage.corner_indices.push_back(below(random, points));
        cage.corner_sharpnesses.push_back(kSharpness[below(random, 7)]);
    }
    if (below(random, 4) == 0) cage.hole_indices.push_back(below(random, faces));
    cage.interpolate_boundary = static_cast<InterpolateBoundary>(below(random, 3));
}

/// Faces of random vertices out of few: folded, non-manifold, repeated, collapsed, everything at once.
Cage random_faces(std::mt19937& random) {
    Cage cage;
    cage.scheme = static_cast<SubdivisionScheme>(below(random, 3));
    const int points = 3 + below(random, 10), faces = 1 + below(random, 12);
    for (int i = 0; i < points; ++i)
        cage.points.emplace_back(below(random, 4), below(random, 4), below(random, 4));
    for (int f = 0; f < faces; ++f) {
        const int most = below(random, 4) == 0 ? 8 : 4;
        const int corners = cage.scheme == SubdivisionScheme::kLoop ? 3 : 3 + below(random, most - 2);
        cage.face_vertex_counts.push_back(corners);
        for (int i = 0; i < corners; ++i) cage.face_vertex_indices.push_back(below(random, points));
    }
    add_random_tags(random, cage);
    return cage;
}

/// A good cage of which some vertices are made one, and some faces turned over.
Cage random_welds(std::mt19937& random) {
    const auto cages = small_cages();
    Cage cage = cages[random() % cages.size()].second;
    if (below(random, 3) == 0) {
        std::vector<std::vector<int>> triangles;
        const int* v = cage.face_vertex_indices.data();
        for (int count : cage.face_vertex_counts) {
            for (int i = 1; i + 1 < count; ++i) triangles.push_back({v[0], v[i], v[i + 1]});
            v += count;
        }
        cage = make_cage(cage.points, triangles);
        if (below(random, 4) > 0) cage.scheme = SubdivisionScheme::kLoop;
    }
    const int points = static_cast<int>(cage.points.size());
    for (int i = below(random, 4); i > 0; --i) {
        const int from = below(random, points), to = below(random, points);
        std::replace(cage.face_vertex_indices.begin(), cage.face_vertex_indices.end(), from, to);
    }
    if (below(random, 4) == 0) {
        const auto first = cage.face_vertex_indices.begin();
        std::reverse(first, first + cage.face_vertex_counts[0]);
    }
    cage.crease_indices.clear();
    cage.crease_lengths.clear();
    cage.crease_sharpnesses.clear();
    add_random_tags(random, cage);
    return cage;
}

Cage random_cage(std::mt19937& random) {
    return below(random, 2) == 0 ? random_faces(random) : random_welds(random);
}

/// Every edge of a facet inside the surface has a neighbour in the other direction or, where faces are turned
/// against each other or three meet, at least a neighbour; here only that corners are in range and numbers
/// finite.
bool is_sound(const SurfaceGrid& grid) {
    bool sound = grid.corner_normal.size() == grid.corner_point.size();
    for (const Vec3& p : grid.points)
        sound = sound && std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
    for (const Vec3& n : grid.corner_normal)
        sound = sound && (n == Vec3(0) || std::abs(length(n) - 1) < 1e-12);
    for (Id point : grid.corner_point) sound = sound && point < grid.points.size();
    for (const IdTriple& facet : grid.facets)
        for (Id corner : facet) sound = sound && corner < grid.corner_point.size();
    return sound && grid.facet_face.size() == grid.facets.size() &&
           grid.facet_uv.size() == grid.facets.size();
}

}  // namespace

TEST_CASE("What cannot be used is refused with its place", "[surfaces][bad-input]") {
    CHECK(refusal(cube()).empty());
    CHECK(refusal(Cage{}) == "box.obj: faceVertexCounts: the cage has no faces");

    Cage cage = cube();
    cage.face_vertex_indices[5] = 8;
    CHECK(refusal(cage) == "box.obj: faceVertexIndices: entry 5 is 8, but there are 8");
    cage.face_vertex_indices[5] = -1;
    CHECK(refusal(cage) == "box.obj: faceVertexIndices: entry 5 is -1, but there are 8");

    cage = cube();
    cage.face_vertex_indices.pop_back();
    CHECK(refusal(cage) == "box.obj: faceVertexIndices: has 23 entries, but the faces have 24 corners");

    cage = cube();
    cage.face_vertex_counts[2] = 2;
    CHECK(refusal(cage) == "box.obj: faceVertexCounts: face 2 has 2 corners, not 3 to 255");
    CHECK(refusal(prism(256)) == "box.obj: faceVertexCounts: face 0 has 256 corners, not 3 to 255");
    CHECK(refusal(prism(255)).empty());

    cage = cube();
    cage.points[3].y = std::numeric_limits<double>::quiet_NaN();
    CHECK(refusal(cage) == "box.obj: points: point 3 is not finite");

    cage = cube();
    cage.scheme = SubdivisionScheme::kLoop;
    CHECK(refusal(cage) ==
          "box.obj: faceVertexCounts: face 0 has 4 corners, but Loop subdivision is for triangles");

    cage = cube();
    add_crease(cage, {0, 1}, -1);
    CHECK(refusal(cage) == "box.obj: creaseSharpnesses: a sharpness is not a number >= 0");
    cage.crease_sharpnesses[0] = std::nan("");
    CHECK(refusal(cage) == "box.obj: creaseSharpnesses: a sharpness is not a number >= 0");
    cage.crease_sharpnesses = {1, 1, 1};
    CHECK(refusal(cage) ==
          "box.obj: creaseSharpnesses: needs one entry per crease, or one per edge of all creases");
    cage.crease_lengths = {3};
    CHECK(refusal(cage) == "box.obj: creaseIndices: does not have as many entries as creaseLengths says");

    cage = cube();
    cage.corner_indices = {1};
    CHECK(refusal(cage) == "box.obj: cornerSharpnesses: needs one entry per corner");
    cage = cube();
    cage.hole_indices = {6};
    CHECK(refusal(cage) == "box.obj: holeIndices: entry 0 is 6, but there are 6");
}

TEST_CASE("What is repaired or left out is said", "[surfaces]") {
    std::vector<std::string> said;
    const Warn warn = [&said](const std::string& message) { said.push_back(message); };

    Cage cage = cube();
    add_crease(cage, {0, 7}, 10);
    CHECK(make_limit_surface(cage, "box", warn)->face_count() == 6);
    REQUIRE(said.size() == 1);
    CHECK(said[0] == "box: 1 crease edges are no edges of the cage and are left out");

    said.clear();
    cage = make_cage({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}},
                     {{0, 1, 2, 3}, {0, 1, 1, 2}, {0, 1, 0, 1}, {2, 2, 2}});
    CHECK(make_limit_surface(cage, "flat", warn)->face_count() == 1 + 3);
    REQUIRE(said.size() == 2);
    CHECK(said[0] == "flat: 1 faces repeat a corner; one of each is kept");
    CHECK(said[1] == "flat: 2 faces are no simple polygons and are left out");

    said.clear();
    cage = sheet(3, 3);
    cage.interpolate_boundary = InterpolateBoundary::kNothing;
    CHECK(make_limit_surface(cage, "sheet", warn)->face_count() == 1);
    REQUIRE(said.size() == 1);
    CHECK(said[0] == "sheet: 8 faces have no limit surface and are left out");

    said.clear();
    CHECK(make_limit_surface(prism(5), "prism", warn)->face_count() == 5 + 2 * 5);
    CHECK(said.empty());
}

TEST_CASE("Random faces of random vertices have sound surfaces and grids", "[surfaces][law]") {
    std::mt19937 random(20);
    int usable = 0;
    for (int i = 0; i < 400; ++i) {
        CAPTURE(i);
        const Cage cage = random_cage(random);
        const auto surface = make_limit_surface(cage, "random", {});
        usable += surface->face_count() > 0;
        CHECK(is_sound(make_grid(*surface, 1 + i % 4)));
    }
    CHECK(usable > 200);
}

TEST_CASE("Collapsed and huge cages have sound grids", "[surfaces]") {
    for (const auto& [name, cage] : small_cages()) {
        CAPTURE(name);
        for (double scale : {0.0, 1e-200, 1e200}) {
            Cage scaled = cage;
            for (Vec3& p : scaled.points) p = scale * p + (scale == 0 ? Vec3(3, 4, 5) : Vec3(0));
            CHECK(is_sound(make_grid(*make_limit_surface(scaled, name, {}), 3)));
        }
    }
    Cage fan;  // one vertex of 300 faces
    std::vector<std::vector<int>> faces;
    fan.points.emplace_back(0, 0, 1);
    for (int i = 0; i < 600; ++i)
        fan.points.emplace_back(std::cos(i * 0.01047197551), std::sin(i * 0.01047197551), 0);
    for (int i = 0; i < 300; ++i) faces.push_back({0, 1 + 2 * i, 2 + 2 * i, 1 + (2 * i + 2) % 600});
    CHECK(is_sound(make_grid(*make_limit_surface(make_cage(fan.points, faces), "fan", {}), 2)));
}
