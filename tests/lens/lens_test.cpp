// Lenses by their prescriptions: published focal lengths and aberrations, exact rays, and what is refused.
#include <array>
#include <cmath>
#include <numbers>
#include <string>

#include "base/util/error.h"
#include "lens/sequential_rays.h"
#include "support/draw.h"
#include "support/published_lenses.h"
#include "support/test.h"

using namespace trilens;
using namespace trilens_test;

namespace {

/// A published number with so many digits behind the point.
bool agrees(double value, double published, int digits) {
    return std::fabs(value - published) <= 0.5 * std::pow(10.0, -digits);
}

/// Where an exact ray that comes in along the axis at that height crosses the plane of the paraxial focus.
double height_in_focus(const LensPrescription& lens, double height) {
    const FirstOrder first = first_order(lens);
    const auto ray = trace_lens(lens, {{0, height, -1}, {0, 0, 1}}, SpectralLine::kD, ApertureRule::kAll);
    REQUIRE(ray);
    const double way = first.length + first.back_focal_length - ray->origin.z;
    return ray->origin.y + way * ray->direction.y / ray->direction.z;
}

std::string message_of(const LensPrescription& lens) {
    try {
        lens_elements(lens);
    } catch (const InputError& error) {
        return error.what();
    }
    return "";
}

/// A singlet of BK7 about a stop.
LensPrescription singlet(const LensSide& front, const LensSide& back) {
    LensPrescription lens{"singlet", "singlet", {}};
    lens.rows = {{front, 3, find_glass("N-BK7", "", ""), true, "line 1"}, {back, 0, {}, false, "line 2"}};
    return lens;
}

/// Two lenses with sides of such radii next to each other, whose rims lie at 10; along the axis, or behind a
/// flat mirror and against it (sense -1).
LensPrescription neighbours(double rear, double front, double air, double sense = 1) {
    const auto side = [&](double radius) { return LensSide{.curvature = sense / radius, .aperture = 10}; };
    const Glass glass = find_glass("N-BK7", "", "");
    LensPrescription lens{"pair", "pair", {}};
    lens.rows = {{side(40), sense * 6, glass, false, "line 1"},
                 {side(rear), sense * air, {}, false, "line 2"},
                 {side(front), sense * 5, glass, false, "line 3"},
                 {side(-60), 0, {}, false, "line 4"}};
    if (sense > 0) return lens;
    LensRow mirror{.side = {.aperture = 10}, .thickness = -20, .place = "line 0", .mirror = true};
    lens.rows.insert(lens.rows.begin(), mirror);
    return lens;
}

}  // namespace

TEST_CASE("published lenses have their published focal lengths, to the tables' digits", "[lens][oracle]") {
    const FirstOrder triplet = first_order(cooke_triplet());
    CHECK(agrees(triplet.focal_length, 101.181, 3));
    CHECK(agrees(triplet.back_focal_length, 77.405, 3));
    CHECK(agrees(triplet.length, 39.08, 2));
    CHECK(agrees(triplet.petzval_radius / triplet.focal_length, -2.935, 3));
    CHECK(agrees(triplet.entrance_pupil, 6.411174 / 0.21, 3));

    const FirstOrder gauss = first_order(double_gauss());
    CHECK(agrees(gauss.focal_length, 100.1, 1));
    CHECK(agrees(gauss.back_focal_length, 56.424, 2));
    CHECK(agrees(gauss.length, 114.72, 2));
    // A sum that nearly cancels: the table's indices have four digits.
    CHECK(std::fabs(gauss.petzval_radius / gauss.focal_length + 3.801) < 0.01);
}

