// What is proven of displacement, held against what is measured between two pictures.
#include <algorithm>
#include <cmath>
#include <vector>

#include "base/util/error.h"
#include "laws/worlds.h"
#include "measure/displacement/displacement.h"
#include "render/picture/picture.h"
#include "support/test.h"

using namespace trilens;
using namespace trilens_test;

namespace {

constexpr double kLimit = 0.5;      // pixels
constexpr double kMeasured = 0.02;  // how far off a measured displacement may be itself

PictureRequest certified(double limit) {
    PictureRequest request;
    request.frame.max_error = limit;
    request.frame.certify = true;
    request.layers.layers = {"optic", "reflect", "refract", "stat", "bound"};
    return request;
}

Picture draw(const World& world, PictureRequest request) {
    return draw_picture(world, request, {}, ignore);
}

Image truth_of(const World& world) {
    PictureRequest request;
    request.engine = Engine::kLimitTruth;
    request.layers.layers = {"optic", "reflect", "refract", "stat", "bound"};
    return draw(world, request).image;
}

struct Held {
    std::size_t certified = 0, measured = 0;
    double largest = 0, off_mean = 0;  // of bounds; of bound - displacement
};

/// Every pixel's bound against its displacement.
Held hold_bounds(const Picture& picture, const Image& truth) {
    const auto& bound = picture.image.find("bound")->floats();
    const auto& method = picture.image.find("stat.method")->ids();
    const auto displacement = measure_displacement(truth, picture.image, "reflect");
    REQUIRE(displacement);
    Held held;
    for (std::size_t p = 0; p < bound.size(); ++p) {
        CHECK(bound[p] <= kLimit);
        if (method[p] == 2) CHECK(bound[p] == 0);
        if (!(bound[p] > 0)) continue;
        ++held.certified;
        held.largest = std::max(held.largest, double{bound[p]});
        if (displacement->state[p] != Shift::kFound) continue;
        ++held.measured;
        const double shift = std::hypot(displacement->shift_x[p], displacement->shift_y[p]);
        CHECK(shift <= bound[p] + kMeasured);
        held.off_mean += bound[p] - shift;
    }
    held.off_mean /= static_cast<double>(std::max<std::size_t>(held.measured, 1));
    return held;
}

}  // namespace

TEST_CASE("no pixel of a mirror is displaced by more than is proven, and nearly all are proven",
          "[laws][law]") {
    struct Case {
        const char* scene;
        double least_share;  // of the optic's pixels, proven
    };
    for (const auto& [scene, least_share] :
         {Case{"sphere", 0.98}, {"saddle", 0.9}, {"torus", 0.85}, {"closed", 0.9}}) {
        const auto world = shipped_world(scene, 8, 160, 120);
        const Picture picture = draw(*world, certified(kLimit));
        const Held held = hold_bounds(picture, truth_of(*world));
        CAPTURE(scene, held.certified, picture.statistics.optic_pixels, held.measured, held.off_mean);
        CHECK(held.certified == picture.statistics.certified_pixels);
        CHECK(static_cast<float>(picture.statistics.certified_error) <= held.largest);
        CHECK(held.certified + picture.statistics.traced_pixels == picture.statistics.optic_pixels);
        CHECK(static_cast<double>(held.certified) >=
              least_share * static_cast<double>(picture.statistics.optic_pixels));
        CHECK(static_cast<double>(held.measured) > 0.9 * static_cast<double>(held.certified));
        CHECK(std::fabs(held.off_mean) < 0.003);
    }
}

TEST_CASE("flat mirrors are proven exact, to rounding", "[laws][law]") {
    const auto world = shipped_world("flat", 2, 160, 120);
    const Picture picture = draw(*world, certified(kLimit));
    CHECK(picture.statistics.certified_pixels > 1000);
    CHECK(picture.statistics.certified_error < 1e-4);
}

TEST_CASE("what is not proven is traced: glass, and whatever is off by more", "[laws][law]") {
    const auto glass = shipped_world("paths/crystal-ball", 8, 80, 60);
    const Picture of_glass = draw(*glass, certified(kLimit));
    CHECK(of_glass.statistics.certified_pixels == 0);
    CHECK(of_glass.statistics.traced_pixels == of_glass.statistics.optic_pixels);

    // A limit that facets of that size do not keep where they are not divided so far.
    const auto mirror = shipped_world("sphere", 8, 160, 120);
    const Picture strict = draw(*mirror, certified(1e-3));
    CHECK(strict.statistics.traced_pixels > 0);
    CHECK(strict.statistics.certified_error <= 1e-3);
}

TEST_CASE("a proof needs an error to prove", "[laws]") {
    const auto world = shipped_world("sphere", 4, 40, 30);
    CHECK_THROWS_AS(draw(*world, certified(0)), UsageError);
}
