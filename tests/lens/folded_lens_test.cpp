// Mirrors, tilts and decentres in prescriptions: telescopes and plates against closed forms, and against rays
// by implicit equations in space.
#include <cmath>
#include <numbers>
#include <string>

#include "base/description/lens_sag.h"
#include "base/util/error.h"
#include "lens/sequential_rays.h"
#include "support/draw.h"
#include "support/implicit_trace.h"
#include "support/test.h"

using namespace trilens;
using namespace trilens_test;

namespace {

constexpr double kDegree = std::numbers::pi / 180;

LensRow mirror_of(double radius, double conic, double aperture, double thickness) {
    LensRow row;
    row.side = {radius == 0 ? 0 : 1 / radius, conic, {}, aperture};
    row.thickness = thickness;
    row.mirror = true;
    return row;
}

LensPrescription paraboloid(double focal_length, double aperture) {
    LensPrescription lens{"paraboloid", "paraboloid", {}};
    lens.rows = {mirror_of(-2 * focal_length, -1, aperture, -focal_length)};
    return lens;
}

/// Of a primary of focal length 300 and two mirrors 210 apart: f = 900.
LensPrescription two_mirrors(double primary_conic, double secondary_conic) {
    LensPrescription lens{"two mirrors", "two mirrors", {}};
    lens.rows = {mirror_of(-600, primary_conic, 50, -210), mirror_of(-270, secondary_conic, 16, 270)};
    lens.rows[0].hole = 13;
    return lens;
}

LensPrescription newtonian() {
    LensPrescription lens = paraboloid(500, 50);
    lens.rows[0].thickness = -380;
    lens.rows.push_back(mirror_of(0, 0, 19, 120));
    tilt_row(lens.rows[1], {.degrees = {45, 0, 0}, .behind = AxisBehind::kBends});
    return lens;
}

/// A plane plate of glass, turned about x.
LensPrescription plate(double degrees, double thickness, double index) {
    LensPrescription lens{"plate", "plate", {}};
    lens.rows.resize(2);
    lens.rows[0].thickness = thickness;
    lens.rows[0].glass = {"glass", index, 0};
    tilt_row(lens.rows[0], {.degrees = {degrees, 0, 0}});
    return lens;
}

/// The worst difference of a lens' rays from those of surfaces in space, over its beam.
double worst_difference(const LensPrescription& lens, const std::vector<ImplicitSurface>& surfaces,
                        double reach) {
    Draw draw(11);
    double worst = 0;
    for (int i = 0; i < 400; ++i) {
        const Vec3 at(draw.uniform(-reach, reach), draw.uniform(-reach, reach), -1000);
        const Ray ray{at, normalize(Vec3(draw.uniform(-0.01, 0.01), draw.uniform(-0.01, 0.01), 1))};
        const auto ours = trace_lens(lens, ray, SpectralLine::kD, ApertureRule::kAll);
        const auto theirs = implicit_trace(surfaces, ray);
        REQUIRE(ours);
        REQUIRE(theirs);
        worst = std::max({worst, length(ours->direction - theirs->direction),
                          length(ours->origin - theirs->origin) / 1000});
    }
    return worst;
}

}  // namespace

TEST_CASE("a paraboloid is a telescope without spherical aberration, whose coma is that of its f-number",
          "[lens][oracle]") {
    const LensPrescription lens = paraboloid(1000, 100);
    const FirstOrder first = first_order(lens);
    CHECK(std::fabs(first.focal_length - 1000) < 1e-9);
    CHECK(std::fabs(first.back_focal_length + 1000) < 1e-9);
    CHECK(std::fabs(first.f_number - 5) < 1e-12);
    CHECK(std::fabs(first.petzval_radius + 1000) < 1e-9);
    CHECK(spot_of(lens, {}).radius < 1e-10);
    const double slope = 0.01;
    const SeidelSums seidel = seidel_sums(lens, {100, slope});
    CHECK(std::fabs(seidel.image_slope + 0.1) < 1e-12);
    CHECK(std::fabs(seidel.sum.spherical) < 1e-12);
    // Sagittal coma of theta / (16 F^2), as an angle; the sagittal image is flat.
    CHECK(std::fabs(std::fabs(seidel.sum.coma / (2 * seidel.image_slope)) - 1000 * slope / (16 * 25)) <
          1e-12);
    CHECK(std::fabs(seidel.sum.astigmatism + seidel.sum.petzval) < 1e-12);
    CHECK(std::fabs(std::fabs(seidel.image_height) - 10) < 1e-9);
}

