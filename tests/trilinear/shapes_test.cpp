// Laws of shapes: the census of table 4.1, the joining rule against the sides themselves, shared vertices.
#include "trilinear/outline.h"

#include <algorithm>
#include <map>
#include <set>
#include <sstream>
#include <string>

#include "random_facets.h"
#include "support/test.h"

using namespace trilens;
using namespace trilens_test;

namespace {

// "3,1,1: 3 2" from roots per vertex and vertices per shape, both in descending order.
std::string configuration(const std::array<RealRoots, 3>& roots, const std::vector<Shape>& shapes) {
    std::vector<int> r, v;
    for (const RealRoots& k : roots) r.push_back(k.count);
    for (const Shape& s : shapes) v.push_back(static_cast<int>(s.size()));
    std::sort(r.rbegin(), r.rend()), std::sort(v.rbegin(), v.rend());
    std::ostringstream text;
    text << r[0] << r[1] << r[2] << ":";
    for (const int n : v) text << " " << n;
    return text.str();
}

const std::set<std::string> kTable{"111: 3",   "311: 3 2", "311: 5",     "331: 4 3",   "331: 3 2 2",
                                   "331: 7",   "331: 5 2", "333: 3 3 3", "333: 4 3 2", "333: 6 3",
                                   "333: 7 2", "333: 9",   "333: 5 4",   "333: 5 2 2", "333: 3 2 2 2"};

SceneTriangle random_triangle(Random& random, double reach) {
    return {{random.in_box(reach), random.in_box(reach), random.in_box(reach)}};
}

std::map<std::string, int> census(std::uint64_t seed, int pairs) {
    Random random(seed);
    std::map<std::string, int> count;
    for (int i = 0; i < pairs; ++i) {
        const Coplanarity facet = make_coplanarity(random_facet(random, FacetKind::kGeneral));
        const SceneTriangle triangle = random_triangle(random, random.log_uniform(0.1, 10));
        ++count[configuration(project_vertices(facet, triangle), make_shapes(facet, triangle))];
    }
    std::ostringstream table;
    for (const auto& [name, n] : count) table << "\n  " << name << "  " << 100.0 * n / pairs << " %";
    WARN(pairs << " pairs" << table.str());
    return count;
}

void check_census(const std::map<std::string, int>& count) {
    for (const auto& [name, n] : count) {
        INFO(name << " occurs " << n << " times");
        CHECK(kTable.count(name) == 1);
    }
    for (const std::string& name : kTable) {
        INFO(name);
        CHECK(count.count(name) == 1);
    }
}

}  // namespace

TEST_CASE("shapes: all fifteen configurations of table 4.1 and no other", "[trilinear][shapes]") {
    check_census(census(1, 60000));
}

TEST_CASE("shapes: the census of a million pairs", "[.long]") {
    check_census(census(2, 1000000));
}

TEST_CASE("shapes: the joining rule is what the sides of the scene vertices say", "[trilinear][shapes]") {
    // Independent of joining: at each t the triangle is cut where its vertices lie on different sides;
    // between two roots the cut edges are those whose ends differ, and these are the edges a shape runs along
    // there.
    Random random(3);
    for (int trial = 0; trial < 5000; ++trial) {
        const Coplanarity facet = make_coplanarity(random_facet(random, FacetKind::kGeneral));
        const SceneTriangle triangle = random_triangle(random, random.log_uniform(0.1, 10));
        std::vector<double> t;
        for (const RealRoots& roots : project_vertices(facet, triangle))
            t.insert(t.end(), roots.begin(), roots.end());
        std::sort(t.begin(), t.end());
        const std::vector<Shape> shapes = make_shapes(facet, triangle);
        for (std::size_t i = 0; i + 1 < t.size(); ++i) {
            const double middle = 0.5 * (t[i] + t[i + 1]);
            if (t[i + 1] - t[i] < 1e-6 * (std::fabs(t[i]) + std::fabs(t[i + 1]))) continue;
            for (std::size_t e = 0; e < 3; ++e) {
                const bool cut = (side_of_parametric_triangle(facet, middle, triangle.from(e)) > 0) !=
                                 (side_of_parametric_triangle(facet, middle, triangle.to(e)) > 0);
                int runs = 0;
                for (const Shape& shape : shapes) {
                    for (std::size_t k = 0; k < shape.size(); ++k) {
                        const double a = shape[k].at.t, b = shape[(k + 1) % shape.size()].at.t;
                        if (shape[k].edge == static_cast<int>(e)) runs += (a < middle) != (b < middle);
                    }
                }
                if (runs != (cut ? 1 : 0)) FAIL("trial " << trial << " edge " << e << " runs " << runs);
            }
        }
    }
}

