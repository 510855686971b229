// Principal paths first: where they differ no others matter.
#include "paths/probe/facet_looks.h"

#include <algorithm>

#include "paths/probe/same_histories.h"

namespace trilens {

FacetPoint FacetLooks::between(std::initializer_list<const FacetPoint*> points) {
    FacetPoint middle;
    const double share = 1.0 / static_cast<double>(points.size());
    for (const FacetPoint* one : points) {
        middle.screen += share * one->screen;
        middle.chord += share * one->chord;
    }
    looks_.push_back(look_through(looking_, {middle.screen, middle.chord, params_.reach},
                                  {.side = params_.side, .least_weight = kPrincipalOnly}));
    middle.look = &looks_.back();
    note(middle.look->cut);
    return middle;
}

FacetPoint FacetLooks::middle_of(const FacetPoint& a, const FacetPoint& b) {
    Ends ends{a.look, b.look};
    if (std::less<>()(ends.second, ends.first)) std::swap(ends.first, ends.second);
    const auto [known, is_new] = middles_.try_emplace(ends);
    if (is_new) known->second = between({&a, &b});
    return known->second;
}

void FacetLooks::follow_all_at(const FacetPoint& point, double least_weight) {
    if (!point.look->principal_only) return;
    follow_all(looking_, *point.look, least_weight);
    if (params_.beside) set_beside(looking_, *point.look);
    note(point.look->cut);
}

bool may_agree(std::span<const FacetPoint> points) {
    const Look& first = *points[0].look;
    return std::all_of(points.begin(), points.end(), [&](const FacetPoint& point) {
        const Look& look = *point.look;
        return look.state == LookState::kSeen && look.front == first.front &&
               (&look == &first || same_principal(first.segments, look.segments));
    });
}

}  // namespace trilens
