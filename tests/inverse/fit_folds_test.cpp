// Fits with pairs near folds: their errors are those that their covariances tell.
#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "base/util/format.h"
#include "fit_scenes.h"
#include "inverse/fit/fit.h"
#include "inverse/fit/fit_problem.h"
#include "inverse/solve/least_squares.h"
#include "scene/read/override.h"
#include "support/draw.h"
#include "support/test.h"
#include "trilens/render.h"
#include "trilens/scene.h"

using namespace trilens;
using trilens_test::with_noise;

namespace {

/// A drop whose inner reflection folds over (the rainbow), or glass of the shape of a cage's limit surface.
std::string folding_scene(bool is_drop) {
    const char* const shape = is_drop
                                  ? R"("primitive": {"type": "sphere", "radius": 1.2})"
                                  : R"("points": [[-1.3, -0.9, -1.7], [-1.3, -0.9, 1.7], [-1.3, 0.9, -1.7],
    [-1.3, 0.9, 1.7], [1.3, -0.9, -1.7], [1.3, -0.9, 1.7], [1.3, 0.9, -1.7], [1.3, 0.9, 1.7]],
   "faceVertexCounts": [4, 4, 4, 4, 4, 4], "transform": {"rotate": [0.1, 0.2, 0.05, 0.97]},
   "faceVertexIndices": [0, 1, 3, 2, 4, 6, 7, 5, 0, 4, 5, 1, 2, 3, 7, 6, 0, 2, 6, 4, 1, 5, 7, 3])";
    return fmt::format(R"({{"version": 1, "film": {{"width": 80, "height": 60}},
 "cameras": [{{"yfov": 40, "lookAt": {{"eye": [0, 0.4, 4.5], "at": [0, 0, 0]}}}}],
 "materials": [{{"name": "glass", "transmissionFactor": 1, "ior": 1.5}}],
 "meshes": [{{"name": "body", "role": "optic", "material": "glass", {}}}]}})",
                       shape);
}

/// Seeded pairs of random places of the film and points on the rays behind them.
std::vector<Correspondence> shot_pairs(const Renderer& renderer, const std::string& word,
                                       trilens_test::Draw& draw) {
    ShootRequest request;
    request.path = EventWord(word);
    std::vector<Correspondence> pairs;
    while (pairs.size() < 40) {
        std::vector<Vec2> places;
        for (int k = 0; k < 200; ++k) {
            const double x = draw.uniform(0, 80), y = draw.uniform(0, 60);
            places.emplace_back(x, y);
        }
        const ShotRays shot = renderer.shoot(places, request);
        for (std::size_t k = 0; k < places.size() && pairs.size() < 40; ++k) {
            const ShotRay& ray = shot.rays[k];
            if (!ray.followed()) continue;
            Correspondence pair;
            pair.pixel = places[k];
            pair.point = ray.origin + draw.uniform(4, 8) * ray.direction;
            pairs.push_back(pair);
        }
    }
    return pairs;
}

/// The error's square over its variance, over all numbers: of right covariances 1 in the mean.
double squared_error(const FitResult& found, std::span<const double> truth) {
    const std::size_t n = truth.size();
    DenseMatrix correlation(n, n);
    std::vector<double> off(n);
    for (std::size_t i = 0; i < n; ++i) {
        std::copy(found.correlation[i].begin(), found.correlation[i].end(), correlation.row(i).begin());
        off[i] = (found.parameters[i].value - truth[i]) / found.parameters[i].sigma;
    }
    const SingularValues parts = singular_values(correlation, off);
    double sum = 0;
    for (std::size_t k = 0; k < n; ++k)
        for (std::size_t i = 0; i < n; ++i)
            sum += off[i] * parts.right(i, k) * parts.projection[k] / parts.values[k];
    return sum / static_cast<double>(n);
}

struct FoldCase {
    bool is_drop = false;
    FitMatch match = FitMatch::kRay;
};

}  // namespace

