// Patches: where they show points, and where they cannot.
#include "measure/field/patch.h"

#include <array>
#include <cmath>
#include <cstring>
#include <random>

#include "measure/field/patch_batch.h"
#include "measure/plain_inversion.h"
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

TEST_CASE("a patch answers for no point outside its reach", "[measure][displacement][law]") {
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

namespace {

bool same_bits(double a, double b) {
    return std::memcmp(&a, &b, sizeof a) == 0;
}

/// A question to ask of a patch: mostly near it, sometimes of a patch that has collapsed or a point far away.
struct Question {
    Patch patch;
    Vec3 point;
    Vec2 start;
};

Question random_question(std::mt19937_64& random) {
    std::uniform_real_distribution<double> share(-0.6, 1.6), start(0, 1);
    std::normal_distribution<double> normal;
    Question q{random_patch(random), {}, {start(random), start(random)}};
    auto& n = q.patch.nodes;
    switch (random() % 12) {
        case 0:
            n.fill(n[0]);
            break;
        case 1:
            for (std::size_t i = 0; i < 16; ++i) n[i] = n[0] + static_cast<double>(i % 4) * (n[1] - n[0]);
            break;
        case 2:
            for (std::size_t i = 0; i < 16; ++i) n[i] = n[i % 2];
            break;
        default:
            break;
    }
    const double u = share(random), v = share(random), far = random() % 20 ? 1e-4 : 1e6;
    q.point = (1 - u) * (1 - v) * n[5] + u * (1 - v) * n[6] + (1 - u) * v * n[9] + u * v * n[10] +
              far * length(n[6] - n[5]) * Vec3(normal(random), normal(random), normal(random));
    if (random() % 10 == 0) q.point = n[random() % 16];
    return q;
}

}  // namespace

TEST_CASE("patches inverted side by side answer as each alone in plain code, to the last bit",
          "[measure][displacement][oracle][law]") {
    std::mt19937_64 random(3);
    std::size_t hits = 0, misses = 0, wrong = 0;
    for (int round = 0; round < 12000; ++round) {
        PatchBatch batch;
        batch.count = 1 + random() % kPatchLanes;
        std::array<Question, kPatchLanes> asked;
        for (std::size_t lane = 0; lane < batch.count; ++lane) {
            asked[lane] = random_question(random);
            const Question& q = asked[lane];
            batch.ask(lane, q.point, q.start, q.patch.supported);
            for (std::size_t i = 0; i < 16; ++i) batch.set_node(lane, i, q.patch.nodes[i] - q.point);
        }
        invert_patches(batch);
        for (std::size_t lane = 0; lane < batch.count; ++lane) {
            const Question& q = asked[lane];
            const auto expected = trilens_test::plain_inversion(q.patch, q.point, q.start);
            (expected ? hits : misses) += 1;
            if (batch.has_hit(lane) != expected.has_value()) ++wrong;
            if (!expected || !batch.has_hit(lane)) continue;
            wrong += !same_bits(batch.u.lane[lane], expected->uv.x) ||
                     !same_bits(batch.v.lane[lane], expected->uv.y) ||
                     !same_bits(batch.overshoot.lane[lane], expected->overshoot);
        }
        CHECK((batch.hits >> batch.count) == 0);
    }
    INFO(hits << " hits, " << misses << " misses");
    CHECK(wrong == 0);
    CHECK(hits > 8000);
    CHECK(misses > 8000);
}