TEST_CASE("the Cooke triplet's aberrations are those of the published table, surface by surface",
          "[lens][oracle]") {
    // Transverse, in the third order: spherical, sagittal coma, astigmatism, Petzval, distortion; chromatic,
    // axial and lateral.
    constexpr std::array<std::array<double, 7>, 7> kPublished{
        {{-0.709019, -0.070068, -0.006924, -0.330897, -0.033385, -0.25596, -0.025295},
         {-0.75536, 0.844458, -0.944066, -0.036241, 1.095939, -0.187385, 0.209488},
         {2.049816, -1.416428, 0.978756, 0.300215, -0.883772, 0.419729, -0.290034},
         {0.493011, 0.393733, 0.314447, 0.351763, 0.532055, 0.287842, 0.229879},
         {0, 0, 0, 0, 0, 0, 0},
         {-0.035845, -0.087854, -0.215325, -0.06051, -0.676055, -0.063021, -0.154461},
         {-1.229178, 0.317877, -0.082206, -0.334022, 0.107641, -0.223595, 0.057824}}};
    const SeidelSums seidel = seidel_sums(cooke_triplet(), {14.6, 0.21});
    CHECK(agrees(seidel.image_slope, -0.144296, 5));
    CHECK(agrees(seidel.image_height, 21.248022, 3));
    const double scale = 1 / (2 * seidel.image_slope);
    for (std::size_t i = 0; i < kPublished.size(); ++i) {
        const SeidelTerms& t = seidel.rows[i];
        const std::array<double, 7> found{t.spherical,         t.coma,       t.astigmatism,
                                          t.petzval,           t.distortion, 2 * t.axial_colour,
                                          2 * t.lateral_colour};
        for (std::size_t k = 0; k < found.size(); ++k) {
            CAPTURE(i, k);
            // The table was computed with six digits, its Abbe numbers have four.
            CHECK(std::fabs(found[k] * scale - kPublished[i][k]) < (k < 5 ? 1e-5 : 4e-5));
        }
    }
}

TEST_CASE("a double Gauss has the Seidel sums that another program finds", "[lens][oracle]") {
    // The double Gauss of 28 degrees at f/5 of Zemax' samples, by Optiland's (its tests of aberrations).
    const std::array<double, 5> published{-0.003929457875534847, 0.0003954597633218682, 0.0034239055031729947,
                                          -0.016264753735226404, -0.046484107476755930};
    const LensPrescription lens = double_gauss_of_28_degrees();
    const double radius = first_order(lens).focal_length / 10;
    const SeidelSums seidel = seidel_sums(lens, {radius, std::tan(14 * std::numbers::pi / 180)});
    const SeidelTerms& sum = seidel.sum;
    const std::array<double, 5> found{sum.spherical, sum.coma, sum.astigmatism, sum.petzval, sum.distortion};
    // The sums cancel to a tenth of their terms; indices have five digits here, and more there.
    for (std::size_t k = 0; k < found.size(); ++k) {
        CAPTURE(k);
        CHECK(std::fabs(found[k] + published[k]) < (k < 4 ? 3e-7 : 3e-6));
    }
    CHECK(std::fabs(seidel.image_slope + 0.1) < 1e-12);
}

TEST_CASE("exact rays near the axis are paraxial, and Seidel's spherical aberration is their next order",
          "[lens][oracle]") {
    LensPrescription asphere =
        singlet({0.03, -1.7, {0.0004, 2e-6, 1e-9}, 8}, {-0.02, 0.4, {-0.0002, -1e-6}, 8});
    for (const LensPrescription& lens : {cooke_triplet(), double_gauss(), asphere}) {
        CAPTURE(lens.name);
        double before = 0;
        for (const double height : {1.0, 0.5, 0.25, 0.125}) {
            const SeidelSums seidel = seidel_sums(lens, {height, 0});
            const double third = seidel.sum.spherical / (2 * seidel.image_slope);
            const double off = std::fabs(height_in_focus(lens, height) / third - 1);
            CHECK(off < 0.2 * height * height);
            // What is left is of the fifth order: a quarter for half the height.
            if (before > 0) CHECK(std::fabs(off / before - 0.25) < 0.02);
            before = off;
        }
    }
}

TEST_CASE("a conicoid that images a point without aberration does so by exact rays, and has no sum",
          "[lens][oracle]") {
    // Descartes: an ellipsoid of eccentricity 1 / n focuses in glass what comes along its axis; a plane
    // behind would refract, so the focus lies on the back, a sphere about it.
    const double n = 1.5168, radius = 20, focus = n * radius / (n - 1);
    LensPrescription lens = singlet({1 / radius, -1 / (n * n), {}, 5}, {0, 0, {}, 5});
    lens.rows[0].thickness = 30;
    lens.rows[1].side.curvature = 1 / (focus - 30);
    for (const double height : {0.5, 2.0, 4.9}) {
        const auto ray = trace_lens(lens, {{0, height, -5}, {0, 0, 1}}, SpectralLine::kD, ApertureRule::kAll);
        REQUIRE(ray);
        const double y = ray->origin.y + (focus - ray->origin.z) * ray->direction.y / ray->direction.z;
        CHECK(std::fabs(y) < 1e-12);
    }
    CHECK(std::fabs(seidel_sums(lens, {5, 0}).sum.spherical) < 1e-15);
}

