// The mirror law for one ray.
#include "reflect/reflection.h"

#include <cmath>
#include <random>

#include "support/test.h"

using namespace trilens;

namespace {

struct Drawn {
    std::mt19937_64 engine{31};
    double uniform(double low, double high) {
        return std::uniform_real_distribution<double>(low, high)(engine);
    }
    Vec3 vector() { return {uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)}; }
    Vec3 scaled() { return std::exp(uniform(std::log(1e-4), std::log(1e4))) * vector(); }
};

}  // namespace

TEST_CASE("the angle of reflection is the angle of incidence, in the plane of incidence, at the same length",
          "[reflect]") {
    Drawn draw;
    for (int i = 0; i < 2000; ++i) {
        const Vec3 incoming = draw.scaled(), normal = normalize(draw.vector());
        const Vec3 outgoing = mirrored(incoming, normal);
        const double size = length(incoming);
        CHECK(length(outgoing) == Approx(size).epsilon(1e-14));
        CHECK(std::fabs(dot(outgoing, normal) + dot(incoming, normal)) <= 1e-14 * size);
        CHECK(std::fabs(triple(incoming, normal, outgoing)) <= 1e-14 * size * size);
        CHECK(length((outgoing - dot(outgoing, normal) * normal) -
                     (incoming - dot(incoming, normal) * normal)) <= 1e-14 * size);
    }
}

TEST_CASE("mirroring twice gives the ray back, and the side of the normal does not matter",
          "[reflect][law]") {
    Drawn draw;
    for (int i = 0; i < 2000; ++i) {
        const Vec3 incoming = draw.scaled(), normal = normalize(draw.vector());
        CHECK(length(mirrored(mirrored(incoming, normal), normal) - incoming) <= 1e-14 * length(incoming));
        CHECK(mirrored(incoming, -normal) == mirrored(incoming, normal));
    }
}

TEST_CASE("known mirrors: head on, grazing, and a corner of three", "[reflect]") {
    CHECK(mirrored({0, -2, 0}, {0, 1, 0}) == Vec3(0, 2, 0));
    CHECK(mirrored({3, 0, 0}, {0, 1, 0}) == Vec3(3, 0, 0));
    const Vec3 in(0.3, -1.7, 0.9);
    CHECK(mirrored(mirrored(mirrored(in, {1, 0, 0}), {0, 1, 0}), {0, 0, 1}) == -in);
}
