// Patches: where they show points, and where they cannot.
#include "measure/field/patch.h"

#include <array>
#include <cmath>
#include <cstring>
#include <limits>
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

TEST_CASE("patches inverted side by side answer as each alone, to the last bit",
          "[measure][displacement][law]") {
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
            const auto alone = invert_patch(q.patch, q.point, q.start);
            (alone ? hits : misses) += 1;
            if (batch.has_hit(lane) != alone.has_value()) ++wrong;
            if (!alone || !batch.has_hit(lane)) continue;
            wrong += !same_bits(batch.u.lane[lane], alone->uv.x) ||
                     !same_bits(batch.v.lane[lane], alone->uv.y) ||
                     !same_bits(batch.overshoot.lane[lane], alone->overshoot);
        }
        CHECK((batch.hits >> batch.count) == 0);
    }
    INFO(hits << " hits, " << misses << " misses");
    CHECK(wrong == 0);
    CHECK(hits > 8000);
    CHECK(misses > 8000);
}

namespace {

/// A surface over the screen that is a polynomial of degree 3 in u and in v, so that its patch's cubic is the
/// surface itself: a plane, bent by less than its tangents, and smooth enough that the cubic is asked.
struct KnownSurface {
    double scale = 1;
    Vec3 centre{0};
    std::array<Vec3, 16> coefficients{};  // of u^a v^b: a + 4 b

    explicit KnownSurface(std::mt19937_64& random, double bend) {
        std::normal_distribution<double> normal;
        const auto vector = [&] { return Vec3(normal(random), normal(random), normal(random)); };
        scale = std::pow(10.0, std::uniform_real_distribution<double>(-3, 3)(random));
        centre = 3.0 * vector();
        const Vec3 du = normalize(vector()), other = vector();
        const Vec3 dv = normalize(other - dot(other, du) * du) + 0.4 * du;
        for (Vec3& one : coefficients) one = bend * vector();
        coefficients[0] = Vec3(0);
        coefficients[1] = du;
        coefficients[4] = dv;
        for (const std::size_t third : {3u, 7u, 11u, 12u, 13u, 14u, 15u}) coefficients[third] *= 0.01;
    }

    Vec3 at(double u, double v) const {
        Vec3 sum(0);  // Horner's scheme
        for (std::size_t b = 4; b-- > 0;) {
            Vec3 row(0);
            for (std::size_t a = 4; a-- > 0;) row = u * row + coefficients[a + 4 * b];
            sum = v * sum + row;
        }
        return scale * (centre + sum);
    }

    Patch patch() const {
        Patch made;
        made.measured = made.supported = 0xffff;
        for (int node = 0; node < 16; ++node)
            made.nodes[static_cast<std::size_t>(node)] = at(node % 4 - 1, node / 4 - 1);
        return made;
    }
};

}  // namespace

TEST_CASE("a patch of a known surface is inverted to the place that was asked for",
          "[measure][displacement][oracle][law]") {
    std::mt19937_64 random(4);
    std::uniform_real_distribution<double> share(-0.2, 1.2), inside(0, 1);
    std::size_t far = 0;
    for (int round = 0; round < 4000; ++round) {
        const KnownSurface surface(random,
                                   std::pow(10.0, std::uniform_real_distribution<double>(-4, -1.5)(random)));
        const Patch patch = surface.patch();
        const Vec2 place(share(random), share(random));
        const auto hit = invert_patch(patch, surface.at(place.x, place.y), {inside(random), inside(random)});
        REQUIRE(hit);
        far += glm::length(hit->uv - place) > 1e-8;
        CHECK(hit->overshoot ==
              Approx(std::max({-place.x, place.x - 1, -place.y, place.y - 1, 0.0})).margin(1e-8));

        // Off the surface by more than it bends: seen elsewhere. Along the normal, so that no place is
        // nearer.
        const double h = 1e-6;
        const Vec3 du = surface.at(place.x + h, place.y) - surface.at(place.x - h, place.y),
                   dv = surface.at(place.x, place.y + h) - surface.at(place.x, place.y - h);
        const Vec3 off = surface.at(place.x, place.y) + 0.8 * surface.scale * normalize(cross(du, dv));
        CHECK_FALSE(invert_patch(patch, off, place));
        // Beyond the cell by more than an overshoot.
        CHECK_FALSE(invert_patch(patch, surface.at(place.x + 2, place.y), {0.5, 0.5}));
    }
    CHECK(far == 0);
}

namespace {

/// The flat cell by de Casteljau's scheme.
Vec3 flat_cell(const Patch& patch, double u, double v) {
    const Vec3 top = (1 - u) * patch.nodes[5] + u * patch.nodes[6],
               bottom = (1 - u) * patch.nodes[9] + u * patch.nodes[10];
    return (1 - v) * top + v * bottom;
}

/// The cubic through all nodes by Neville's scheme.
Vec3 cubic_patch(const Patch& patch, double u, double v) {
    const auto through = [](std::array<Vec3, 4> p, double at) {
        for (std::size_t step = 1; step < 4; ++step)
            for (std::size_t i = 0; i + step < 4; ++i) {
                const double from = static_cast<double>(i) - 1, to = from + static_cast<double>(step);
                p[i] = ((to - at) * p[i] + (at - from) * p[i + 1]) / (to - from);
            }
        return p[0];
    };
    std::array<Vec3, 4> rows;
    for (std::size_t b = 0; b < 4; ++b)
        rows[b] = through(
            {patch.nodes[4 * b], patch.nodes[4 * b + 1], patch.nodes[4 * b + 2], patch.nodes[4 * b + 3]}, u);
    return through(rows, v);
}

/// The least distance of the surface from the point over a lattice of places about `middle`.
template <typename Surface>
double nearest_about(const Surface& surface, const Vec3& point, const Vec2& middle, double reach) {
    constexpr int kHalf = 12;
    double least = std::numeric_limits<double>::infinity();
    for (int j = -kHalf; j <= kHalf; ++j)
        for (int i = -kHalf; i <= kHalf; ++i)
            least = std::min(
                least, length(surface(middle.x + reach * i / kHalf, middle.y + reach * j / kHalf) - point));
    return least;
}

}  // namespace

TEST_CASE("where a patch answers, its surface comes no nearer to the point round there",
          "[measure][displacement][oracle][law]") {
    std::mt19937_64 random(6);
    std::size_t answers = 0, nearer = 0;
    for (int round = 0; round < 8000; ++round) {
        const Question q = random_question(random);
        const auto hit = invert_patch(q.patch, q.point, q.start);
        if (!hit) continue;
        ++answers;
        const auto flat = [&](double u, double v) { return flat_cell(q.patch, u, v); };
        const auto cubic = [&](double u, double v) { return cubic_patch(q.patch, u, v); };
        // The flat cell and the cubic are different surfaces; it is a nearest place of one of them.
        const auto is_nearest = [&](const auto& surface) {
            const double here = length(surface(hit->uv.x, hit->uv.y) - q.point),
                         rounding = 1e-12 * (length(q.point) + length(q.patch.nodes[5]));
            return nearest_about(surface, q.point, hit->uv, 1e-2) >= here * (1 - 1e-6) - rounding;
        };
        nearer += !is_nearest(flat) && !is_nearest(cubic);
    }
    INFO(answers << " answers");
    CHECK(nearer * 1000 <= answers);  // a saddle of the distance, on patches that are folded
    CHECK(answers > 2000);
}
