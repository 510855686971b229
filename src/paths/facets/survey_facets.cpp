// A survey (systematic sample) of an optic's facets: what probing all of them is likely to bring.
#include <algorithm>
#include <cmath>

#include "base/util/parallel.h"
#include "paths/facets/divide_facet.h"
#include "paths/facets/facet_paths.h"
#include "paths/facets/film_reach.h"

namespace trilens {
namespace {

/// One facet in so many is surveyed, some at least, and some at the most.
constexpr std::size_t kOneIn = 16, kFewest = 4, kMost = 48;
/// So many are tried for one that is in sight.
constexpr std::size_t kTries = 4;

/// The k-th of a sequence of numbers that fills [0, 1) evenly (van der Corput, base 2).
double evenly(std::size_t k) {
    double place = 0;
    for (double digit = 0.5; k > 0; k /= 2, digit /= 2) place += digit * static_cast<double>(k % 2);
    return place;
}

}  // namespace

/// Whether a facet is probed at all.
bool OpticPaths::is_worth_probing(Id facet) const {
    return !probe_report_.plan.decides() || surveyed_.contains(facet) ||
           probe_report_.plan.is_worth_corners(
               probe_report_.plan.samples_in(screen_area(screen_corners(facet))));
}

/// Probes some facets, the same whatever is asked for first, and makes the plan for all others.
void OpticPaths::survey() {
    if (is_surveyed_ || params_.per_pixel == 0) return;
    is_surveyed_ = true;
    const ProbeCosts costs = ProbeCosts::of(params_.per_pixel, context_.surface->has_closed_form());
    probe_report_.plan = ProbePlan(params_.per_pixel, costs, {});
    std::vector<Id> shown;
    for (Id f = 0; f < outline_.facets.size(); ++f)
        if (on_film(f) && has_room_[f] && is_worth_probing(f)) shown.push_back(f);
    const std::size_t wanted = std::min(shown.size(), std::clamp(shown.size() / kOneIn, kFewest, kMost));
    std::vector<Id> chosen;
    for (std::size_t k = 0; k < kTries * wanted && chosen.size() < wanted; ++k) {
        const Id f = shown[static_cast<std::size_t>(evenly(k) * static_cast<double>(shown.size()))];
        const IdTriple& corner = outline_.facets[f];
        const auto in_sight = [&](Id c) { return is_in_sight(c); };
        if (std::find(chosen.begin(), chosen.end(), f) == chosen.end() &&
            (!grid_ || std::any_of(corner.begin(), corner.end(), in_sight)))
            chosen.push_back(f);
    }
    probe_corners(chosen);
    std::vector<std::unique_ptr<DividedFacet>> found(chosen.size());
    parallel_for(found.size(), 1, [&](std::size_t from, std::size_t to) {
        for (std::size_t i = from; i < to; ++i)
            found[i] = std::make_unique<DividedFacet>(
                divide_facet(context_, facet_to_divide(chosen[i]), params_, probe_report_.plan));
    });
    ProbeTally tally;
    for (std::size_t i = 0; i < found.size(); ++i) {
        tally.add(found[i]->tally);
        surveyed_[chosen[i]] = std::move(found[i]);
    }
    probe_report_.surveyed = chosen.size();
    probe_report_.plan = ProbePlan(params_.per_pixel, costs, tally);
}

}  // namespace trilens
