// Proofs that boxes hold one path of light, against Newton's method from many places in them.
#include "specular/chain/path_chain.h"

#include <cmath>
#include <random>

#include "specular/cubic_chains.h"
#include "support/test.h"

using namespace trilens;
using namespace trilens_test;

namespace {

/// Boxes around places of a chain's surfaces.
struct PlacedBox {
    std::vector<Vec2> middle, half;

    ChainBox over(const ChainExample& example) const {
        ChainBox box;
        for (std::size_t i = 0; i < middle.size(); ++i) {
            box.bounds.push_back(example.surfaces[i].bounds(middle[i], half[i]));
            box.half.push_back(half[i]);
        }
        return box;
    }
    bool holds(const ChainShape& shape) const {
        for (std::size_t i = 0; i < middle.size(); ++i)
            for (int axis = 0; axis < 2; ++axis)
                if (!(std::fabs(shape.at[i].uv[axis] - middle[i][axis]) <= half[i][axis])) return false;
        return true;
    }
};

PlacedBox small_box(const ChainShape& shape) {
    PlacedBox box;
    for (const SurfaceParameter& at : shape.at) {
        box.middle.push_back(at.uv);
        box.half.emplace_back(1e-5);
    }
    return box;
}

double distance_of(const ChainShape& a, const ChainShape& b) {
    double most = 0;
    for (std::size_t i = 0; i < a.at.size(); ++i) most = std::max(most, length(a.at[i].uv - b.at[i].uv));
    return most;
}

/// The solutions that Newton's method finds in the boxes, from places spread over them.
std::vector<ChainShape> found_in(const ChainExample& example, const PlacedBox& box, std::mt19937& random) {
    constexpr int kStarts = 40;
    constexpr double kSame = 1e-8;
    std::uniform_real_distribution<double> draw(-1, 1);
    std::vector<ChainShape> found;
    for (int start = 0; start < kStarts; ++start) {
        std::vector<SurfaceParameter> at;
        for (std::size_t i = 0; i < box.middle.size(); ++i)
            at.push_back({0, box.middle[i] + box.half[i] * Vec2(draw(random), draw(random))});
        const auto shape = solve_chain(example.chain, at);
        if (!shape || !box.holds(*shape)) continue;
        if (std::ranges::none_of(found,
                                 [&](const ChainShape& one) { return distance_of(one, *shape) < kSame; }))
            found.push_back(*shape);
    }
    return found;
}

/// A hollow mirror seen from about its centre of curvature, where it shows a point up to four times.
ChainExample hollow_mirror(unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> draw(-1, 1);
    ChainExample example;
    const double bend = 1 + 0.2 * draw(random);
    example.surfaces.emplace_back(Vec3(0), Mat3(1),
                                  Vec4(bend, 0.3 * draw(random), bend * (1 + 0.3 * draw(random)),
                                       (seed % 2 == 0 ? 1 : 8) * draw(random)));
    example.chain.events.push_back({&example.surfaces[0], 1, 1, true});
    const double centre = 1 / (2 * bend);
    example.chain.eye.place = {0.05 * draw(random), 0.05 * draw(random), centre * (1 + 0.3 * draw(random))};
    example.chain.point.place = {0.05 * draw(random), 0.05 * draw(random), centre * (1 + 0.3 * draw(random))};
    example.start.push_back({0, Vec2(0.5)});
    return example;
}

}  // namespace

TEST_CASE("a small box around a path of one to four surfaces is proven to hold it, one beside it is not",
          "[specular][law]") {
    int solved = 0, proven = 0;
    for (const bool mirrors : {false, true})
        for (std::size_t count = 1; count <= 4; ++count)
            for (unsigned seed = 0; seed < 12; ++seed) {
                const ChainExample example =
                    example_of(count, mirrors, 100 * static_cast<unsigned>(count) + seed);
                const auto shape = solve_chain(example.chain, example.start);
                if (!shape) continue;
                ++solved;
                CAPTURE(mirrors, count, seed);
                PlacedBox box = small_box(*shape);
                proven += holds_one_path(example.chain, box.over(example));
                box.middle.back().x += 2e-5;
                CHECK_FALSE(holds_one_path(example.chain, box.over(example)));
                // A path that would be mirrored where it goes through, or the other way round, is none.
                box.middle.back().x -= 2e-5;
                PathChain other = example.chain;
                other.events.back().reflects = !mirrors;
                CHECK_FALSE(holds_one_path(other, box.over(example)));
            }
    CHECK(solved == 96);
    CHECK(proven == solved);
}

