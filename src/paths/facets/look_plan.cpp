#include "paths/facets/look_plan.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace trilens {
namespace {

constexpr double kMostSamples = 1e9;  // of a part; more count as so many
/// What is believed before anything was seen, and how many parts it weighs as much as.
constexpr double kPriorAgree = 0.8, kPriorProjected = 0.8, kPriorParts = 4;
/// Parts of parts with fewer samples than this are worth nothing at all.
constexpr double kNoSamples = 1;

/// Of `all` parts `some` have what `prior` of them are believed to have.
double blended(double prior, std::size_t some, std::size_t all) {
    return (kPriorParts * prior + static_cast<double>(some)) / (kPriorParts + static_cast<double>(all));
}

}  // namespace

LookCosts LookCosts::of(double per_pixel, bool closed_form) {
    LookCosts costs;
    if (closed_form) costs.inside = 20;
    if (per_pixel > 1) costs.saved = 1.2;
    return costs;
}

void LookTally::add(const LookTally& other) {
    for (std::size_t i = 0; i < level.size(); ++i) {
        level[i].parts += other.level[i].parts;
        level[i].agree += other.level[i].agree;
        level[i].looked += other.level[i].looked;
        level[i].projected += other.level[i].projected;
    }
}

LookPlan::LookPlan(double per_pixel, const LookCosts& costs, const LookTally& survey)
    : per_pixel_(per_pixel), costs_(costs) {
    // What a level is believed to be before it is seen is what the level above it was found to be.
    Share prior{kPriorAgree, kPriorProjected};
    for (std::size_t i = 0; i < share_.size(); ++i) {
        const LookTally::Level& seen = survey.level[i];
        prior = share_[i] = {blended(prior.agree, seen.agree, seen.parts),
                             blended(prior.projected, seen.projected, seen.looked)};
    }
}

double LookPlan::samples_in(double area) const {
    return std::min(kMostSamples, area * per_pixel_);
}

const LookPlan::Share& LookPlan::share(int level) const {
    return share_[static_cast<std::size_t>(std::min(level, LookTally::kLevels - 1))];
}

/// What the four parts of a part save, samples.
double LookPlan::parts(int level, double samples) const {
    return 4 * part(level + 1, samples / 4);
}

/// What looking into a part saves whose corners agree, where its own parts save that much: it is divided if
/// looking did not help.
double LookPlan::inside(int level, double samples, double of_parts) const {
    const double projected = share(level).projected;
    return projected * costs_.saved * samples - costs_.inside + (1 - projected) * std::max(0.0, of_parts);
}

/// What a part saves before anything is known of its corners; one that saves nothing is traced.
double LookPlan::part(int level, double samples) const {
    if (samples < kNoSamples) return 0;
    const double agree = share(level).agree, of_parts = parts(level, samples);
    return agree * std::max(0.0, inside(level, samples, of_parts)) +
           (1 - agree) * std::max(0.0, of_parts - costs_.middle);
}

bool LookPlan::is_worth_corners(double samples) const {
    return !decides() || part(0, samples) > costs_.corner;
}
bool LookPlan::is_worth_inside(int level, double samples) const {
    return !decides() || inside(level, samples, parts(level, samples)) > 0;
}
bool LookPlan::is_worth_dividing(int level, double samples, bool looked) const {
    return !decides() || parts(level, samples) > (looked ? 0 : costs_.middle);
}

double LookPlan::least_samples() const {
    double high = 1;
    while (high < kMostSamples && !is_worth_corners(high)) high *= 2;
    if (!is_worth_corners(high)) return std::numeric_limits<double>::infinity();
    double low = high / 2;
    for (int i = 0; i < 20; ++i) (is_worth_corners(0.5 * (low + high)) ? high : low) = 0.5 * (low + high);
    return high;
}

}  // namespace trilens
