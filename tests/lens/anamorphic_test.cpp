// Biconic and toric sides: against conicoids, against a curve that is turned, their bounds, and lenses of
// them, which gather light along x and y by themselves.
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "base/description/lens_sag.h"
#include "base/util/error.h"
#include "lens/sequential_rays.h"
#include "support/draw.h"
#include "support/test.h"

using namespace trilens;
using namespace trilens_test;

namespace {

LensSide biconic(double cy, double ky, double cx, double kx, double aperture) {
    return {cy, ky, {}, aperture, {}, SideForm::kBiconic, cx, kx};
}

LensSide toric(SideForm form, const LensSide& profile, double across) {
    LensSide side = profile;
    side.form = form;
    side.across_curvature = across;
    return side;
}

const LensSide kProfile{0.4, -0.7, {0.01, -0.02, 0.005}, 0.9};

/// Bowls, saddles, cylinders along both axes.
std::vector<LensSide> sides() {
    return {biconic(0.5, -0.5, 0.3, 1.2, 1.1),
            biconic(-0.4, 2, 0.6, -3, 0.9),
            biconic(0, 0, 0.7, 0, 1),
            toric(SideForm::kToricY, kProfile, 0.6),
            toric(SideForm::kToricY, kProfile, -0.5),
            toric(SideForm::kToricX, kProfile, 0.2),
            toric(SideForm::kToricX, kProfile, 0),
            toric(SideForm::kToricY, {0, 0, {}, 0.8}, -0.9)};
}

Vec2 place_on(const LensSide& side, Draw& draw) {
    const double turn = draw.uniform(0, 6.2831853), r = side.aperture * std::sqrt(draw.uniform(0, 1));
    return {r * std::cos(turn), r * std::sin(turn)};
}

/// The anamorphic lens of the tests: f differs along x and y.
LensPrescription toric_singlet() {
    LensPrescription lens{"toric", "toric", {}};
    lens.rows.resize(2);
    lens.rows[0] = {toric(SideForm::kToricY, {0.03, -0.5, {0, 1e-6}, 8}, 0.012), 4, {"glass", 1.6, 0}};
    lens.rows[1] = {biconic(-0.01, 0, -0.02, 0.4, 8), 0};
    return lens;
}

/// How far behind the last vertex a ray from far off, at such a height along x or y, crosses the axis.
double crossing(const LensPrescription& lens, LensSection section, double height) {
    const int k = section == LensSection::kX ? 0 : 1;
    Vec3 origin(0, 0, -1);
    origin[k] = height;
    const auto ray = trace_lens(lens, {origin, {0, 0, 1}}, SpectralLine::kD, ApertureRule::kAll);
    REQUIRE(ray);
    CHECK(std::fabs(ray->direction[1 - k]) < 1e-16);
    return ray->origin.z - ray->origin[k] * ray->direction.z / ray->direction[k] -
           vertex_of(lens, lens.rows.size() - 1);
}

}  // namespace

TEST_CASE("a biconic of equal radii and conics is the conicoid to rounding", "[lens][law]") {
    Draw draw(1);
    for (const auto& [c, k] : {std::pair{0.5, -0.5}, {-0.7, 0.0}, {0.3, 2.0}, {0.9, -3.0}}) {
        const LensSide round{c, k, {}, 1}, both = biconic(c, k, c, k, 1);
        CHECK(std::fabs(side_room(both) - side_room(round)) < 1e-15);
        for (int i = 0; i < 500; ++i) {
            const Vec2 p = place_on(round, draw);
            const SideSag a = sag_over(round, p), b = sag_over(both, p);
            CHECK(std::fabs(a.z - b.z) < 1e-15);
            CHECK(length(a.slope - b.slope) < 1e-15);
            for (const double off : {a.xx - b.xx, a.xy - b.xy, a.yy - b.yy}) CHECK(std::fabs(off) < 1e-14);
        }
    }
}

TEST_CASE("a toric side is its profile turned about its line", "[lens][oracle]") {
    Draw draw(2);
    for (const double radius : {1.7, -2.5, 40.0}) {
        const LensSide side = toric(SideForm::kToricY, kProfile, 1 / radius),
                       turned = toric(SideForm::kToricX, kProfile, 1 / radius);
        for (int i = 0; i < 500; ++i) {
            const double y = draw.uniform(-0.7, 0.7), angle = draw.uniform(-0.5, 0.5) / std::fabs(radius);
            // The profile's point, turned about the line x = 0, z = radius by a matrix.
            const double z = sag_at(side, y * y).z - radius;
            const Vec2 p(std::sin(angle) * -z, y);
            CHECK(std::fabs(sag_over(side, p).z - (radius + std::cos(angle) * z)) <
                  2e-15 * (1 + std::fabs(radius)));
            const SideSag along_y = sag_over(side, p), along_x = sag_over(turned, {p.y, p.x});
            CHECK(along_y.z == along_x.z);
            CHECK(along_y.slope.x == along_x.slope.y);
            CHECK(along_y.xx == along_x.yy);
        }
    }
    // A sphere by its great circle, nearly up to where it turns back.
    const LensSide sphere = toric(SideForm::kToricY, {0.5, 0, {}, 1.9}, 0.5);
    CHECK(side_room(sphere) > 0.02);
    CHECK(side_room(sphere) < 1 - 0.95 * 0.95);
    for (int i = 0; i < 500; ++i) {
        const Vec2 p = place_on(sphere, draw);
        CHECK(std::fabs(sag_over(sphere, p).z - (2 - std::sqrt(4 - dot(p, p)))) < 2e-15);
    }
    CHECK(std::isnan(sag_over(sphere, {2.1, 0}).z));
    CHECK(std::isnan(sag_over(sphere, {0, 2.1}).z));
}

