// Laws of grids: no cracks, corners on the surface, one normal where it is smooth, one per side along
// creases.
#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "base/util/parallel.h"
#include "support/test.h"
#include "surfaces/surfaces.h"
#include "test_cages.h"

using namespace trilens;
using namespace trilens_test;

namespace {

using Edge = std::pair<Id, Id>;  // two points, ascending

/// Per edge between facets: how many run along it each way. Pairs inside one face are matched first, because
/// two faces around a vertex of two faces may both have a diagonal between the same points.
std::map<Edge, std::pair<int, int>> edge_uses(const SurfaceGrid& grid) {
    std::map<std::pair<Edge, Id>, std::pair<int, int>> in_face;
    for (std::size_t f = 0; f < grid.facets.size(); ++f)
        for (int k = 0; k < 3; ++k) {
            const Id a = grid.corner_point[grid.facets[f][k]],
                     b = grid.corner_point[grid.facets[f][(k + 1) % 3]];
            auto& use = in_face[{std::minmax(a, b), grid.facet_face[f]}];
            ++(a < b ? use.first : use.second);
        }
    std::map<Edge, std::pair<int, int>> uses;
    for (const auto& [edge, use] : in_face) {
        if (use == std::pair(1, 1)) continue;
        uses[edge.first].first += use.first;
        uses[edge.first].second += use.second;
    }
    return uses;
}

/// Segments on the border of the grid, as the cage has them: n per boundary edge of a quad or triangle, 2n
/// per n-gon.
int expected_border(const Cage& cage, int n) {
    std::map<std::pair<int, int>, std::pair<int, bool>> edges;  // faces along it, whether one is an n-gon
    const int whole = cage.scheme == SubdivisionScheme::kLoop ? 3 : 4;
    const int* v = cage.face_vertex_indices.data();
    for (std::size_t f = 0; f < cage.face_vertex_counts.size(); ++f) {
        const int count = cage.face_vertex_counts[f];
        const bool hole =
            std::count(cage.hole_indices.begin(), cage.hole_indices.end(), static_cast<int>(f)) > 0;
        for (int i = 0; i < count && !hole; ++i) {
            auto& edge = edges[std::minmax(v[i], v[(i + 1) % count])];
            ++edge.first;
            edge.second = edge.second || count != whole;
        }
        v += count;
    }
    int segments = 0;
    for (const auto& [ends, edge] : edges)
        if (edge.first == 1) segments += edge.second ? 2 * n : n;
    return segments;
}

/// Whether no two faces run along an edge in the same direction.
bool is_oriented_manifold(const Cage& cage) {
    std::set<std::pair<int, int>> directed;
    const int* v = cage.face_vertex_indices.data();
    for (int count : cage.face_vertex_counts) {
        for (int i = 0; i < count; ++i)
            if (!directed.insert({v[i], v[(i + 1) % count]}).second) return false;
        v += count;
    }
    return true;
}

/// Every edge of a facet has its neighbour, but on the border of the cage; in a manifold cage, one neighbour
/// each. Returns whether the cage is manifold.
bool check_no_cracks(const Cage& cage, int n) {
    const SurfaceGrid grid = make_grid(*make_limit_surface(cage, "cage", {}), n);
    int border = 0, doubled = 0;
    for (const auto& [ends, use] : edge_uses(grid)) {
        if (use.first + use.second == 1) ++border;
        if (use.first > 1 || use.second > 1) ++doubled;
    }
    const bool manifold = is_oriented_manifold(cage);
    CHECK(border == expected_border(cage, n));
    CHECK((doubled == 0) == manifold);
    return manifold;
}

/// The numbers of different normals at the corners of each point.
std::vector<int> normals_per_point(const SurfaceGrid& grid) {
    std::vector<int> count(grid.points.size(), 0);
    for (Id point : grid.corner_point) ++count[point];
    return count;
}

double grid_spread(const SurfaceGrid& grid) {
    Vec3 low = grid.points[0], high = grid.points[0];
    for (const Vec3& p : grid.points) low = glm::min(low, p), high = glm::max(high, p);
    return length(high - low);
}

std::unique_ptr<Surface> quietly(const Cage& cage) {
    return make_limit_surface(cage, "cage", {});
}

}  // namespace

