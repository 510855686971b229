// Pairs of a fit: which are lost, which lie far off, and what noise all of them show.
#include <algorithm>
#include <cmath>
#include <limits>

#include "base/util/format.h"
#include "fit_scenes.h"
#include "inverse/fit/fit.h"
#include "inverse/fit/fit_problem.h"
#include "scene/read/override.h"
#include "support/draw.h"
#include "support/test.h"
#include "trilens/project.h"
#include "trilens/render.h"
#include "trilens/scene.h"

using namespace trilens;
using trilens_test::make_pairs;
using trilens_test::with_noise;

namespace {

/// A ball whose centre and one more number are free, and where its fit begins.
struct StartedBall {
    std::string json, word;
    std::vector<SceneOverride> start;
    std::vector<std::string> free;
};

std::vector<StartedBall> started_balls() {
    const SceneOverride center{"/meshes/0/primitive/center", "[0.1, 0.05, -0.08]"};
    return {{trilens_test::ball_scene(),
             "R",
             {center, {"/meshes/0/primitive/radius", "0.93"}},
             {"/meshes/0/primitive/center", "/meshes/0/primitive/radius"}},
            {trilens_test::glass_scene(),
             "TT",
             {center, {"/materials/glass/ior", "1.42"}},
             {"/meshes/0/primitive/center", "/materials/glass/ior"}}};
}

}  // namespace

TEST_CASE("a pair that shows a point beside the optic is lost, and is not held against its direct image",
          "[inverse]") {
    for (const StartedBall& one : started_balls()) {
        INFO(one.word);
        const Scene truth = parse_scene(one.json);
        std::vector<Correspondence> pairs = with_noise(make_pairs(truth, 60, one.word), 0.5, 3);
        FitRequest request;
        request.free = one.free;
        request.huber = std::numeric_limits<double>::infinity();
        const FitResult without = fit_scene(parse_scene(one.json, "", one.start), pairs, request);
        // Seen past the ball, where the camera shows the point itself.
        const std::vector<Vec3> beside{{2, 1.2, -1}};
        Correspondence direct;
        direct.point = beside[0];
        const std::vector<WorldImage> seen = Renderer(truth).project(beside)[0].images;
        REQUIRE(seen[0].path == Path::kDirect);
        direct.pixel = seen[0].pixel + Vec2(9, 0);
        pairs.push_back(direct);
        for (const FitMatch match : {FitMatch::kRay, FitMatch::kNearest}) {
            request.match = match;
            const FitResult found = fit_scene(parse_scene(one.json, "", one.start), pairs, request);
            if (match == FitMatch::kNearest && found.pairs.back().state != PairState::kLost) continue;
            CHECK(found.lost == 1);
            CHECK(found.pairs.back().state == PairState::kLost);
            CHECK(found.used == pairs.size() - 1);
            CHECK(std::abs(found.rms - without.rms) < 1e-6);
            for (std::size_t p = 0; p < found.parameters.size(); ++p)
                CHECK(std::abs(found.parameters[p].value - without.parameters[p].value) < 1e-7);
            CHECK(std::any_of(found.warnings.begin(), found.warnings.end(), [](const std::string& warning) {
                return warning.find("1 of 61 pairs are lost") == 0;
            }));
        }
    }
}

TEST_CASE("the noise that a fit tells is that of the pixels, whatever sigma says", "[inverse][law]") {
    const StartedBall one = started_balls()[0];
    const std::vector<Correspondence> pairs = make_pairs(parse_scene(one.json), 300, "R");
    FitRequest request;
    request.free = one.free;
    for (const double noise : {0.5, 2.0, 3.0, 5.0, 8.0}) {
        std::vector<Correspondence> noisy = with_noise(pairs, noise, 11);
        for (const bool is_told : {false, true}) {
            INFO(noise << " px" << (is_told ? ", told" : ""));
            request.sigma = is_told ? noise : 0.5;
            const FitResult found = fit_scene(parse_scene(one.json, "", one.start), noisy, request);
            CHECK(std::abs(found.noise / noise - 1) < 0.1);
            if (!is_told) continue;
            // The limit is in standard deviations: at 8 no normal pixel lies beyond.
            CHECK(found.outliers == 0);
            for (Correspondence& pair : noisy) pair.sigma = noise;
            request.sigma = 0.5;
            const FitResult by_pair = fit_scene(parse_scene(one.json, "", one.start), noisy, request);
            CHECK(by_pair.outliers == 0);
            CHECK(std::abs(by_pair.noise - found.noise) < 1e-6);
        }
        // A tenth of wrong pairs hardly moves it.
        request.sigma = noise;
        for (std::size_t i = 0; i < noisy.size(); i += 10)
            noisy[i].pixel += 20 * noise * normalize(Vec2(512, 384) - noisy[i].pixel);
        CHECK(std::abs(fit_scene(parse_scene(one.json), noisy, request).noise / noise - 1) < 0.15);
    }
}