TEST_CASE("derivatives of anamorphic sides are the change of what they derive, and within their bounds",
          "[lens][law]") {
    Draw draw(3);
    std::vector<LensSide> all = sides();
    all.push_back(kProfile);
    for (const LensSide& side : all) {
        REQUIRE(side_room(side) > 0.05);
        const SagBounds most = sag_bounds(side);
        double slope = 0, bend = 0, third = 0;
        for (int i = 0; i < 2000; ++i) {
            const Vec2 p = place_on(side, draw);
            const SideSag at = sag_over(side, p);
            constexpr double kStep = 1e-5;
            const SideSag right = sag_over(side, p + Vec2(kStep, 0)),
                          left = sag_over(side, p - Vec2(kStep, 0)), up = sag_over(side, p + Vec2(0, kStep)),
                          down = sag_over(side, p - Vec2(0, kStep));
            const auto change = [](double a, double b) { return (a - b) / (2 * kStep); };
            CHECK(std::fabs(change(right.z, left.z) - at.slope.x) < 1e-9);
            CHECK(std::fabs(change(up.z, down.z) - at.slope.y) < 1e-9);
            CHECK(std::fabs(change(right.slope.x, left.slope.x) - at.xx) < 1e-8);
            CHECK(std::fabs(change(up.slope.x, down.slope.x) - at.xy) < 1e-8);
            CHECK(std::fabs(change(right.slope.y, left.slope.y) - at.xy) < 1e-8);
            CHECK(std::fabs(change(up.slope.y, down.slope.y) - at.yy) < 1e-8);
            CHECK(std::fabs(at.z) <= most.z);
            slope = std::max(slope, length(at.slope));
            const double turn = draw.uniform(0, 6.2831853);
            const Vec2 a(std::cos(turn), std::sin(turn));
            bend = std::max(bend, std::fabs(at.bend(a, a)));
            const SideSag ahead = sag_over(side, p + kStep * a), back = sag_over(side, p - kStep * a);
            third = std::max(third, std::fabs(change(ahead.bend(a, a), back.bend(a, a))));
        }
        CHECK(slope <= most.first);
        CHECK(bend <= most.second);
        CHECK(third <= most.third + 1e-6);
        // Nor are they without use.
        CHECK(most.first < 4 * slope);
        CHECK(most.second < 12 * bend);
    }
}

TEST_CASE("larger anamorphic sides are the same shape", "[lens][law]") {
    Draw draw(4);
    for (const LensSide& side : sides()) {
        LensSide large = with_scaled_shape(side, 3);
        large.aperture *= 3;
        CHECK(std::fabs(side_room(large) - side_room(side)) < 1e-12);
        for (int i = 0; i < 100; ++i) {
            const Vec2 p = place_on(side, draw);
            CHECK(std::fabs(sag_over(large, 3.0 * p).z - 3 * sag_over(side, p).z) < 1e-14);
        }
    }
}

TEST_CASE("a cylinder lens gathers light in one section, at the thin lens' distance", "[lens][oracle]") {
    LensPrescription lens{"cylinder", "cylinder", {}};
    lens.rows.resize(2);
    for (const SideForm form : {SideForm::kToricY, SideForm::kToricX, SideForm::kBiconic}) {
        const double c = 0.01;
        LensSide front{c, 0, {}, 5}, back{-c, 0, {}, 5};
        front.form = back.form = form;
        lens.rows[0] = {front, 1e-6, {"glass", 1.5, 0}};
        lens.rows[1] = {back, 0};
        const LensSection with = form == SideForm::kToricX ? LensSection::kX : LensSection::kY;
        const LensSection without = with == LensSection::kX ? LensSection::kY : LensSection::kX;
        const FirstOrder first = first_order(section_of(lens, with));
        CHECK(std::fabs(first.focal_length - 1 / ((1.5 - 1) * 2 * c)) < 1e-6);
        CHECK(std::fabs(crossing(lens, with, 1e-3) - 100) < 1e-5);
        CHECK_THROWS_AS(first_order(section_of(lens, without)), InputError);
        CHECK(imaging_section(lens) == with);
        // The spot lies in that focus: a line as long as the beam is wide.
        const Spot spot = spot_of(lens, {.pupil_radius = 0.1});
        for (const Vec2& p : spot.points) CHECK(std::fabs(with == LensSection::kX ? p.x : p.y) < 1e-6);
        CHECK(std::fabs(spot.radius - 0.1) < 1e-6);
        Vec3 origin(0, 0, -1);
        origin[without == LensSection::kX ? 0 : 1] = 3;
        const auto ray = trace_lens(lens, {origin, {0, 0, 1}});
        REQUIRE(ray);
        CHECK(length(ray->direction - Vec3(0, 0, 1)) < 1e-16);
    }
}

