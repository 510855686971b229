// Laws of conic arcs: on the conic, along the edge's true image, joined, bounded; the same for both users of
// an edge.
#include "trilinear/outline.h"

#include <algorithm>
#include <cmath>

#include "random_facets.h"
#include "support/test.h"

using namespace trilens;
using namespace trilens_test;

namespace {

// |w . form w| as a share of its terms.
double off_conic(const Mat3& form, const Vec3& w) {
    double value = 0, size = 0;
    for (int j = 0; j < 3; ++j) {
        for (int k = 0; k < 3; ++k) {
            value += w[j] * form[j][k] * w[k];
            size += std::fabs(w[j] * form[j][k] * w[k]);
        }
    }
    return size > 0 ? std::fabs(value) / size : 0;
}

// Calls visit(facet, triangle, side) for the curved sections of random shapes.
template <typename Visit>
void for_random_sections(std::uint64_t seed, int trials, const Visit& visit) {
    Random random(seed);
    for (int trial = 0; trial < trials; ++trial) {
        const FacetKind kind = static_cast<FacetKind>(trial % static_cast<int>(FacetKind::kCount));
        const TrilinearFacet rays = random_facet(random, kind);
        const Coplanarity facet = make_coplanarity(rays);
        const Vec3 seen = rays.point(random.weights(), random.log_uniform(0.1, 5));
        const SceneTriangle triangle{
            {seen + random.in_box(2), seen + random.in_box(2), seen + random.in_box(2)}};
        for (const Window& window : view_windows(facet, triangle)) {
            for (const Shape& shape : make_shapes(facet, triangle, window)) {
                for (std::size_t i = 0; i < shape.size(); ++i) {
                    if (shape[i].edge == kSlice) continue;
                    visit(facet, triangle,
                          Section{shape[i].at, shape[(i + 1) % shape.size()].at, shape[i].edge});
                }
            }
        }
    }
}

}  // namespace

TEST_CASE("conic arcs: the conic is where rays meet the edge's line", "[trilinear][conic_arc]") {
    Random random(1);
    double worst = 0;
    for (int trial = 0; trial < 20000; ++trial) {
        const double scale = random.log_uniform(1e-4, 1e4);
        TrilinearFacet facet = random_facet(random, FacetKind::kGeneral);
        for (Ray& r : facet.corner) r.origin *= scale, r.direction *= scale;
        // A line through a point of a known ray.
        const Vec3 w = random.weights(), point = facet.point(w, random.uniform(0.1, 3));
        const Vec3 along = scale * random.in_box(1);
        const Vec3 a = point - random.uniform(0, 1) * along, b = a + along;
        const Mat3 form = conic_form(make_coplanarity(facet), a, b);
        worst = std::max(worst, off_conic(form, w));
        if (form != -conic_form(make_coplanarity(facet), b, a)) FAIL("turned edge at trial " << trial);
    }
    CHECK(worst < 1e-9);
}

