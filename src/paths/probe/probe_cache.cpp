// Principal paths first: where they differ no others matter.
#include "paths/probe/probe_cache.h"

#include <algorithm>

#include "paths/probe/same_histories.h"

namespace trilens {

FacetPoint ProbeCache::between(std::initializer_list<const FacetPoint*> points) {
    FacetPoint middle;
    const double share = 1.0 / static_cast<double>(points.size());
    for (const FacetPoint* one : points) {
        middle.screen += share * one->screen;
        middle.chord += share * one->chord;
    }
    probes_.push_back(probe_chord(context_, {middle.screen, middle.chord, params_.reach},
                                  {.side = params_.side, .least_weight = kPrincipalOnly}));
    middle.probe = &probes_.back();
    note(middle.probe->cut);
    return middle;
}

FacetPoint ProbeCache::middle_of(const FacetPoint& a, const FacetPoint& b) {
    Ends ends{a.probe, b.probe};
    if (std::less<>()(ends.second, ends.first)) std::swap(ends.first, ends.second);
    const auto [known, is_new] = middles_.try_emplace(ends);
    if (is_new) known->second = between({&a, &b});
    return known->second;
}

void ProbeCache::follow_all_at(const FacetPoint& point, double least_weight) {
    if (!point.probe->principal_only) return;
    follow_all(context_, *point.probe, least_weight);
    if (params_.beside) probe_offsets(context_, *point.probe);
    note(point.probe->cut);
}

bool may_agree(std::span<const FacetPoint> points) {
    const PathProbe& first = *points[0].probe;
    return std::all_of(points.begin(), points.end(), [&](const FacetPoint& point) {
        const PathProbe& probe = *point.probe;
        return probe.state == ProbeState::kSeen && probe.front == first.front &&
               (&probe == &first || same_principal(first.segments, probe.segments));
    });
}

}  // namespace trilens