TEST_CASE("a meniscus that bends nothing along y leaves the section to the cylinder behind it",
          "[lens][bad-input]") {
    const double n = 1.5168;
    for (const auto& [radius, thickness] : {std::pair{50.0, 4.0}, {70.0, 3.0}, {37.0, 5.0}, {41.3, 6.1}}) {
        CAPTURE(radius);
        LensPrescription lens{"afocal", "afocal", {}};
        lens.rows.resize(4);
        lens.rows[0] = {{1 / radius, 0, {}, 8}, thickness, {"glass", n, 0}};
        lens.rows[1] = {{1 / (radius - thickness * (n - 1) / n), 0, {}, 8}, 5};
        lens.rows[2] = {{1.0 / 30, 0, {}, 8, {}, SideForm::kToricX}, 4, {"glass", n, 0}};
        lens.rows[3].side.aperture = 8;
        CHECK(imaging_section(lens) == LensSection::kX);
        CHECK_THROWS_AS(first_order(lens), InputError);
        CHECK(first_order(section_of(lens, LensSection::kX)).focal_length > 30 / (n - 1));
        // A weak lens is one: the radius is off by some hundredths of a nanometre.
        lens.rows[1].side.curvature *= 1 + 1e-9;
        CHECK(imaging_section(lens) == LensSection::kY);
    }
}

TEST_CASE("the field of a spot lies in the imaging section, where the image height is", "[lens][law]") {
    LensPrescription lens{"cylinder", "cylinder", {}};
    lens.rows.resize(2);
    for (const SideForm form : {SideForm::kToricX, SideForm::kToricY}) {
        lens.rows[0] = {{1.0 / 30, 0, {}, 8, {}, form}, 4, {"glass", 1.5168, 0}};
        lens.rows[1] = {{}, 0};
        const LensSection section = imaging_section(lens);
        const int k = section == LensSection::kX ? 0 : 1;
        const double slope = std::tan(20 * 3.141592653589793 / 180);
        const SeidelSums sums = seidel_sums(section_of(lens, section), {0.01, slope});
        const Spot spot = spot_of(lens, {.pupil_radius = 0.01, .field_degrees = 20});
        CHECK(std::fabs(sums.image_height - 30 / 0.5168 * slope) < 1e-9);
        // Distortion is a part in a hundred.
        CHECK(std::fabs(spot.centroid[k] / sums.image_height - 1) < 0.01);
        CHECK(std::fabs(spot.centroid[1 - k]) < 1e-9);
    }
}

TEST_CASE(
    "each section of an anamorphic lens has its focus, and its rays those of the round lens of its profile",
    "[lens][law]") {
    const LensPrescription lens = toric_singlet();
    CHECK_FALSE(is_round(lens));
    CHECK(first_order(lens).focal_length == first_order(section_of(lens, LensSection::kY)).focal_length);
    for (const LensSection section : {LensSection::kY, LensSection::kX}) {
        const LensPrescription cut = section_of(lens, section);
        CHECK(is_round(cut));
        CHECK(std::fabs(crossing(lens, section, 1e-3) - first_order(cut).back_focal_length) < 1e-5);
        for (const double height : {1.0, 3.0, 7.0})
            CHECK(std::fabs(crossing(lens, section, height) - crossing(cut, section, height)) < 1e-11);
    }
    CHECK(first_order(section_of(lens, LensSection::kX)).focal_length > 1.1 * first_order(lens).focal_length);
}

TEST_CASE("anamorphic sides of which no lens can be made are refused", "[lens][bad-input]") {
    const LensSide flat{0, 0, {}, 1};
    const auto fault = [&](const LensSide& side) { return std::string(lens_fault(side, flat, 2)); };
    CHECK(fault(biconic(0.2, 0, 1.01, 0, 1)).find("turns back") != std::string::npos);
    CHECK(fault(toric(SideForm::kToricY, kProfile, 1.5)).find("turns back") != std::string::npos);
    CHECK(fault(toric(SideForm::kToricX, {0.9, 0, {}, 1}, 3)).find("turns back") != std::string::npos);
    LensSide odd = biconic(0.2, 0, 0.1, 0, 1);
    odd.coefficients[1] = 0.1;
    CHECK(fault(odd).find("coefficients") != std::string::npos);
    odd.coefficients[1] = 0;
    odd.normal_departures[0] = 0.1;
    CHECK(fault(odd).find("not round") != std::string::npos);
    // Rims that meet along x alone.
    CHECK(std::string(lens_fault(biconic(0, 0, 0.8, 0, 1), flat, 0.4)).find("no edge") != std::string::npos);
    CHECK(lens_fault(biconic(0, 0, 0.8, 0, 1), flat, 0.6) == nullptr);
    LensPrescription lens = toric_singlet();
    lens.rows[0].side.across_curvature = std::nan("");
    CHECK_THROWS_AS(check_prescription(lens), InputError);
}