TEST_CASE(
    "a spherical mirror's aberration is the closed form of its marginal ray, and Seidel's its first term",
    "[lens][oracle]") {
    LensPrescription sphere = paraboloid(1000, 100);
    sphere.rows[0].side.conic = 0;
    const double radius = 2000;
    for (const double height : {20.0, 50.0, 100.0}) {
        // The ray crosses the axis where an isosceles triangle says, R / (2 cos of the angle at the mirror).
        const double angle = std::asin(height / radius), crosses = -radius + radius / (2 * std::cos(angle));
        const auto ray =
            trace_lens(sphere, {{0, height, -5}, {0, 0, 1}}, SpectralLine::kD, ApertureRule::kAll);
        REQUIRE(ray);
        CHECK(std::fabs(ray->origin.z - ray->origin.y * ray->direction.z / ray->direction.y - crosses) <
              1e-9);
        const SeidelSums seidel = seidel_sums(sphere, {height, 0});
        const double aside = ray->origin.y + (-1000 - ray->origin.z) * ray->direction.y / ray->direction.z;
        CHECK(std::fabs(aside / (seidel.sum.spherical / (2 * seidel.image_slope)) - 1) <
              2.5 * height * height / (radius * radius));
    }
}

TEST_CASE("a classical Cassegrain images the axis perfectly, with the coma of one paraboloid of its f-number",
          "[lens][oracle]") {
    // The hyperboloid images the prime focus, 90 away, 3 times as large.
    const LensPrescription lens = two_mirrors(-1, -4);
    const FirstOrder first = first_order(lens);
    CHECK(std::fabs(first.focal_length - 900) < 1e-9);
    CHECK(std::fabs(first.back_focal_length - 270) < 1e-9);
    CHECK(spot_of(lens, {}).radius < 1e-10);
    CHECK(spot_of(lens, {}).points.size() < spot_of(lens, {}).asked);  // the hole
    const SeidelSums seidel = seidel_sums(lens, {50, 0.005});
    CHECK(std::fabs(seidel.sum.spherical) < 1e-12);
    const double coma = 900 * 0.005 / (16 * 81);
    CHECK(std::fabs(std::fabs(seidel.sum.coma / (2 * seidel.image_slope)) / coma - 1) < 1e-9);
}

TEST_CASE("a Ritchey-Chretien has neither spherical aberration nor coma in the third order",
          "[lens][oracle]") {
    const double m = 3, back = 270, apart = 210;
    const LensPrescription lens = two_mirrors(-1 - 2 / (m * m * m) * back / apart,
                                              -1 - 2 / std::pow(m - 1, 3) * (m * (2 * m - 1) + back / apart));
    const SeidelSums seidel = seidel_sums(lens, {50, 0.005});
    const SeidelSums classical = seidel_sums(two_mirrors(-1, -4), {50, 0.005});
    CHECK(std::fabs(seidel.sum.spherical) < 1e-12);
    CHECK(std::fabs(seidel.sum.coma) < 1e-10 * std::fabs(classical.sum.coma));
    CHECK(spot_of(lens, {.field_degrees = 0.05}).rms_radius <
          0.5 * spot_of(two_mirrors(-1, -4), {.field_degrees = 0.05}).rms_radius);
}

TEST_CASE("a Newtonian's flat mirror brings the paraboloid's focus to its side", "[lens][oracle]") {
    const LensPrescription lens = newtonian();
    CHECK(!is_centred(lens));
    CHECK(std::fabs(first_order(lens).focal_length - 500) < 1e-9);
    CHECK(std::fabs(first_order(lens).back_focal_length - 120) < 1e-9);
    CHECK(spot_of(lens, {.rings = 5}).radius < 1e-10);
    for (const double y : {-45.0, 20.0}) {
        const auto ray = trace_lens(lens, {{30, y, -900}, {0, 0, 1}}, SpectralLine::kD, ApertureRule::kAll);
        REQUIRE(ray);
        const Vec3 to_focus = Vec3(0, -120, -380) - ray->origin;
        CHECK(length(cross(to_focus, ray->direction)) < 1e-10);
        CHECK(dot(to_focus, ray->direction) > 0);
    }
    const std::vector<ImplicitSurface> surfaces{{{0, 0, 0}, {0, 0, 1}, -1.0 / 1000, -1, 1, 1, true},
                                                {{0, 0, -380}, normalize(Vec3(0, -1, 1)), 0, 0, 1, 1, true}};
    CHECK(worst_difference(lens, surfaces, 45) < 1e-13);
}