TEST_CASE("conic arcs: sampled points lie on the conic and on the edge's image", "[trilinear][conic_arc]") {
    int arcs = 0, most = 0, sections = 0;
    double worst_conic = 0, worst_far = 0, worst_place = 0, worst_join = 0;
    for_random_sections(
        2, 3000, [&](const Coplanarity& facet, const SceneTriangle& triangle, const Section& side) {
            const std::size_t edge = static_cast<std::size_t>(side.edge);
            const std::vector<ConicArc> found = edge_arcs(facet, triangle, side);
            const Vec3 &a = triangle.from(edge), &b = triangle.to(edge);
            const Mat3 form = conic_form(facet, a, b);
            if (found.empty()) FAIL("no arcs");
            const auto [t0, t1] = std::minmax(side.from.t, side.to.t);
            if (found.front().t0 != t0 || found.back().t1 != t1) FAIL("ends of t");
            ++sections, arcs += static_cast<int>(found.size()),
                most = std::max(most, static_cast<int>(found.size()));
            for (std::size_t i = 0; i < found.size(); ++i) {
                const ConicArc& arc = found[i];
                if (i > 0)
                    worst_join = std::max(worst_join, length(found[i - 1].control[2] - arc.control[0]));
                if (arc.t1 < arc.t0) FAIL("t turns back");
                const double bezier = arc.control[1].x + arc.control[1].y + arc.control[1].z;
                if (bezier < kLeastBezierWeight) FAIL("Bezier weight " << bezier);
                for (const double u : {0.1, 0.35, 0.5, 0.8}) {
                    const Vec3 w = arc.weights(u);
                    double& worst = length(w) < 100 ? worst_conic : worst_far;
                    worst = std::max(worst, off_conic(form, w));
                }
                // A second answer: the cut of the edge at the shoulder's t.
                const std::array<ConicArc, 2> half = halves(arc, facet, a, b);
                const Vec3 shoulder = half[0].control[2];
                const auto cut = edge_cut(facet, triangle, edge, half[0].t1);
                // Where the curve runs along the rays' own t a small t is a long way; compare where it does
                // not.
                if (cut && length(shoulder) < 10 && arc.t1 - arc.t0 > 1e-6 * arc.t1) {
                    worst_place = std::max(worst_place, length(cut->weights - shoulder));
                }
            }
        });
    WARN(arcs << " arcs in " << sections << " sections, at most " << most << "; off the conic " << worst_conic
              << ", far away " << worst_far << ", off the cut " << worst_place);
    CHECK(sections > 3000);
    CHECK(arcs < 4 * sections);
    CHECK(worst_conic < 1e-9);
    CHECK(worst_far < 1e-6);  // flat arcs near a collapse, thousands of facets away
    CHECK(worst_place < 1e-5);
    CHECK(worst_join == 0);
}

TEST_CASE("conic arcs: two triangles that share an edge get the same arcs", "[trilinear][conic_arc]") {
    for_random_sections(
        3, 500, [&](const Coplanarity& facet, const SceneTriangle& triangle, const Section& side) {
            const std::size_t edge = static_cast<std::size_t>(side.edge);
            const SceneTriangle turned{{triangle.to(edge), triangle.from(edge), Vec3(7, 8, 9)}};
            const std::vector<ConicArc> one = edge_arcs(facet, triangle, side);
            const std::vector<ConicArc> other = edge_arcs(facet, turned, {side.to, side.from, 0});
            REQUIRE(one.size() == other.size());
            for (std::size_t i = 0; i < one.size(); ++i) {
                if (one[i].control != other[i].control) FAIL("arc " << i);
            }
        });
}

TEST_CASE("conic arcs: halving converges to the curve, and the screen keeps it",
          "[trilinear][conic_arc][law]") {
    const Mat3 screen(Vec3(10, 20, 1), Vec3(600, 40, 2), Vec3(100, 900, 3));
    for_random_sections(
        4, 300, [&](const Coplanarity& facet, const SceneTriangle& triangle, const Section& side) {
            const std::size_t edge = static_cast<std::size_t>(side.edge);
            for (const ConicArc& arc : edge_arcs(facet, triangle, side)) {
                const Vec3 &a = triangle.from(edge), &b = triangle.to(edge);
                const std::array<ConicArc, 2> half = halves(arc, facet, a, b);
                // Quarter the sagitta, in the limit; never more than 0.6 of it for arcs of this Bezier weight
                // and more.
                CHECK(sagitta(half[0]) + sagitta(half[1]) <=
                      1.2 * sagitta(arc) + 1e-12 * length(arc.control[0]));
                const std::array<Vec3, 3> c = on_screen(arc, screen);
                const double u = 0.3;
                const Vec3 p = (1 - u) * (1 - u) * c[0] + 2 * u * (1 - u) * c[1] + u * u * c[2];
                const Vec3 q = screen * arc.weights(u);
                const double size = length(c[0]) + length(c[1]) + length(c[2]);
                CHECK(length(cross(p, q)) <= 1e-10 * size * length(q));
            }
        });
}
