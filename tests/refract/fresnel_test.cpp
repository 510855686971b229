// The Fresnel equations: textbook values, both sides alike, energy.
#include "refract/refraction.h"

#include <cmath>

#include "support/draw.h"
#include "support/test.h"

using namespace trilens;
using trilens_test::Draw;

namespace {

// Intensities by Fresnel's sine and tangent formulas: a second way to write the equations, good away from 0
// and pi/2.
double reflected_perpendicular(double in, double out) {
    return std::pow(std::sin(in - out) / std::sin(in + out), 2);
}
double reflected_parallel(double in, double out) {
    return std::pow(std::tan(in - out) / std::tan(in + out), 2);
}

}  // namespace

TEST_CASE("reflectance: 4 percent for glass head on, all at grazing, sums of tangents and sines between",
          "[shade][law]") {
    CHECK(fresnel_reflectance(1, 1 / 1.5) == Approx(0.04).epsilon(1e-14));
    CHECK(fresnel_reflectance(1, 1.5) == Approx(0.04).epsilon(1e-14));
    CHECK(fresnel_reflectance(1, 1 / 1.33) == Approx(std::pow(0.33 / 2.33, 2)).epsilon(1e-13));
    CHECK(fresnel_reflectance(0, 1 / 1.5) == 1);
    for (const double cosine : {0.0, 0.1, 0.3, 0.7}) CHECK(fresnel_reflectance(cosine, 1) == 0);

    Draw draw(32);
    for (int i = 0; i < 2000; ++i) {
        const double eta = draw.log_uniform(1 / 3.0, 3), in = draw.uniform(0.01, 1.5);
        if (eta * std::sin(in) >= 0.999 || std::fabs(eta - 1) < 1e-3) continue;
        const double out = std::asin(eta * std::sin(in));
        const double expected = 0.5 * (reflected_perpendicular(in, out) + reflected_parallel(in, out));
        const double reflectance = fresnel_reflectance(std::cos(in), eta);
        CHECK(reflectance == Approx(expected).epsilon(1e-8).margin(1e-14));
        CHECK(reflectance >= 0);
        CHECK(reflectance <= 1);
    }
}

TEST_CASE("at Brewster's angle the part parallel to the plane of incidence is not reflected", "[shade]") {
    for (const double ior : {1.1, 1.33, 1.5, 2.4}) {
        const double brewster = std::atan(ior), out = M_PI / 2 - brewster;
        const double perpendicular = reflected_perpendicular(brewster, out);
        CHECK(fresnel_reflectance(std::cos(brewster), 1 / ior) == Approx(0.5 * perpendicular).epsilon(1e-12));
        CHECK(perpendicular == Approx(std::pow((ior * ior - 1) / (ior * ior + 1), 2)).epsilon(1e-12));
    }
}

TEST_CASE("what is not reflected is transmitted: amplitudes conserve energy", "[shade][law]") {
    // Transmitted intensity from the amplitudes of transmission, weighted by index and cosine.
    Draw draw(32);
    for (int i = 0; i < 2000; ++i) {
        const double eta = draw.log_uniform(1 / 3.0, 3), in = draw.uniform(0, 1.55);
        const double sin_out = eta * std::sin(in);
        if (sin_out >= 1) continue;
        const double ci = std::cos(in), co = std::sqrt(1 - sin_out * sin_out);
        const double ts = 2 * eta * ci / (eta * ci + co), tp = 2 * eta * ci / (ci + eta * co);
        const double transmitted = co / (eta * ci) * 0.5 * (ts * ts + tp * tp);
        CHECK(fresnel_reflectance(ci, eta) + transmitted == Approx(1).epsilon(1e-10));
    }
}

TEST_CASE("the interface reflects alike from both sides", "[shade][law]") {
    Draw draw(32);
    for (int i = 0; i < 2000; ++i) {
        const double eta = draw.log_uniform(1 / 3.0, 3), in = draw.uniform(0, 1.5);
        const double sin_out = eta * std::sin(in);
        if (sin_out >= 0.999) continue;
        const double cos_out = std::sqrt(1 - sin_out * sin_out);
        CHECK(fresnel_reflectance(std::cos(in), eta) ==
              Approx(fresnel_reflectance(cos_out, 1 / eta)).epsilon(1e-9).margin(1e-14));
    }
}

TEST_CASE("total internal reflection reflects all, from the critical angle on", "[shade]") {
    for (const double ior : {1.1, 1.33, 1.5, 2.4}) {
        const double critical = std::asin(1 / ior);
        CHECK(fresnel_reflectance(std::cos(critical + 1e-9), ior) == 1);
        CHECK(fresnel_reflectance(std::cos(critical - 1e-12), ior) == Approx(1).margin(1e-4));
        CHECK(fresnel_reflectance(std::cos(critical - 1e-3), ior) < 1);
    }
}

TEST_CASE("glass reflects all only beyond the critical angle, from inside: not at grazing from outside",
          "[shade]") {
    CHECK_FALSE(is_beyond_critical(0, 1 / 1.5));
    CHECK_FALSE(is_beyond_critical(0, 1));
    CHECK_FALSE(is_beyond_critical(1, 1.5));
    const double critical = std::sqrt(1 - 1 / (1.5 * 1.5));
    CHECK(is_beyond_critical(critical * (1 - 1e-9), 1.5));
    CHECK_FALSE(is_beyond_critical(critical * (1 + 1e-9), 1.5));
}