TEST_CASE("shapes: every vertex is where its ray meets its scene vertex", "[trilinear][shapes][law]") {
    Random random(4);
    double worst = 0;
    int vertices = 0;
    for (int trial = 0; trial < 20000; ++trial) {
        const FacetKind kind = static_cast<FacetKind>(trial % static_cast<int>(FacetKind::kCount));
        const TrilinearFacet facet = random_facet(random, kind);
        const Coplanarity cubic = make_coplanarity(facet);
        const SceneTriangle triangle = random_triangle(random, 3);
        for (const Window& window : view_windows(cubic, triangle)) {
            for (const Shape& shape : make_shapes(cubic, triangle, window)) {
                REQUIRE(shape.size() >= 2);
                for (const ShapeVertex& v : shape) {
                    if (v.at.t < window.begin || v.at.t > window.end)
                        FAIL("outside the window at trial " << trial);
                    const Vec3 on_ray = facet.point(v.at.weights, v.at.t),
                               on_triangle = triangle.point(v.at.barycentric);
                    const double size = length(glm::abs(v.at.weights)) * (1 + std::fabs(v.at.t)) * 4;
                    // Near a collapse weights are large and lose digits in proportion.
                    if (length(v.at.weights) < 1e3)
                        worst = std::max(worst, length(on_ray - on_triangle) / size), ++vertices;
                }
            }
        }
    }
    CHECK(worst < 1e-7);
    CHECK(vertices > 10000);
}

TEST_CASE("shapes: neighbouring triangles have the same vertices on their common edge, bit by bit",
          "[trilinear][shapes][law]") {
    Random random(5);
    for (int trial = 0; trial < 5000; ++trial) {
        const Coplanarity facet = make_coplanarity(random_facet(random, FacetKind::kGeneral));
        const SceneTriangle one = random_triangle(random, 3);
        const SceneTriangle other{{one.corner[1], one.corner[0], random.in_box(3)}};
        const auto vertices = [&](const SceneTriangle& triangle) {
            std::set<std::array<double, 4>> found;
            for (const Shape& shape : make_shapes(facet, triangle, {0, 100})) {
                for (const ShapeVertex& v : shape) {
                    if (v.at.barycentric[2] == 0 && v.at.t > 0 && v.at.t < 100) {
                        found.insert({v.at.t, v.at.weights.x, v.at.weights.y, v.at.weights.z});
                    }
                }
            }
            return found;
        };
        if (vertices(one) != vertices(other)) FAIL("roots at trial " << trial);
        for (const double t : {0.0, 0.7}) {
            const auto a = edge_cut(facet, one, 0, t), b = edge_cut(facet, other, 0, t);
            REQUIRE(a.has_value());
            if (a->weights != b->weights || a->barycentric.x != b->barycentric.y)
                FAIL("cut at trial " << trial);
        }
    }
}

TEST_CASE("shapes: a pinhole makes one shape of three vertices, where perspective puts them",
          "[trilinear][shapes]") {
    Random random(6);
    int seen = 0;
    for (int trial = 0; trial < 5000; ++trial) {
        const TrilinearFacet facet = random_facet(random, FacetKind::kPinhole);
        const Coplanarity cubic = make_coplanarity(facet);
        SceneTriangle triangle;
        for (Vec3& c : triangle.corner) c = facet.point(random.weights(), random.uniform(0.5, 3));
        const std::vector<Window> windows = view_windows(cubic, triangle);
        REQUIRE(windows.size() == 1);
        const std::vector<Shape> shapes = make_shapes(cubic, triangle, windows[0]);
        REQUIRE(shapes.size() == 1);
        REQUIRE(shapes[0].size() == 3);
        for (const ShapeVertex& v : shapes[0]) {
            ++seen;
            REQUIRE(v.corner >= 0);
            CHECK(std::min({v.at.weights.x, v.at.weights.y, v.at.weights.z}) > -1e-9);
        }
    }
    CHECK(seen == 15000);
}

TEST_CASE("view windows: a collapse is left out, and only there", "[trilinear][view_plane]") {
    // Rays that converge in one point at t = 2 and spread again.
    TrilinearFacet facet;
    const Vec3 focus(0.3, 0.1, 2);
    const Vec3 o[3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    for (std::size_t k = 0; k < 3; ++k) facet.corner[k] = {o[k], 0.5 * (focus - o[k])};
    const SceneTriangle triangle{{Vec3(-1, -1, 1), Vec3(2, 0, 3), Vec3(0, 2, 5)}};
    const std::vector<Window> windows = view_windows(make_coplanarity(facet), triangle);
    REQUIRE(windows.size() == 2);
    CHECK(windows[0].begin == 0);
    CHECK(windows[0].end == Approx(2).epsilon(1e-5));
    CHECK(windows[0].end < 2);
    CHECK(windows[1].begin > 2);
    CHECK(windows[1].begin == Approx(2).epsilon(1e-5));
    CHECK(windows[1].end > 5);

    Random random(7);
    int several = 0;
    for (int trial = 0; trial < 2000; ++trial) {
        const Coplanarity general = make_coplanarity(random_facet(random, FacetKind::kGeneral));
        several += view_windows(general, random_triangle(random, 3)).size() != 1;
    }
    CHECK(several == 0);
    CHECK(view_windows(make_coplanarity(TrilinearFacet{}), triangle).empty());
}