TEST_CASE("pupils are images of the stop", "[lens]") {
    const LensPrescription lens = cooke_triplet();
    const FirstOrder first = first_order(lens);
    const std::size_t stop = stop_row(lens);
    CHECK(stop == 4);
    const auto chief = paraxial_ray(lens, {-first.entrance_pupil * 0.1, 0.1});
    CHECK(std::fabs(chief[stop].height) < 1e-13);
    CHECK(std::fabs(chief.back().height + first.exit_pupil * chief.back().slope) < 1e-12);
    const auto rim = paraxial_ray(lens, {first.entrance_radius, 0});
    CHECK(std::fabs(rim[stop].height - 10.3) < 1e-12);
    CHECK(std::fabs(std::fabs(rim.back().height + first.exit_pupil * rim.back().slope) - first.exit_radius) <
          1e-11);
}

TEST_CASE("a spot's beam is the pupil's, and colours part by the Abbe numbers", "[lens]") {
    const LensPrescription lens = cooke_triplet();
    const Spot middle = spot_of(lens, {.rings = 6});
    CHECK(middle.asked == 1 + 6 * 21);
    CHECK(middle.points.size() == middle.asked);
    CHECK(length(middle.centroid) < 1e-12);
    CHECK(middle.rms_radius < 0.1);
    const Spot aside = spot_of(lens, {.field_degrees = 12, .rings = 6});
    CHECK(aside.points.size() < aside.asked);  // rims of the outer lenses cut the beam
    CHECK(std::fabs(aside.centroid.y - first_order(lens).focal_length * std::tan(12 / 57.29577951)) < 0.2);
    const Glass& crown = lens.rows[0].glass;
    CHECK(std::fabs(index_at(crown, SpectralLine::kF) - index_at(crown, SpectralLine::kC) - 0.010450) < 1e-6);
}

TEST_CASE("glasses are found by name and by code, others are refused with the nearest", "[lens][bad-input]") {
    CHECK(find_glass("N-BK7", "", "").index == 1.5168);
    CHECK(find_glass("N-SF11", "", "").abbe == 25.68);
    CHECK(find_glass("517642", "", "").index == 1.517);
    CHECK(std::fabs(find_glass("517.642", "", "").abbe - 64.2) < 1e-12);
    CHECK(std::fabs(find_glass("516800.641700", "", "").abbe - 64.17) < 1e-12);
    CHECK(glass_names().size() > 100);
    CHECK(find_glass("n-bk7", "", "").name == "N-BK7");
    const std::vector<Glass> mine{{.name = "Mine", .index = 1.6, .abbe = 40},
                                  {.name = "BLACK", .fault = "a.agf: line 3: the glass BLACK has no index"}};
    CHECK(find_glass("MINE", "", "", mine).index == 1.6);
    const auto refusal = [](const std::string& name) {
        try {
            find_glass(name, "a.zmx", "line 7");
        } catch (const InputError& error) {
            return std::string(error.what());
        }
        return std::string();
    };
    CHECK_THROWS_WITH(find_glass("black", "a.zmx", "line 7", mine),
                      "a.zmx: line 7: a.agf: line 3: the glass BLACK has no index");
    CHECK(refusal("N-BK8").starts_with("a.zmx: line 7: unknown glass 'N-BK8'; did you mean 'N-BK7'?"));
    for (const char* name : {"", "PYREX", "12", "1.2", "517-42", "51764A", ".517642", "517642."}) {
        CAPTURE(name);
        CHECK(refusal(name).starts_with(std::string("a.zmx: line 7: unknown glass '") + name + "'"));
    }
}

TEST_CASE("bodies share the sides where they are cemented", "[lens]") {
    const auto elements = lens_elements(double_gauss());
    REQUIRE(elements.size() == 6);
    CHECK(elements[1].shape.back.curvature == elements[2].shape.front.curvature);
    CHECK(std::fabs(elements[1].pose.shift.z + elements[1].shape.thickness - elements[2].pose.shift.z) <
          1e-12);
    CHECK(elements[5].pose.shift.z == 98.72);
}

