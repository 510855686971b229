// When probing facets is worth it: the plan against played chances, and what it decides at its ends.
#include "paths/facets/optic_paths.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "intersect/random_scene.h"
#include "support/test.h"

using namespace trilens;
using namespace trilens_test;

namespace {

/// What is true of the parts of each level: shares that agree, and of these that are projected.
struct Chances {
    std::array<double, ProbeTally::kLevels> agree{}, projected{};
};

Chances random_chances(Random& random) {
    Chances chances;
    for (std::size_t i = 0; i < chances.agree.size(); ++i)
        chances.agree[i] = random.uniform(0, 1), chances.projected[i] = random.uniform(0, 1);
    return chances;
}

/// A survey so large that it says those.
ProbeTally survey_of(const Chances& chances) {
    ProbeTally tally;
    constexpr double kParts = 1e9;
    for (std::size_t i = 0; i < tally.level.size(); ++i) {
        const double agree = kParts * chances.agree[i];
        tally.level[i] = {static_cast<std::size_t>(kParts), static_cast<std::size_t>(agree),
                          static_cast<std::size_t>(agree),
                          static_cast<std::size_t>(agree * chances.projected[i])};
    }
    return tally;
}

/// What one part played out saves. `inside(level, samples)` and `divides(level, samples, probed)` decide.
template <typename Inside, typename Divides>
double played(const Chances& chances, const ProbeCosts& costs, int level, double samples,
              const Inside& inside, const Divides& divides, Random& random) {
    if (level >= ProbeTally::kLevels - 1 || samples < 1) return 0;
    const auto at = static_cast<std::size_t>(level);
    const bool agree = random.uniform(0, 1) < chances.agree[at];
    double saved = 0;
    if (agree) {
        if (!inside(level, samples)) return 0;
        saved -= costs.inside;
        if (random.uniform(0, 1) < chances.projected[at]) return saved + costs.saved * samples;
    }
    if (!divides(level, samples, agree)) return saved;
    if (!agree) saved -= costs.middle;
    for (int k = 0; k < 4; ++k)
        saved += played(chances, costs, level + 1, samples / 4, inside, divides, random);
    return saved;
}

}  // namespace

TEST_CASE("a plan without a survey probes everything", "[paths][law]") {
    const ProbePlan plan;
    CHECK_FALSE(plan.decides());
    for (const double samples : {0.0, 1.0, 1e6}) {
        CHECK(plan.is_worth_corners(samples));
        CHECK(plan.is_worth_inside(3, samples));
        CHECK(plan.is_worth_dividing(3, samples, false));
    }
}

TEST_CASE("what is worth it for some samples is so for more; few are never worth a probe", "[paths][law]") {
    Random random(71);
    for (int trial = 0; trial < 200; ++trial) {
        const double per_pixel = trial % 2 ? 1 : 64;
        const ProbePlan plan(per_pixel, ProbeCosts::of(per_pixel, trial % 3 == 0),
                             survey_of(random_chances(random)));
        CHECK(plan.samples_in(3) == 3 * per_pixel);
        const double least = plan.least_samples();
        CHECK(least > plan.costs().inside / plan.costs().saved);
        if (std::isfinite(least)) {
            CHECK(plan.is_worth_corners(least));
            CHECK_FALSE(plan.is_worth_corners(0.99 * least));
        }
        for (const bool probed : {false, true}) {
            bool corners = false, inside = false, divides = false;
            for (double samples = 1; samples < 1e6; samples *= 1.3) {
                CHECK((!corners || plan.is_worth_corners(samples)));
                CHECK((!inside || plan.is_worth_inside(1, samples)));
                CHECK((!divides || plan.is_worth_dividing(1, samples, probed)));
                corners = plan.is_worth_corners(samples);
                inside = plan.is_worth_inside(1, samples);
                divides = plan.is_worth_dividing(1, samples, probed);
            }
        }
    }
}

TEST_CASE("played out, no simpler rule saves more than the plan", "[paths][law]") {
    Random random(72);
    for (int trial = 0; trial < 12; ++trial) {
        const Chances chances = random_chances(random);
        const ProbePlan plan(1, ProbeCosts::of(1, trial % 2 == 0), survey_of(chances));
        const double samples = std::pow(10, random.uniform(1, 3));
        constexpr int kPlays = 3000;
        // The mean and its standard error.
        const auto mean_of = [&](const auto& inside, const auto& divides) {
            double sum = 0, squares = 0;
            for (int i = 0; i < kPlays; ++i) {
                const double one = played(chances, plan.costs(), 0, samples, inside, divides, random);
                sum += one, squares += one * one;
            }
            const double mean = sum / kPlays;
            return std::pair(mean, std::sqrt(std::max(0.0, squares / kPlays - mean * mean) / kPlays));
        };
        const auto [own, own_error] = mean_of(
            [&](int level, double s) { return plan.is_worth_inside(level, s); },
            [&](int level, double s, bool probed) { return plan.is_worth_dividing(level, s, probed); });
        for (const double least : {4.0, 15.0, 60.0, 250.0}) {
            const auto [other, other_error] = mean_of([&](int, double s) { return s >= least; },
                                                      [&](int, double s, bool) { return s >= 4 * least; });
            CAPTURE(trial, samples, least, own, other);
            CHECK(own >= other - 4 * (own_error + other_error));
        }
        CHECK(own >= -4 * own_error);  // to trace all saves nothing
    }
}