TEST_CASE("Grids have no cracks and no T-junctions", "[surfaces]") {
    for (const auto& [name, cage] : small_cages())
        for (int n : {1, 2, 3, 5}) {
            CAPTURE(name, n);
            CHECK(check_no_cracks(cage, n) == (name != "book"));
        }
}

TEST_CASE("Grids of the shapes on file have no cracks", "[surfaces][golden]") {
    TRILENS_NEEDS_DATA("cages/catmark_cube.obj");
    for (const std::string& name : cage_files())
        for (int n : {1, 4}) {
            CAPTURE(name, n);
            check_no_cracks(read_cage(name), n);
        }
}

TEST_CASE("A grid has the counts that it promises", "[surfaces]") {
    for (int n : {1, 2, 7}) {
        const SurfaceGrid box = make_grid(*quietly(cube()), n);
        CHECK(box.facets.size() == static_cast<std::size_t>(6 * 2 * n * n));
        CHECK(box.points.size() == static_cast<std::size_t>(6 * n * n + 2));  // Euler
        Cage pyramid = make_cage({{1, 1, 1}, {-1, -1, 1}, {-1, 1, -1}, {1, -1, -1}},
                                 {{0, 1, 3}, {0, 2, 1}, {0, 3, 2}, {1, 2, 3}});
        pyramid.scheme = SubdivisionScheme::kLoop;
        const SurfaceGrid four = make_grid(*quietly(pyramid), n);
        CHECK(four.facets.size() == static_cast<std::size_t>(4 * n * n));
        CHECK(four.points.size() == static_cast<std::size_t>(2 * n * n + 2));
        // A prism over a pentagon: five quads that each meet two n-gons, so two of their sides have 2n
        // segments.
        const SurfaceGrid five = make_grid(*quietly(prism(5)), n);
        CHECK(five.facets.size() == static_cast<std::size_t>(5 * (2 * n * n + 2 * n) + 10 * 2 * n * n));
    }
}

TEST_CASE("The count of facets is that of the grid", "[surfaces]") {
    std::vector<std::pair<std::string, Cage>> cages = small_cages();
    if (data_missing("cages/catmark_pawn.obj"))
        WARN("without the cages of TRILENS_DATA_DIR");
    else
        for (const std::string& name : cage_files()) cages.emplace_back(name, read_cage(name));
    for (const auto& [name, cage] : cages)
        for (int n : {1, 2, 5}) {
            CAPTURE(name, n);
            const auto surface = quietly(cage);
            CHECK(count_facets(*surface, n) == make_grid(*surface, n).facets.size());
        }
}