TEST_CASE("a tilted plate shifts rays as Snell's law says, and its spots are turned with it",
          "[lens][oracle]") {
    for (const double degrees : {0.0, 10.0, -35.0, 60.0}) {
        CAPTURE(degrees);
        const LensPrescription lens = plate(degrees, 12, 1.5);
        const auto ray = trace_lens(lens, {{0.3, 0.2, -40}, {0, 0, 1}});
        REQUIRE(ray);
        CHECK(length(ray->direction - Vec3(0, 0, 1)) < 1e-14);
        const double s = std::sin(degrees * kDegree), c = std::cos(degrees * kDegree);
        // About x from y to z: the plate's front looks towards +y there, and the ray is moved to -y.
        const double shift = 12 * s * (1 - c / std::sqrt(1.5 * 1.5 - s * s));
        CHECK(std::fabs(ray->origin.y - (0.2 - shift)) < 1e-12);
        CHECK(std::fabs(ray->origin.x - 0.3) < 1e-13);
    }
}

TEST_CASE("rays through decentred and tilted elements are those of the surfaces in space", "[lens][oracle]") {
    LensPrescription lens{"bent", "bent", {}};
    lens.rows.resize(4);
    lens.rows[0] = {{1.0 / 80, -0.7, {}, 20}, 6, {"a", 1.6, 0}};
    lens.rows[1] = {{-1.0 / 90, 0, {}, 20}, 30, {}};
    lens.rows[2] = mirror_of(-300, -1.5, 40, -25);
    lens.rows[3] = mirror_of(0, 0, 40, 0);
    tilt_row(lens.rows[0],
             {.decentre = {1, -2, 0.5}, .degrees = {4, -3, 20}, .behind = AxisBehind::kFollows});
    tilt_row(lens.rows[2], {.degrees = {0, 12, 0}, .behind = AxisBehind::kReturns});
    tilt_row(lens.rows[3], {.decentre = {0, 3, 0}, .degrees = {-30, 0, 0}, .behind = AxisBehind::kBends});
    // By hand: Rodrigues' turns about axes that go with the element.
    const auto turned = [](const Vec3& v, const Vec3& about, double degrees) {
        const double c = std::cos(degrees * kDegree), s = std::sin(degrees * kDegree);
        return c * v + s * cross(about, v) + (1 - c) * dot(about, v) * about;
    };
    Vec3 x(1, 0, 0), y(0, 1, 0), z(0, 0, 1);
    const auto turn = [&](Vec3 about, double degrees) {
        for (Vec3* axis : {&x, &y, &z}) *axis = turned(*axis, about, degrees);
    };
    turn(x, 4), turn(y, -3), turn(z, 20);
    const Vec3 front(1, -2, 0.5), back = front + 6.0 * z, third = back + 30.0 * z,
                                  fourth = third - 25.0 * z + 3.0 * y;
    const std::vector<ImplicitSurface> surfaces{{front, z, 1.0 / 80, -0.7, 1, 1.6},
                                                {back, z, -1.0 / 90, 0, 1.6, 1},
                                                {third, turned(z, y, 12), -1.0 / 300, -1.5, 1, 1, true},
                                                {fourth, turned(z, x, -30), 0, 0, 1, 1, true}};
    CHECK(worst_difference(lens, surfaces, 8) < 1e-13);
    const LensPose image = lens_poses(lens).back();
    CHECK(length(image.turn[2] - turned(z, x, -60)) < 1e-14);
    CHECK(length(image.shift - fourth) < 1e-13);
}

TEST_CASE("a mirror on two cemented glasses makes each body once", "[lens]") {
    LensPrescription lens{"two glasses", "two glasses", {}};
    const LensSide outer{-1.0 / 100, 0, {}, 20}, inner{-1.0 / 130, 0, {}, 20};
    const Glass crown{"BK7", 1.5168, 64.17}, flint{"SF5", 1.6727, 32.21};
    lens.rows = {
        {outer, 5, crown}, {inner, 4, flint}, mirror_of(-150, 0, 20, -4), {inner, -5, crown}, {outer}};
    const std::vector<LensElement> bodies = lens_elements(lens);
    REQUIRE(bodies.size() == 3);
    CHECK(bodies[0].medium.glass.name == "BK7");
    CHECK(bodies[1].medium.glass.name == "SF5");
    CHECK(bodies[2].is_mirror);
    // Glass behind another side is another body.
    lens.rows[4].side.curvature = -1.0 / 101;
    CHECK(lens_elements(lens).size() == 4);
}

