// Patches: where they show points, and where they cannot.
#include "measure/patch.h"

#include <cmath>
#include <random>

#include "support/test.h"

using namespace trilens;

namespace {

/// 4 x 4 points of a surface that bends and is rough as asked, somewhere in space, of any scale.
Patch random_patch(std::mt19937_64& random) {
    std::normal_distribution<double> normal;
    const auto vector = [&] { return Vec3(normal(random), normal(random), normal(random)); };
    const auto power = [&](double low, double high) {
        return std::pow(10.0, std::uniform_real_distribution<double>(low, high)(random));
    };
    const double scale = power(-3, 3), bend = power(-3, 0),
                 rough = random() % 3 ? power(-6, -1) : power(-1, 1);
    const Vec3 centre = power(-1, 2) * scale * vector(), du = vector(), dv = vector();
    const Vec3 duu = bend * vector(), duv = bend * vector(), dvv = bend * vector();
    Patch patch;
    for (int node = 0; node < 16; ++node) {
        const double u = node % 4 - 1.0, v = node / 4 - 1.0;
        patch.nodes[static_cast<std::size_t>(node)] =
            centre + scale * (u * du + v * dv + u * u * duu + u * v * duv + v * v * dvv + rough * vector());
    }
    patch.measured = patch.supported = static_cast<std::uint16_t>(random());
    return patch;
}

bool holds(const Box& box, const Vec3& p) {
    return p.x >= box.low.x && p.y >= box.low.y && p.z >= box.low.z && p.x <= box.high.x &&
           p.y <= box.high.y && p.z <= box.high.z;
}

}  // namespace

TEST_CASE("a patch answers for no point outside its reach", "[measure][displacement]") {
    std::mt19937_64 random(1);
    std::uniform_real_distribution<double> share(-0.6, 1.6), start(0, 1);
    std::normal_distribution<double> normal;
    std::size_t answers = 0, outside = 0, in_reach = 0;
    for (int round = 0; round < 3000; ++round) {
        const Patch patch = random_patch(random);
        const Box reach = reach_of(patch);
        double size = 0;
        for (int k = 1; k < 16; ++k)
            size = std::max(size, length(patch.nodes[static_cast<std::size_t>(k)] - patch.nodes[0]));
        for (int point = 0; point < 40; ++point) {
            // Near the flat cell, off it by anything from nothing to a whole patch.
            const double u = share(random), v = share(random);
            const double off = size * std::pow(10.0, -5 * start(random));
            const Vec3 p = (1 - u) * (1 - v) * patch.nodes[5] + u * (1 - v) * patch.nodes[6] +
                           (1 - u) * v * patch.nodes[9] + u * v * patch.nodes[10] +
                           off * Vec3(normal(random), normal(random), normal(random));
            in_reach += holds(reach, p);
            if (!invert_patch(patch, p, {start(random), start(random)})) continue;
            ++answers;
            outside += !holds(reach, p);
        }
    }
    INFO(answers << " answers, " << in_reach << " of 120000 points in reach");
    CHECK(outside == 0);
    CHECK(answers > 10000);
    // The box is worth asking: many points that are near are not in it.
    CHECK(in_reach < 100000);
}

TEST_CASE("a patch that is a plane answers with the place itself", "[measure][displacement]") {
    Patch patch;
    patch.measured = patch.supported = 0xffff;
    for (int node = 0; node < 16; ++node)
        patch.nodes[static_cast<std::size_t>(node)] = Vec3(node % 4 - 1, node / 4 - 1, 3);
    const auto hit = invert_patch(patch, {0.25, 0.75, 3}, {0.5, 0.5});
    REQUIRE(hit);
    CHECK(glm::length(hit->uv - Vec2(0.25, 0.75)) < 1e-12);
    CHECK(hit->overshoot == 0);
    CHECK_FALSE(invert_patch(patch, {0.25, 0.75, 3.2}, {0.5, 0.5}));
    CHECK_FALSE(invert_patch(patch, {2.5, 0.75, 3}, {0.5, 0.5}));
}