TEST_CASE("paths to a point at infinity, and of parallel rays, are proven, too", "[specular][law]") {
    int solved = 0;
    for (const bool mirrors : {false, true})
        for (const bool parallel : {false, true})
            for (unsigned seed = 0; seed < 8; ++seed) {
                ChainExample example = example_of(2, mirrors, 40 + seed);
                ChainEnd& end = parallel ? example.chain.eye : example.chain.point;
                end = {normalize(Vec3(0.02, -0.03, 1)), true};
                const auto shape = solve_chain(example.chain, example.start);
                if (!shape) continue;
                ++solved;
                CAPTURE(mirrors, parallel, seed);
                PlacedBox box = small_box(*shape);
                CHECK(holds_one_path(example.chain, box.over(example)));
                box.middle.front().y += 2e-5;
                CHECK_FALSE(holds_one_path(example.chain, box.over(example)));
            }
    CHECK(solved >= 30);
}

TEST_CASE("where a box is proven to hold one path, Newton's method finds that one and no other",
          "[specular][law]") {
    std::mt19937 random(5);
    std::uniform_real_distribution<double> draw(-1, 1);
    int proven = 0, asked = 0, several = 0, large = 0;
    const auto ask = [&](const ChainExample& example) {
        const auto shape = solve_chain(example.chain, example.start);
        if (!shape) return;
        for (int k = 0; k < 12; ++k) {
            const double half = std::exp2(-1 - 12 * std::fabs(draw(random)));
            PlacedBox box;
            for (const SurfaceParameter& at : shape->at) {
                box.half.emplace_back(half);
                box.middle.push_back(
                    glm::clamp(at.uv + 0.9 * half * Vec2(draw(random), draw(random)), half, 1 - half));
            }
            ++asked;
            const std::vector<ChainShape> found = found_in(example, box, random);
            several += found.size() > 1;
            if (!holds_one_path(example.chain, box.over(example))) continue;
            ++proven;
            large += half > 0.01;
            CAPTURE(half, box.middle[0].x, box.middle[0].y);
            CHECK(found.size() == 1);
        }
    };
    for (unsigned seed = 0; seed < 60; ++seed) ask(hollow_mirror(seed));
    for (const bool mirrors : {false, true})
        for (std::size_t count = 1; count <= 3; ++count)
            for (unsigned seed = 0; seed < 8; ++seed)
                ask(example_of(count, mirrors, 700 + 10 * static_cast<unsigned>(count) + seed));
    CAPTURE(asked, proven, several, large);
    CHECK(proven > asked / 8);
    CHECK(several > 30);
    CHECK(large > 20);
}

TEST_CASE("second derivatives of the optical path stay within their radii over a box, and come near them",
          "[specular][law]") {
    std::mt19937 random(11);
    std::uniform_real_distribution<double> draw(-1, 1);
    double nearest = 0;
    const auto ask = [&](const ChainExample& example) {
        const double half = std::exp2(-2 - 10 * std::fabs(draw(random)));
        PlacedBox box;
        for (std::size_t i = 0; i < example.surfaces.size(); ++i) {
            box.half.emplace_back(half);
            box.middle.push_back(Vec2(0.5) + 0.2 * Vec2(draw(random), draw(random)));
        }
        const std::vector<double> radii = second_derivative_radii(example.chain, box.over(example));
        if (radii.empty()) return;
        const auto derivatives_at = [&](double away) {
            std::vector<SurfacePoint> points;
            for (std::size_t i = 0; i < box.middle.size(); ++i)
                points.push_back(example.surfaces[i].eval(
                    0, box.middle[i] + away * box.half[i] * Vec2(draw(random), draw(random))));
            return chain_second_derivatives(example.chain, chain_bend(example.chain, points), points);
        };
        const ChainMatrix middle = derivatives_at(0);
        for (int k = 0; k < 30; ++k) {
            const ChainMatrix there = derivatives_at(1);
            for (std::size_t j = 0; j < there.size(); ++j) {
                const double change = std::fabs(there[j] - middle[j]);
                CAPTURE(half, j, change, radii[j]);
                REQUIRE(change <= radii[j] + 1e-13);
                if (radii[j] > 0) nearest = std::max(nearest, change / radii[j]);
            }
        }
    };
    for (unsigned seed = 0; seed < 200; ++seed) {
        ask(hollow_mirror(seed));
        ask(example_of(1 + seed % 4, seed % 8 < 4, seed));
    }
    CHECK(nearest > 0.2);
}