TEST_CASE("the shell of an obscuration keeps off the surface, however steep", "[lens]") {
    for (const double radius : {1.05, 1.5, -1.2, 30.0}) {
        LensPrescription lens{"steep", "steep", {}};
        lens.rows = {{{1 / radius, 0, {}, 1}, 0.5, {"BK7", 1.5168, 64.17}}, {{0, 0, {}, 1}}};
        lens.rows[0].obscuration = 0.99;
        const std::vector<LensObscuration> shells = lens_obscurations(lens);
        REQUIRE(shells.size() == 1);
        const double gap = -shells[0].pose.shift.z - shells[0].shape.thickness;
        // Its triangles lie between rings; the surface must not reach to them.
        double off = 0;
        for (int i = 0; i < kShellSegments / 4; ++i) {
            const double low = 0.99 * 4 * i / kShellSegments, high = 0.99 * 4 * (i + 1) / kShellSegments;
            const auto z = [&](double r) { return sag_over(lens.rows[0].side, {r, 0}).z; };
            for (const double share : {0.25, 0.5, 0.75})
                off = std::max(off, std::fabs((1 - share) * z(low) + share * z(high) -
                                              z((1 - share) * low + share * high)));
        }
        INFO("radius " << radius << ": off " << off << ", gap " << gap);
        CHECK(off < gap);
        CHECK(gap < 0.1);
    }
}

TEST_CASE("a Mangin mirror's paraxial focus is that of its exact rays near the axis", "[lens][oracle]") {
    LensPrescription lens{"Mangin", "Mangin", {}};
    lens.rows.resize(3);
    lens.rows[0] = {{-1.0 / 100, 0, {}, 20}, 5, {"BK7", 1.5168, 64.17}};
    lens.rows[1] = mirror_of(-150, 0, 20, -5);
    lens.rows[2].side = {-1.0 / 100, 0, {}, 20};
    const FirstOrder first = first_order(lens);
    double before = 0;
    for (const double height : {2.0, 1.0, 0.5}) {
        const auto ray = trace_lens(lens, {{0, height, -50}, {0, 0, 1}});
        REQUIRE(ray);
        const double crosses = ray->origin.z - ray->origin.y * ray->direction.z / ray->direction.y;
        const double off = std::fabs(crosses - first.back_focal_length);
        CHECK(off < 0.02 * height * height);
        if (before > 0) CHECK(std::fabs(off / before - 0.25) < 0.02);
        before = off;
    }
    // Its bodies are the glass, once, and the blank behind it, with a side in common.
    const std::vector<LensElement> bodies = lens_elements(lens);
    REQUIRE(bodies.size() == 2);
    CHECK_FALSE(bodies[0].is_mirror);
    CHECK(bodies[1].is_mirror);
    CHECK(bodies[0].shape.back.curvature == bodies[1].shape.front.curvature);
    CHECK(length(bodies[1].pose.shift - Vec3(0, 0, 5)) == 0);
    lens.rows[2].side.curvature = -1.0 / 101;
    CHECK_THROWS_WITH(lens_elements(lens), ContainsSubstring("by another side than it came in by"));
    lens.rows[2].side.curvature = -1.0 / 100;
    lens.rows[1].thickness = -4;
    CHECK_THROWS_WITH(lens_elements(lens), ContainsSubstring("by another side than it came in by"));
}

TEST_CASE("what cannot be along a folded axis, or as a body, is refused with its row", "[lens][bad-input]") {
    const auto message_of = [](LensPrescription lens) -> std::string {
        for (std::size_t i = 0; i < lens.rows.size(); ++i)
            lens.rows[i].place = "line " + std::to_string(i + 1);
        try {
            lens_elements(lens);
        } catch (const InputError& error) {
            return error.what();
        }
        return "";
    };
    CHECK(message_of(newtonian()).empty());
    CHECK(message_of(two_mirrors(-1, -4)).empty());
    LensPrescription lens = two_mirrors(-1, -4);
    lens.rows[0].thickness = 210;
    CHECK(message_of(lens) ==
          "two mirrors: line 1: its thickness is positive: behind a mirror light runs against the axis");
    lens = two_mirrors(-1, -4);
    lens.rows[0].hole = 50;
    CHECK(message_of(lens).ends_with("line 1: its hole is as large as its aperture"));
    lens = two_mirrors(-1, -4);
    lens.rows[1].glass = {"glass", 1.5, 60};
    CHECK(message_of(lens).ends_with("line 2: is a mirror, and has a glass of its own"));
    lens = plate(20, 5, 1.5);
    for (LensRow& row : lens.rows) row.side.aperture = 9;
    CHECK(message_of(lens).empty());
    tilt_row(lens.rows[1], {.degrees = {1, 0, 0}});
    CHECK(
        message_of(lens).ends_with("line 1: the sides of its glass are tilted against each other: no body is "
                                   "made of it"));
    lens.rows[1].before.turn[0][0] = std::nan("");
    CHECK(message_of(lens).ends_with("is not finite"));
}