TEST_CASE("a fit whose rms rose says so", "[inverse]") {
    const Scene truth = parse_scene(trilens_test::ball_scene());
    const std::vector<Correspondence> pairs = make_pairs(truth, 20, "R");
    FitRequest request;
    request.free = {"/meshes/0/primitive/radius"};
    request.priors = {{"/meshes/0/primitive/radius", {1.05}, 1e-5}};
    const FitResult found = fit_scene(truth, pairs, request);
    REQUIRE(found.rms > found.rms_start);
    CHECK(std::any_of(found.warnings.begin(), found.warnings.end(),
                      [](const std::string& warning) { return warning.find("the rms rose, from ") == 0; }));
}

TEST_CASE("a fit that agrees with few pairs says so", "[inverse]") {
    const Scene scene = parse_scene(trilens_test::ball_scene());
    std::vector<Correspondence> pairs = make_pairs(scene, 12, "R");
    FitRequest request;
    request.free = {"/meshes/0/primitive/radius"};
    CHECK(fit_scene(scene, pairs, request).warnings.empty());
    for (std::size_t i = 0; i < 9; ++i) pairs[i].pixel += (i % 2 == 0 ? 1.0 : -1.0) * Vec2(9, -12);
    const FitResult found = fit_scene(scene, pairs, request);
    REQUIRE(2 * found.outliers > pairs.size());
    const std::string says = fmt::format("{} of {} pairs are outliers", found.outliers, pairs.size());
    CHECK(std::any_of(found.warnings.begin(), found.warnings.end(),
                      [&](const std::string& warning) { return warning.find(says) == 0; }));
}

TEST_CASE("a pair near a fold, which fixes a number alone, is named; few pairs, or even ones, are not",
          "[inverse][fit]") {
    trilens_test::Draw draw(17);
    const auto warned = [&](std::size_t count, double fold) {
        DenseMatrix jacobian(2 * count, 3);
        for (double& value : jacobian.values) value = draw.uniform(-1, 1);
        for (const std::size_t i : {0, 1, 2}) jacobian(8, i) *= fold;
        return leverage_warnings(jacobian, uncertainty_of(jacobian), std::vector<FitPair>(count));
    };
    CHECK(warned(20, 1).empty());
    CHECK(warned(6, 1000).empty());
    const std::vector<std::string> warnings = warned(20, 1000);
    REQUIRE(warnings.size() == 1);
    CHECK(warnings[0].find("pair 5 alone fixes") == 0);
}

TEST_CASE("a pair that keeps its path is lost where its pixel's ray goes over another optic",
          "[inverse][fit]") {
    const Scene scene = parse_scene(R"({"version": 1, "film": {"width": 320, "height": 240},
 "cameras": [{"yfov": 40, "lookAt": {"eye": [0, 0, 6], "at": [0, 0, 0]}}],
 "materials": [{"name": "chrome", "metallicFactor": 1, "roughnessFactor": 0}],
 "meshes": [{"name": "behind", "role": "optic", "material": "chrome",
             "primitive": {"type": "sphere", "center": [0, 0, -3], "radius": 2}},
            {"name": "before", "role": "optic", "material": "chrome",
             "primitive": {"type": "sphere", "center": [0, 0, 0], "radius": 0.6}}]})");
    // Its image lies over the one behind, beside the one before; its pixel is off by so much that it shows
    // that.
    const Vec2 image(215, 120);
    const ShotRays shot = Renderer(scene).shoot(std::vector<Vec2>{image});
    REQUIRE(shot.events_of(shot.rays[0]).size() == 1);
    REQUIRE(shot.events_of(shot.rays[0])[0].optic == 0);
    FitPair pair;
    pair.pixel = {180, 120};
    pair.point = shot.rays[0].origin + 3.0 * shot.rays[0].direction;
    pair.word = "R";
    pair.guess = image;
    pair.events = 1;
    Json document = resolved_json(scene);
    const std::vector<FitParameter> free =
        find_parameters(document, std::vector<std::string>{"/meshes/0/primitive/radius"}, "scene", 3);
    for (const bool keeps : {true, false}) {
        FitProblem problem(scene, document, free, {pair});
        problem.keeps_paths = keeps;
        problem.residual = FitResidual::kImage;
        const Linearisation at = problem.linearise();
        CHECK(std::hypot(at.residuals[0] - 35, at.residuals[1]) < 1e-6);
        problem.residual = FitResidual::kRay;
        problem.linearise();
        CHECK(problem.pairs()[0].is_lost == keeps);
        CHECK(problem.pairs()[0].path.at(0).optic == (keeps ? 0 : 1));
    }
}