TEST_CASE("A grid's parts have its facets, each once", "[surfaces][law]") {
    for (const auto& [name, cage] : small_cages())
        for (const auto& [n, steps] : {std::pair(1, 1), std::pair(5, 2), std::pair(6, 3), std::pair(4, 9)}) {
            CAPTURE(name, n, steps);
            const auto surface = quietly(cage);
            using Key = std::pair<Id, std::array<std::pair<double, double>, 3>>;
            const auto keys_of = [](const SurfaceGrid& grid, std::map<Key, int>& keys) {
                for (std::size_t f = 0; f < grid.facets.size(); ++f) {
                    Key key{grid.facet_face[f], {}};
                    for (std::size_t k = 0; k < 3; ++k)
                        key.second[k] = {grid.facet_uv[f][k].x, grid.facet_uv[f][k].y};
                    std::sort(key.second.begin(), key.second.end());
                    ++keys[key];
                }
            };
            std::map<Key, int> whole, in_parts;
            keys_of(make_grid(*surface, n), whole);
            std::size_t facets = 0;
            for (const GridPart& part : grid_parts(*surface, n, steps)) {
                const SurfaceGrid grid = make_part_grid(*surface, n, part);
                facets += grid.facets.size();
                keys_of(grid, in_parts);
                for (std::size_t f = 0; f < grid.facets.size(); ++f)
                    for (int k = 0; k < 3; ++k)
                        CHECK(grid.points[grid.corner_point[grid.facets[f][k]]] ==
                              surface->eval_first_order(grid.facet_face[f], grid.facet_uv[f][k]).position);
            }
            CHECK(in_parts.size() == facets);
            // Squares at split sides have more facets in the whole grid; where there is none they are the
            // same.
            std::size_t squares = 0;
            for (Id face = 0; face < surface->face_count(); ++face)
                squares += (surface->domain(face) == FaceDomain::kSquare ? 2U : 1U) *
                           static_cast<std::size_t>(n * n);
            CHECK(facets == squares);
            if (whole.size() == squares) CHECK(in_parts == whole);
        }
}

TEST_CASE("Corners lie on the surface where their (u, v) says, whichever face is asked", "[surfaces]") {
    std::vector<std::pair<std::string, Cage>> cages = small_cages();
    if (data_missing("cages/catmark_pawn.obj"))
        WARN("without the cages of TRILENS_DATA_DIR");
    else
        for (const std::string& name : cage_files()) cages.emplace_back(name, read_cage(name));
    for (const auto& [name, cage] : cages) {
        CAPTURE(name);
        const auto surface = quietly(cage);
        const SurfaceGrid grid = make_grid(*surface, 2);
        double worst = 0;
        for (std::size_t f = 0; f < grid.facets.size(); ++f)
            for (int k = 0; k < 3; ++k) {
                const Vec3& point = grid.points[grid.corner_point[grid.facets[f][k]]];
                worst = std::max(
                    worst, length(surface->eval(grid.facet_face[f], grid.facet_uv[f][k]).position - point));
            }
        CHECK(worst < 1e-9 * grid_spread(grid));
    }
}

TEST_CASE("Facets face the front: counter-clockwise seen from their normals' side", "[surfaces]") {
    std::vector<std::unique_ptr<Surface>> surfaces;
    for (const PrimitiveKind& kind :
         std::initializer_list<PrimitiveKind>{SpherePrimitive(), ParaboloidPrimitive(), CylinderPrimitive(),
                                              ConePrimitive(), PlanePrimitive()})
        surfaces.push_back(make_primitive_surface({.kind = kind}));
    for (const char* name : {"cube", "prism 5", "sheet"})
        for (const auto& [other, cage] : small_cages())
            if (other == name) surfaces.push_back(quietly(cage));
    std::size_t collapsed = 0;
    for (const auto& surface : surfaces) {
        const SurfaceGrid grid = make_grid(*surface, 8);
        for (const IdTriple& facet : grid.facets) {
            const auto point = [&](int k) { return grid.points[grid.corner_point[facet[k]]]; };
            const Vec3 chord = normalize_or_zero(cross(point(1) - point(0), point(2) - point(0)));
            if (chord == Vec3(0)) {
                CHECK((point(0) == point(1) || point(1) == point(2) || point(2) == point(0)));
                ++collapsed;
                continue;
            }
            for (Id corner : facet) {
                CHECK(std::abs(length(grid.corner_normal[corner]) - 1) < 1e-14);
                CHECK(dot(chord, grid.corner_normal[corner]) > 0.9);
            }
        }
    }
    CHECK(collapsed ==
          4 * 8);  // at the apex of the cone, whose four faces have one side there that is a point
}

