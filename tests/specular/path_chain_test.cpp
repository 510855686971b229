// Chains of reflections and refractions: solutions obey the laws, and move as differences say.
#include "specular/chain/path_chain.h"

#include <array>
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

namespace {

constexpr double kMove = 1e-5;
/// How a film shows the first place of a path; any linear map does.
constexpr std::array<Vec3, 2> kSlope{Vec3(700, -30, 12), Vec3(5, 640, -40)};

/// The image's movement, pixels, as a chain is changed to either side and solved anew.
template <typename Change>
Vec2 moved_by_differences(const ChainExample& example, const ChainShape& shape, const Change& change) {
    std::array<Vec2, 2> pixel;
    for (const int side : {0, 1}) {
        ChainExample moved = example;
        for (std::size_t i = 0; i < moved.surfaces.size(); ++i)
            moved.chain.events[i].surface = &moved.surfaces[i];
        change(moved, side == 0 ? -kMove : kMove);
        const auto there = solve_chain(moved.chain, shape.at);
        REQUIRE(there);
        const Vec3& first = there->points[0].position;
        pixel[static_cast<std::size_t>(side)] = {dot(kSlope[0], first), dot(kSlope[1], first)};
    }
    return (pixel[1] - pixel[0]) / (2 * kMove);
}

void check_equal(const Vec2& found, const Vec2& expected) {
    CAPTURE(found.x, found.y, expected.x, expected.y);
    CHECK(length(found - expected) < 1e-6 * (1 + length(expected)));
}

}  // namespace

TEST_CASE("an image follows eye, surfaces and glass of its path as paths solved anew do", "[specular][law]") {
    int checked = 0;
    for (const bool mirrors : {false, true})
        for (std::size_t count = 1; count <= 6; ++count) {
            const ChainExample example = example_of(count, mirrors, 30 + static_cast<unsigned>(count));
            PathChain chain = example.chain;
            for (std::size_t i = 0; i < count; ++i) chain.events[i].surface = &example.surfaces[i];
            const auto shape = solve_chain(chain, example.start);
            if (!shape) continue;
            ++checked;
            CAPTURE(mirrors, count);
            const PathSensitivity sensitivity(chain, shape->points, kSlope);
            REQUIRE(sensitivity.is_light());
            REQUIRE(sensitivity.is_regular());
            const Vec3 by(0.3, -0.8, 0.5);
            check_equal(sensitivity.by_eye(by),
                        moved_by_differences(example, *shape, [&](auto& moved, double s) {
                            moved.chain.eye.place += s * by;
                        }));
            check_equal({dot(sensitivity.by_point()[0], by), dot(sensitivity.by_point()[1], by)},
                        moved_by_differences(example, *shape, [&](auto& moved, double s) {
                            moved.chain.point.place += s * by;
                        }));
            for (std::size_t i = 0; i < count; ++i) {
                const auto move = [&](ChainExample& moved, double s) {
                    moved.surfaces[i].move(s * Vec3(0.5, 0.2, -0.7), s * Vec4(0.4, -0.3, 0.6, 0.2));
                };
                ChainExample low = example, high = example;
                move(low, -kMove);
                move(high, kMove);
                const Vec2& uv = shape->at[i].uv;
                const Vec2 moved =
                    sensitivity.by_surface(i, low.surfaces[i].eval(0, uv), high.surfaces[i].eval(0, uv));
                check_equal(moved / (2 * kMove), moved_by_differences(example, *shape, move));
            }
            for (std::size_t stretch = 0; stretch <= count && !mirrors; ++stretch)
                check_equal(sensitivity.by_index(stretch, 1),
                            moved_by_differences(example, *shape, [&](auto& moved, double s) {
                                if (stretch > 0) moved.chain.events[stretch - 1].index_after += s;
                                if (stretch < count) moved.chain.events[stretch].index_before += s;
                            }));
        }
    CHECK(checked == 12);  // all
}

TEST_CASE("an image of parallel rays follows their direction, and that of a point at infinity",
          "[specular][law]") {
    for (const bool mirrors : {false, true}) {
        ChainExample example = example_of(2, mirrors, 91);
        for (std::size_t i = 0; i < 2; ++i) example.chain.events[i].surface = &example.surfaces[i];
        const auto seen = solve_chain(example.chain, example.start);
        REQUIRE(seen);
        const ChainBend bend = chain_bend(example.chain, seen->points);
        const Vec3 by(0.3, -0.8, 0.5);
        for (ChainEnd PathChain::*end : {&PathChain::eye, &PathChain::point}) {
            CAPTURE(mirrors, end == &PathChain::eye);
            ChainExample parallel = example;
            parallel.chain.*end = {end == &PathChain::eye ? bend.way[0] : bend.way[2], true};
            const auto shape = solve_chain(parallel.chain, seen->at);
            REQUIRE(shape);
            const PathSensitivity sensitivity(parallel.chain, shape->points, kSlope);
            const Vec2 found = end == &PathChain::eye ? sensitivity.by_eye(by)
                                                      : Vec2(dot(sensitivity.by_point()[0], by),
                                                             dot(sensitivity.by_point()[1], by));
            check_equal(found, moved_by_differences(parallel, *shape, [&](auto& moved, double s) {
                            (moved.chain.*end).place = normalize((moved.chain.*end).place + s * by);
                        }));
        }
    }
}
