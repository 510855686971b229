// A beam holds every ray of its facet, and says of most places beside it that none comes there.
#include <cmath>
#include <limits>

#include "intersect/random_scene.h"
#include "paths/facets/one_history.h"
#include "support/test.h"

using namespace trilens;
using namespace trilens_test;

namespace {

constexpr double kEverywhere = std::numeric_limits<double>::infinity();

/// A quadratic over a facet by its values at corners and middles (opposite to the corners).
template <typename T>
struct Quadratic {
    std::array<T, 3> corner, middle;

    T at(const Vec3& w) const {
        T sum = corner[0] * 0.0;
        for (int k = 0; k < 3; ++k) {
            const int next = (k + 1) % 3, last = (k + 2) % 3;
            sum += corner[static_cast<std::size_t>(k)] * (w[k] * (2 * w[k] - 1)) +
                   middle[static_cast<std::size_t>(k)] * (4 * w[next] * w[last]);
        }
        return sum;
    }
    PartSamples<T> samples() const { return {corner, middle, at(Vec3(1.0 / 3))}; }
};

Vec3 beam_weights(Random& random) {
    const double a = random.uniform(0, 1), b = random.uniform(0, 1);
    return a + b <= 1 ? Vec3(a, b, 1 - a - b) : Vec3(1 - a, 1 - b, a + b - 1);
}

Vec3 random_vector(Random& random, double size) {
    return {random.uniform(-size, size), random.uniform(-size, size), random.uniform(-size, size)};
}

/// Origins about `at`, directions about (0, 0, -1), both bent.
struct Rays {
    Quadratic<Vec3> origin, direction;

    Ray at(const Vec3& w) const { return {origin.at(w), direction.at(w)}; }
    PartSamples<Ray> samples() const {
        PartSamples<Ray> all;
        all.middle.emplace();
        for (std::size_t k = 0; k < 3; ++k) {
            all.corner[k] = {origin.corner[k], direction.corner[k]};
            (*all.middle)[k] = {origin.middle[k], direction.middle[k]};
        }
        all.centre = at(Vec3(1.0 / 3));
        return all;
    }
};

Rays random_rays(Random& random, double width, double bend) {
    Rays rays;
    const Vec3 axis(0, 0, -1);
    for (std::size_t k = 0; k < 3; ++k) {
        rays.origin.corner[k] = random_vector(random, width);
        rays.direction.corner[k] = axis + random_vector(random, 3 * width);
    }
    for (std::size_t k = 0; k < 3; ++k) {
        const std::size_t next = (k + 1) % 3, last = (k + 2) % 3;
        rays.origin.middle[k] =
            0.5 * (rays.origin.corner[next] + rays.origin.corner[last]) + random_vector(random, bend * width);
        rays.direction.middle[k] = 0.5 * (rays.direction.corner[next] + rays.direction.corner[last]) +
                                   random_vector(random, bend * width);
    }
    return rays;
}

}  // namespace

TEST_CASE("The hull of a quadratic over a facet holds all of its values, and little more", "[paths][law]") {
    Random random(311);
    double slack = 0;
    for (int i = 0; i < 2000; ++i) {
        Quadratic<double> q;
        for (std::size_t k = 0; k < 3; ++k) {
            q.corner[k] = random.uniform(-1, 1);
            q.middle[k] = random.uniform(-1, 1);
        }
        const Interval hull = hull_of(q.samples());
        double low = kEverywhere, high = -kEverywhere;
        for (int j = 0; j < 200; ++j) {
            const double value = q.at(beam_weights(random));
            low = std::min(low, value), high = std::max(high, value);
        }
        CHECK(hull.low <= low + 1e-12);
        CHECK(hull.high >= high - 1e-12);
        slack += hull.size() / (high - low);
    }
    CHECK(slack / 2000 < 3);
}

TEST_CASE("A beam may touch whatever one of its rays meets", "[paths][law]") {
    Random random(312);
    std::size_t beams = 0, beside = 0, excluded = 0;
    for (int i = 0; i < 400; ++i) {
        const double width = std::pow(10.0, random.uniform(-4, -1)), bend = random.uniform(0, 0.5);
        const Rays rays = random_rays(random, width, bend);
        const std::optional<Beam> beam = Beam::around(rays.samples());
        if (!beam) continue;
        ++beams;
        for (int j = 0; j < 50; ++j) {
            const Ray ray = rays.at(beam_weights(random));
            const double t = std::pow(10.0, random.uniform(-3, 2));
            const Vec3 place = ray.origin + t * ray.direction;
            const double size = width * std::pow(10.0, random.uniform(-6, 0));
            Box box;
            box.include(place - random.uniform(0, 1) * size);
            box.include(place + random.uniform(0, 1) * size);
            CHECK(beam->may_touch(box, kEverywhere));
            CHECK(beam->may_touch(Beam::Piece{{place, place + random_vector(random, size), place}, 0},
                                  kEverywhere));
            CHECK(dot(normalize(ray.direction), beam->axis()) > 0);
            CHECK(length(normalize(ray.direction) - beam->axis()) <= beam->turn() + 1e-12);

            // Ten times as far from the axis as any ray may be at that depth.
            const double reach = 10 * (width + t * 8 * width);
            Box aside;
            aside.include(place + Vec3(reach, 0, 0));
            aside.include(place + Vec3(reach, 0, 0) + Vec3(0.01 * reach));
            ++beside;
            excluded += !beam->may_touch(aside, kEverywhere);
        }
    }
    CHECK(beams > 300);
    CHECK(excluded > beside * 9 / 10);
}

TEST_CASE("A beam comes to nothing beyond where it ends, nor behind where it starts", "[paths]") {
    Random random(313);
    std::size_t asked = 0;
    for (int i = 0; i < 100; ++i) {
        const Rays rays = random_rays(random, 1e-3, 0.1);
        const std::optional<Beam> beam = Beam::around(rays.samples());
        if (!beam) continue;
        const Ray ray = rays.at(Vec3(1.0 / 3));
        const auto box_at = [&](double t) {
            Box box;
            box.include(ray.origin + t * ray.direction - 1e-3);
            box.include(ray.origin + t * ray.direction + 1e-3);
            return box;
        };
        CHECK(beam->may_touch(box_at(2), 3));
        CHECK_FALSE(beam->may_touch(box_at(4), 3));
        CHECK_FALSE(beam->may_touch(box_at(-1), 3));
        ++asked;
    }
    CHECK(asked > 90);
}
