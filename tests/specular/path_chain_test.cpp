// Chains of reflections and refractions: solutions obey the laws, and move as differences say.
#include "specular/chain/path_chain.h"

#include <cmath>
#include <random>

#include "specular/cubic_chains.h"
#include "support/test.h"

using namespace trilens;
using namespace trilens_test;

TEST_CASE("chains of one to six surfaces obey the laws of reflection and refraction at each",
          "[specular][law]") {
    int solved = 0;
    for (const bool mirrors : {false, true})
        for (std::size_t count = 1; count <= 6; ++count)
            for (unsigned seed = 0; seed < 6; ++seed) {
                ChainExample example = example_of(count, mirrors, 10 * static_cast<unsigned>(count) + seed);
                const auto shape = solve_chain(example.chain, example.start);
                if (!shape) continue;
                ++solved;
                CAPTURE(mirrors, count, seed);
                Vec3 from = example.chain.eye.place;
                for (std::size_t i = 0; i < count; ++i) {
                    const Vec3 at = shape->points[i].position, n = shape->points[i].normal;
                    const Vec3 to = i + 1 < count ? shape->points[i + 1].position : example.chain.point.place;
                    const Vec3 in = normalize(at - from), out = normalize(to - at);
                    const ChainEvent& event = example.chain.events[i];
                    // Snell: n1 sin = n2 sin in one plane; of mirrors both indices are one.
                    CHECK(length(event.index_before * cross(n, in) - event.index_after * cross(n, out)) <
                          1e-12);
                    CHECK((dot(in, n) * dot(out, n) < 0) == event.reflects);
                    from = at;
                }
            }
    CHECK(solved == 72);  // all
}

TEST_CASE("a chain moves with its point as its Hessian says", "[specular][law]") {
    for (const bool mirrors : {false, true})
        for (std::size_t count = 1; count <= 5; ++count) {
            ChainExample example = example_of(count, mirrors, 70 + static_cast<unsigned>(count));
            const auto shape = solve_chain(example.chain, example.start);
            if (!shape) continue;
            CAPTURE(mirrors, count);
            const ChainHessian hessian(example.chain, chain_bend(example.chain, shape->points),
                                       shape->points);
            REQUIRE(hessian.is_regular());
            constexpr double kStep = 1e-5;
            const Vec3 by(0.3, -0.8, 0.5);
            std::vector<PerEvent<Vec2>> law;
            std::vector<std::vector<Vec2>> place;
            for (const double sign : {1.0, -1.0}) {
                PathChain moved = example.chain;
                moved.point.place += sign * kStep * by;
                law.push_back(chain_law(chain_bend(moved, shape->points), shape->points));
                const auto there = solve_chain(moved, shape->at);
                REQUIRE(there);
                std::vector<Vec2> uv;
                for (const SurfaceParameter& at : there->at) uv.push_back(at.uv);
                place.push_back(uv);
            }
            std::vector<Vec2> right;
            for (std::size_t i = 0; i < count; ++i) right.push_back((law[1][i] - law[0][i]) / (2 * kStep));
            const PerEvent<Vec2> expected = hessian.solve(right);
            for (std::size_t i = 0; i < count; ++i) {
                const Vec2 found = (place[0][i] - place[1][i]) / (2 * kStep);
                CHECK(length(found - expected[i]) < 1e-6 * (1 + length(expected[i])));
            }
        }
}
