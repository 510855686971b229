#include "paths/facets/optic_paths.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace trilens {
namespace {

constexpr double kMostCountedSamples = 1e9;  // of a part; more count as so many
/// What is believed before anything was seen, and how many parts it weighs as much as.
constexpr double kPriorAgree = 0.8, kPriorProjected = 0.8, kPriorParts = 4;
/// Parts of parts with fewer samples than this are worth nothing at all.
constexpr double kNoSamples = 1;

/// Of `all` parts `some` have what `prior` of them are believed to have.
double blended(double prior, std::size_t some, std::size_t all) {
    return (kPriorParts * prior + static_cast<double>(some)) / (kPriorParts + static_cast<double>(all));
}

}  // namespace

ProbeCosts ProbeCosts::of(double per_pixel, bool closed_form) {
    ProbeCosts costs;
    if (closed_form) costs.inside = 20;
    if (per_pixel > 1) costs.saved = 1.2;
    return costs;
}

void ProbeTally::add(const ProbeTally& other) {
    for (std::size_t i = 0; i < level.size(); ++i) {
        level[i].parts += other.level[i].parts;
        level[i].agree += other.level[i].agree;
        level[i].probed += other.level[i].probed;
        level[i].projected += other.level[i].projected;
    }
}

ProbePlan::ProbePlan(double per_pixel, const ProbeCosts& costs, const ProbeTally& survey)
    : per_pixel_(per_pixel), costs_(costs) {
    // What a level is believed to be before it is seen is what the level above it was found to be.
    Share prior{kPriorAgree, kPriorProjected};
    for (std::size_t i = 0; i < share_.size(); ++i) {
        const ProbeTally::Level& seen = survey.level[i];
        prior = share_[i] = {blended(prior.agree, seen.agree, seen.parts),
                             blended(prior.projected, seen.projected, seen.probed)};
    }
}

double ProbePlan::samples_in(double area) const {
    return std::min(kMostCountedSamples, area * per_pixel_);
}

const ProbePlan::Share& ProbePlan::share(int level) const {
    return share_[static_cast<std::size_t>(std::min(level, ProbeTally::kLevels - 1))];
}

/// What the four parts of a part save, samples.
double ProbePlan::parts(int level, double samples) const {
    return 4 * part(level + 1, samples / 4);
}

/// What probing a part saves whose corners agree, where its own parts save that much: it is divided if
/// probing did not help.
double ProbePlan::inside(int level, double samples, double of_parts) const {
    const double projected = share(level).projected;
    return projected * costs_.saved * samples - costs_.inside + (1 - projected) * std::max(0.0, of_parts);
}

/// What a part saves before anything is known of its corners; one that saves nothing is traced.
double ProbePlan::part(int level, double samples) const {
    if (samples < kNoSamples) return 0;
    const double agree = share(level).agree, of_parts = parts(level, samples);
    return agree * std::max(0.0, inside(level, samples, of_parts)) +
           (1 - agree) * std::max(0.0, of_parts - costs_.middle);
}

bool ProbePlan::is_worth_corners(double samples) const {
    return !decides() || part(0, samples) > costs_.corner;
}
bool ProbePlan::is_worth_inside(int level, double samples) const {
    return !decides() || inside(level, samples, parts(level, samples)) > 0;
}
bool ProbePlan::is_worth_dividing(int level, double samples, bool probed) const {
    return !decides() || parts(level, samples) > (probed ? 0 : costs_.middle);
}

double ProbePlan::least_samples() const {
    double high = 1;
    while (high < kMostCountedSamples && !is_worth_corners(high)) high *= 2;
    if (!is_worth_corners(high)) return std::numeric_limits<double>::infinity();
    double low = high / 2;
    for (int i = 0; i < 20; ++i) (is_worth_corners(0.5 * (low + high)) ? high : low) = 0.5 * (low + high);
    return high;
}

}  // namespace trilens