TEST_CASE("fits with pairs near folds err as much as their covariances tell", "[inverse][fit][law]") {
    constexpr unsigned kDraws = 16;
    constexpr double kSigma = 0.3;
    for (const FoldCase one : {FoldCase{true, FitMatch::kRay}, FoldCase{true, FitMatch::kNearest},
                               FoldCase{false, FitMatch::kRay}, FoldCase{false, FitMatch::kNearest}}) {
        INFO(one.is_drop << " " << static_cast<int>(one.match));
        const Scene truth = parse_scene(folding_scene(one.is_drop));
        const Renderer renderer(truth);
        FitRequest request;
        request.match = one.match;
        request.sigma = kSigma;
        request.path = one.is_drop ? "TRT" : "TT";
        const char* const place =
            one.is_drop ? "/meshes/0/primitive/center" : "/meshes/0/transform/translate";
        request.free = {place, "/materials/0/ior"};
        trilens_test::Draw draw(5);
        std::vector<double> errors;
        for (unsigned k = 0; k < kDraws; ++k) {
            const std::vector<Correspondence> pairs =
                with_noise(shot_pairs(renderer, request.path, draw), kSigma, 100 + k);
            const double x = draw.uniform(-0.03, 0.03), y = draw.uniform(-0.03, 0.03),
                         z = draw.uniform(-0.03, 0.03), ior = draw.uniform(1.49, 1.51);
            const std::vector<SceneOverride> start = {{place, fmt::format("[{}, {}, {}]", x, y, z)},
                                                      {"/materials/0/ior", fmt::format("{}", ior)}};
            const FitResult found =
                fit_scene(parse_scene(folding_scene(one.is_drop), "", start), pairs, request);
            errors.push_back(squared_error(found, std::array{0.0, 0.0, 0.0, 1.5}));
        }
        std::sort(errors.begin(), errors.end());
        const double median = errors[kDraws / 2], third = errors[kDraws - 3], worst = errors.back();
        CAPTURE(median, third, worst);
        CHECK(median > 0.4);
        CHECK(median < 2.2);  // of so few draws; 0.84 is right
        CHECK(third < 4);
        CHECK(worst < 200);
    }
}

TEST_CASE("the whitening of a pair near a fold is that of its second moments", "[inverse][fit]") {
    trilens_test::Draw draw(3);
    for (int k = 0; k < 20; ++k) {
        // The moments of normal z and w: of z + e z^2 + f z w + g w^2.
        const double e = draw.uniform(-3, 3), f = draw.uniform(-3, 3), g = draw.uniform(-3, 3);
        const double variance =
            normal_mean_square([&](double z, double w) { return z + e * z * z + f * z * w + g * w * w; });
        CHECK(std::abs(variance - (1 + 3 * e * e + f * f + 3 * g * g + 2 * e * g)) < 1e-12 * variance);

        const double angle = draw.uniform(0, 6.3), turn = draw.uniform(0, 6.3);
        const FoldWhitening whitening{Vec2(std::cos(angle), std::sin(angle)), draw.log_uniform(1, 1e9)};
        // Its square undoes the covariance: W (I + (variance - 1) a a^T) W = I.
        const Vec2 any(std::cos(turn), std::sin(turn)), once = whitening.of(any);
        const Vec2 back =
            whitening.of(once + (whitening.variance - 1) * dot(whitening.along, once) * whitening.along);
        CHECK(length(back - any) < 1e-9);
    }
    CHECK(FoldWhitening{}.of(Vec2(3, 4)) == Vec2(3, 4));
    CHECK(normal_mean_square([](double, double) -> std::optional<double> { return std::nullopt; }) == 0);

    const std::array<Vec3, 2> slope{Vec3(1, 2, 0), Vec3(3, 6, 0.1)};
    const FastestMotion fastest = fastest_motion(slope);
    CHECK(std::abs(length(fastest.along) - 1) < 1e-14);
    for (int k = 0; k < 20; ++k) {
        const double angle = draw.uniform(0, 6.3);
        CHECK(length(std::cos(angle) * slope[0] + std::sin(angle) * slope[1]) <= fastest.rate * (1 + 1e-12));
    }
}