TEST_CASE("Smooth surfaces have one normal per point", "[surfaces]") {
    const auto is_smooth = [](const Surface& surface) {
        const std::vector<int> count = normals_per_point(make_grid(surface, 4));
        return std::all_of(count.begin(), count.end(), [](int c) { return c == 1; });
    };
    CHECK(is_smooth(*quietly(cube())));
    CHECK(is_smooth(*quietly(prism(5))));
    CHECK(is_smooth(*quietly(prism(9))));
    CHECK(is_smooth(*make_primitive_surface(Primitive{})));
    Cage semi_sharp = cube();
    add_crease(semi_sharp, {4, 5, 7, 6, 4}, 3.5);
    CHECK(is_smooth(*quietly(semi_sharp)));
    if (data_missing("cages/catmark_torus.obj"))
        WARN("without the cages of TRILENS_DATA_DIR");
    else
        for (const char* name : {"catmark_torus", "catmark_gregory_test1", "catmark_pole64", "catmark_pawn",
                                 "loop_icosahedron"}) {
            CAPTURE(name);
            CHECK(is_smooth(*quietly(read_cage(name))));
        }
}

TEST_CASE("Sharp creases have a normal per side, and only they", "[surfaces]") {
    Cage creased = cube();
    add_crease(creased, {4, 5, 7, 6, 4}, 10);
    const int n = 4;
    const SurfaceGrid grid = make_grid(*quietly(creased), n);
    const std::vector<int> count = normals_per_point(grid);
    CHECK(std::count(count.begin(), count.end(), 2) == 4 * n);
    CHECK(std::count(count.begin(), count.end(), 1) == static_cast<long>(count.size()) - 4 * n);
    for (std::size_t point = 0; point < count.size(); ++point)
        if (count[point] == 2) CHECK(grid.points[point].z == Approx(1).margin(1e-12));

    Cage box = cube();
    box.scheme = SubdivisionScheme::kBilinear;
    const std::vector<int> sharp = normals_per_point(make_grid(*quietly(box), n));
    CHECK(std::count(sharp.begin(), sharp.end(), 3) == 8);
    CHECK(std::count(sharp.begin(), sharp.end(), 2) == 12 * (n - 1));
}

TEST_CASE("Squares are cut along the shorter diagonal", "[surfaces]") {
    const auto skewed = [](double x) {
        return make_cage({{0, 0, 0}, {1, 0, 0}, {1 + x, 1, 0}, {x, 1, 0}}, {{0, 1, 2, 3}});
    };
    const auto first_cut = [&](double x) {
        Cage cage = skewed(x);
        cage.scheme = SubdivisionScheme::kBilinear;
        const SurfaceGrid grid = make_grid(*quietly(cage), 1);
        return grid.facet_uv[0][0] == Vec2(0, 0) && grid.facet_uv[0][2] == Vec2(1, 1);
    };
    CHECK(first_cut(-0.5));
    CHECK(first_cut(0));  // a tie
    CHECK_FALSE(first_cut(0.5));
}

TEST_CASE("A grid is the same for any number of threads", "[surfaces][law]") {
    const auto surface = quietly(prism(5));
    const SurfaceGrid all = make_grid(*surface, 6);
    set_thread_count(1);
    const SurfaceGrid one = make_grid(*quietly(prism(5)), 6);
    set_thread_count(0);
    CHECK(all.points == one.points);
    CHECK(all.corner_point == one.corner_point);
    CHECK(all.corner_normal == one.corner_normal);
    CHECK(all.facets == one.facets);
}

TEST_CASE("A flat cage has a flat grid with exact normals", "[surfaces]") {
    Cage flat = sheet(3, 2);
    for (Vec3& p : flat.points) p.z = 0;
    const SurfaceGrid grid = make_grid(*quietly(flat), 5);
    for (const Vec3& normal : grid.corner_normal) CHECK(normal == Vec3(0, 0, 1));
    for (const Vec3& point : grid.points) CHECK(point.z == 0);
}
