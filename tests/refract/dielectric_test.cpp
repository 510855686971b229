// Snell's law for one ray: textbook values, reversibility, limits.
#include "refract/refraction.h"

#include <cmath>

#include "support/draw.h"
#include "support/test.h"

using namespace trilens;
using trilens_test::Draw;

namespace {

/// A ray that arrives at `angle` on the plane y = 0 from above.
Vec3 arriving(double angle) {
    return {std::sin(angle), -std::cos(angle), 0};
}
const Vec3 kUp{0, 1, 0};

}  // namespace

TEST_CASE("refraction keeps the plane and the length, and the sines have the ratio of the indices",
          "[refract]") {
    Draw draw(32);
    int refracted_count = 0, reflected_count = 0;
    for (int i = 0; i < 5000; ++i) {
        const double eta = draw.log_uniform(1 / 3.0, 3);
        const Vec3 normal = draw.unit();
        Vec3 incoming = draw.log_uniform(1e-4, 1e4) * draw.unit();
        if (dot(incoming, normal) > 0) incoming = -incoming;
        const double size = length(incoming), sin_in = length(cross(incoming, normal)) / size;
        const auto outgoing = refracted(incoming, normal, eta);
        if (std::fabs(eta * sin_in - 1) < 1e-12) continue;
        REQUIRE(outgoing.has_value() == (eta * sin_in < 1));
        if (!outgoing) {
            ++reflected_count;
            continue;
        }
        ++refracted_count;
        CHECK(length(*outgoing) == Approx(size).epsilon(1e-14));
        CHECK(dot(*outgoing, normal) <= 0);
        CHECK(std::fabs(triple(incoming, normal, *outgoing)) <= 1e-13 * size * size);
        CHECK(length(cross(*outgoing, normal)) / size == Approx(eta * sin_in).epsilon(1e-12).margin(1e-14));
        CHECK(dot(cross(*outgoing, normal), cross(incoming, normal)) >= 0);
    }
    CHECK(refracted_count > 3000);
    CHECK(reflected_count > 500);
}

TEST_CASE("light takes the same way back", "[refract][law]") {
    Draw draw(32);
    for (int i = 0; i < 2000; ++i) {
        const double eta = draw.log_uniform(1 / 3.0, 3);
        const Vec3 incoming = arriving(draw.uniform(0, 1.5));
        const auto outgoing = refracted(incoming, kUp, eta);
        if (!outgoing || -outgoing->y < 1e-3) continue;
        const auto back = refracted(-*outgoing, -kUp, 1 / eta);
        REQUIRE(back.has_value());
        CHECK(length(*back + incoming) < 1e-12 / -incoming.y);
    }
}

TEST_CASE("known refractions: straight through, equal media, glass at 30 degrees", "[refract]") {
    CHECK(length(*refracted({0, -2, 0}, kUp, 1 / 1.5) - Vec3(0, -2, 0)) < 1e-15);
    CHECK(length(*refracted(arriving(1.2), kUp, 1) - arriving(1.2)) < 1e-15);
    const double inside = std::asin(0.5 / 1.5);  // 19.4712 degrees
    CHECK(inside * 180 / M_PI == Approx(19.4712206));
    CHECK(length(*refracted(arriving(M_PI / 6), kUp, 1 / 1.5) - arriving(inside)) < 1e-15);
}

TEST_CASE("total internal reflection begins at the critical angle", "[refract]") {
    for (const double ior : {1.1, 1.33, 1.5, 2.4}) {
        const double critical = std::asin(1 / ior);
        CHECK(refracted(arriving(critical - 1e-9), kUp, ior).has_value());
        CHECK_FALSE(refracted(arriving(critical + 1e-9), kUp, ior).has_value());
    }
}

TEST_CASE("normals turned past grazing count as grazing; rays without direction refract to nothing",
          "[refract]") {
    CHECK(!refracted({0, 0, -2}, {0, 0, -1}, 1.5));  // no way lies in between
    CHECK(!refracted({0, 0, -2}, {0, 0, -1}, 1 / 1.5));
    const auto grazing = refracted({1, 0, 0}, kUp, 1 / 1.5);
    const auto beyond = refracted(normalize(Vec3(1, 1e-6, 0)), kUp, 1 / 1.5);
    REQUIRE(grazing.has_value());
    REQUIRE(beyond.has_value());
    CHECK(length(*grazing - *beyond) < 3e-6);
    CHECK(grazing->x == Approx(1 / 1.5));
    CHECK_FALSE(refracted({0, 0, 0}, kUp, 1 / 1.5).has_value());
}
