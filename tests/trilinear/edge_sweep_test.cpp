// Laws of the swept surface: its degree, its crossings against the conic and the curve, the same bits for
// both users.
#include "trilinear/facet/scene_edge.h"

#include <algorithm>
#include <cmath>

#include "random_facets.h"
#include "support/test.h"
#include "trilinear/outline.h"

using namespace trilens;
using namespace trilens_test;

namespace {

struct Pair {
    Ray first, second;
    Vec3 a, b;
};

// Half of them made to cross.
Pair random_pair(Random& random, bool crossing) {
    Pair p{{random.in_box(1), random.in_box(1)},
           {random.in_box(1), random.in_box(1)},
           random.in_box(3),
           random.in_box(3)};
    if (random.below(5) == 0)
        p.second.origin = p.first.origin;
    else if (random.below(4) == 0)
        p.second.direction = p.first.direction;
    if (!crossing) return p;
    const double u = random.uniform(0, 1), t = random.uniform(0, 3), s = random.uniform(0.1, 0.9);
    const Vec3 point =
        (1 - u) * (p.first.origin + t * p.first.direction) + u * (p.second.origin + t * p.second.direction);
    p.b = p.a + (point - p.a) / s;
    return p;
}

double determinant(const Pair& p, double t) {
    return triple(p.first.origin + t * p.first.direction - p.a,
                  p.second.origin + t * p.second.direction - p.a, p.b - p.a);
}

}  // namespace

TEST_CASE("edge sweep: the coplanarity of a scene edge and a facet's edge is quadratic in t",
          "[trilinear][edge_sweep]") {
    Random random(1);
    double worst = 0, third = 0;
    for (int trial = 0; trial < 10000; ++trial) {
        const Pair p = random_pair(random, trial % 2 == 0);
        const std::array<double, 3> q = sweep_quadratic(p.first, p.second, p.a, p.b);
        const double t = random.uniform(-3, 3);
        const double size = 200 * length(p.b - p.a) + 1;
        worst = std::max(worst, std::fabs((q[2] * t + q[1]) * t + q[0] - determinant(p, t)) / size);
        // A cubic would have a third difference; two moving columns of three leave none.
        const double difference =
            determinant(p, 3) - 3 * determinant(p, 2) + 3 * determinant(p, 1) - determinant(p, 0);
        third = std::max(third, std::fabs(difference) / size);
    }
    CHECK(worst < 1e-14);
    CHECK(third < 1e-14);
}

TEST_CASE("edge sweep: a crossing lies on the scene edge and on the ray", "[trilinear][edge_sweep]") {
    Random random(2);
    int planted = 0;
    for (int trial = 0; trial < 20000; ++trial) {
        const Pair p = random_pair(random, true);
        bool found = false;
        for (const SweepCrossing& c : sweep_crossings(p.first, p.second, p.a, p.b)) {
            const Vec3 on_ray = c.on_first * (p.first.origin + c.t * p.first.direction) +
                                c.on_second * (p.second.origin + c.t * p.second.direction);
            const Vec3 on_edge = c.on_a * p.a + c.on_b * p.b;
            const double size = (1 + std::fabs(c.t)) * (1 + std::fabs(c.on_second)) +
                                (1 + std::fabs(c.on_b)) * length(p.b - p.a) + 3;
            if (length(on_ray - on_edge) > 1e-12 * size)
                FAIL("trial " << trial << " off by " << length(on_ray - on_edge));
            found |= c.t > -1e-6 && c.t < 3 + 1e-6 && c.on_second > -1e-6 && c.on_second < 1 + 1e-6 &&
                     c.on_b > 0 && c.on_b < 1;
        }
        planted += found;
    }
    // Missed are only double roots that rounding made complex, and parallel edges.
    CHECK(planted >= 19990);
}

TEST_CASE("edge sweep: crossings are where the conic meets the facet's edge", "[trilinear][edge_sweep]") {
    // Independent: on the side w0 = 0 the conic is a quadratic in u alone.
    Random random(3);
    int compared = 0;
    for (int trial = 0; trial < 5000; ++trial) {
        const TrilinearFacet facet = random_facet(random, FacetKind::kGeneral);
        const Vec3 a = random.in_box(3), b = random.in_box(3);
        const Mat3 f = conic_form(make_coplanarity(facet), a, b);
        const double q0 = f[1][1], q1 = 2 * (f[1][2] - f[1][1]), q2 = f[1][1] - 2 * f[1][2] + f[2][2];
        const double discriminant = q1 * q1 - 4 * q0 * q2;
        const SweepCrossings crossings = sweep_crossings(facet.corner[1], facet.corner[2], a, b);
        if (std::fabs(discriminant) < 1e-6 * (q1 * q1 + std::fabs(q0 * q2)) || std::fabs(q2) < 1e-6) continue;
        REQUIRE(crossings.count == (discriminant > 0 ? 2 : 0));
        for (const SweepCrossing& c : crossings) {
            const double nearest =
                std::min(std::fabs(c.on_second - (-q1 - std::sqrt(discriminant)) / (2 * q2)),
                         std::fabs(c.on_second - (-q1 + std::sqrt(discriminant)) / (2 * q2)));
            if (nearest > 1e-6 * (1 + c.on_second * c.on_second))
                FAIL("trial " << trial << " apart " << nearest);
            ++compared;
        }
    }
    CHECK(compared > 4000);
}

TEST_CASE("edge sweep: exchanging the ends of either edge changes no bit", "[trilinear][edge_sweep][law]") {
    Random random(4);
    for (int trial = 0; trial < 5000; ++trial) {
        const Pair p = random_pair(random, trial % 2 == 0);
        const SweepCrossings one = sweep_crossings(p.first, p.second, p.a, p.b);
        const SweepCrossings turned = sweep_crossings(p.second, p.first, p.b, p.a);
        REQUIRE(one.count == turned.count);
        for (std::size_t i = 0; i < static_cast<std::size_t>(one.count); ++i) {
            const SweepCrossing &x = one.crossing[i], &y = turned.crossing[i];
            if (x.t != y.t || x.on_first != y.on_second || x.on_second != y.on_first || x.on_a != y.on_b ||
                x.on_b != y.on_a) {
                FAIL("trial " << trial);
            }
        }
    }
}