TEST_CASE("prescriptions of what is no lens are refused with the place of the row", "[lens][bad-input]") {
    const LensSide side{0.02, 0, {}, 10};
    LensPrescription lens = singlet(side, {-0.02, 0, {}, 10});
    CHECK(message_of(lens).empty());
    CHECK(message_of({"none", "none.zmx", {}}) == "none.zmx: has no surfaces");
    const auto with = [&](const auto& change) {
        LensPrescription changed = lens;
        change(changed.rows);
        return message_of(changed);
    };
    using Rows = std::vector<LensRow>;
    CHECK(with([](Rows& rows) { rows[0].thickness = 0; }) == "singlet: line 1: its glass has no thickness");
    CHECK(with([](Rows& rows) { rows[0].thickness = -1; }).ends_with("follow each other along the axis"));
    CHECK(with([](Rows& rows) { rows[1].stop = true; }) == "singlet: line 2: is a second stop");
    CHECK(with([](Rows& rows) { rows[1].glass = rows[0].glass; }).ends_with("the lens does not end"));
    CHECK(with([](Rows& rows) { rows[0].glass = {}; }).find("has no glass") != std::string::npos);
    CHECK(with([](Rows& rows) { rows[1].side.aperture = 0; }) ==
          "singlet: line 2: has no aperture, so no rim can be made");
    CHECK(with([](Rows& rows) { rows[0].side.aperture = 60; }).ends_with("to where the side turns back"));
    CHECK(with([](Rows& rows) { rows[0].thickness = 0.5; }).find("the sides meet") != std::string::npos);
    CHECK(with([](Rows& rows) { rows[1].side.curvature = std::nan(""); }).ends_with("is not finite"));
    CHECK(with([](Rows& rows) {
              rows[1].side.curvature = 0.2, rows[0].side.curvature = 0;
              rows[1].side.aperture = 4.9;
              rows[0].side.aperture = 4.9;
          }).empty());
    // A shell whose front reaches through its back.
    CHECK(with([](Rows& rows) {
              rows[0].side.coefficients[1] = -2e-3, rows[0].side.coefficients[0] = 0.05;
              rows[0].thickness = 0.2, rows[1].side.curvature = 0;
          }).find("cross") != std::string::npos);
    LensPrescription afocal = singlet({0, 0, {}, 5}, {0, 0, {}, 5});
    CHECK_THROWS_AS(first_order(afocal), InputError);
    CHECK_THROWS_AS(spot_of(lens, {.rings = 0}), UsageError);
    CHECK_THROWS_AS(spot_of(lens, {.field_degrees = 90}), UsageError);
}

TEST_CASE("a lens that stands in the next one is no pair of bodies", "[lens][bad-input]") {
    const std::string fault =
        "the next lens stands in this one: within their rims their sides cross in the air";
    // At the rim the rear side of radius 30 lies 1.716 behind its vertex, the front one of radius 60 only
    // 0.839.
    const double needed = (30 - std::sqrt(800.0)) - (60 - std::sqrt(3500.0));
    for (const double sense : {1.0, -1.0}) {
        INFO(sense);
        const LensPrescription crossing = neighbours(30, 60, needed - 0.01, sense);
        CHECK(message_of(crossing) == "pair: line 2: " + fault);
        REQUIRE(lens_faults(crossing).size() == 1);
        CHECK(lens_faults(crossing)[0].row == (sense > 0 ? 1u : 2u));
        CHECK(message_of(neighbours(30, 60, needed + 0.01, sense)).empty());
        CHECK(message_of(neighbours(60, 30, 0.1, sense)).empty());
        CHECK(message_of(neighbours(30, 30, 0, sense)).empty());  // they touch
    }
    // A stop in the air between them, and what has no rims, or is tilted.
    LensPrescription stopped = neighbours(30, 60, 0.05);
    stopped.rows.insert(stopped.rows.begin() + 2,
                        LensRow{.thickness = 0.05, .stop = true, .place = "line 2.5"});
    CHECK(message_of(stopped) == "pair: line 2: " + fault);
    LensPrescription rimless = neighbours(30, 60, 0.1), tilted = rimless;
    rimless.rows[1].side.aperture = 0;
    CHECK(lens_faults(rimless).empty());
    tilt_row(tilted.rows[2], {.degrees = {1, 0, 0}});
    CHECK(lens_faults(tilted).empty());
    // Sides of one glass.
    LensPrescription thin =
        singlet({.curvature = 1 / 20., .aperture = 15}, {.curvature = -1 / 20., .aperture = 15});
    REQUIRE(lens_faults(thin).size() == 1);
    CHECK(message_of(thin) == "singlet: line 1: " + lens_faults(thin)[0].what);
}
