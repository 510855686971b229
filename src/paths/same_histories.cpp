#include "paths/same_histories.h"

#include <algorithm>

namespace trilens {
namespace {

/// A path with so many times the least weight that is not matched is another history.
constexpr double kMuchLight = 8;

double largest(const Vec3& v) {
    return std::max({v.x, v.y, v.z});
}

/// The principal segments, and no others.
std::vector<PathSegment> principal_of(const std::vector<PathSegment>& segments) {
    std::vector<PathSegment> principal;
    std::vector<Id> place(segments.size(), kNone);
    for (std::size_t i = 0; i < segments.size(); ++i) {
        if (!segments[i].principal) continue;
        place[i] = static_cast<Id>(principal.size());
        PathSegment& segment = principal.emplace_back(segments[i]);
        if (segment.parent != kNone) segment.parent = place[segment.parent];
    }
    return principal;
}

}  // namespace

std::vector<std::size_t> matched(const std::vector<PathSegment>& histories,
                                 const std::vector<PathSegment>& segments) {
    std::vector<std::size_t> found;
    for (const PathSegment& wanted : histories) {
        const Id parent = wanted.parent == kNone ? kNone : static_cast<Id>(found[wanted.parent]);
        const auto same = std::find_if(segments.begin(), segments.end(), [&](const PathSegment& one) {
            return one.parent == parent && one.step == wanted.step && one.colours == wanted.colours &&
                   one.medium == wanted.medium && one.ends == wanted.ends &&
                   one.principal == wanted.principal;
        });
        if (same == segments.end()) return {};
        found.push_back(static_cast<std::size_t>(same - segments.begin()));
    }
    return found;
}

bool covers(const std::vector<std::size_t>& match, const std::vector<PathSegment>& segments) {
    for (std::size_t i = 0; i < segments.size(); ++i) {
        if (std::find(match.begin(), match.end(), i) != match.end()) continue;
        if (segments[i].principal || largest(segments[i].weight) > kMuchLight * kLeastWeight) return false;
    }
    return true;
}

bool same_principal(const std::vector<PathSegment>& a, const std::vector<PathSegment>& b) {
    const std::vector<PathSegment> of_a = principal_of(a), of_b = principal_of(b);
    return of_a.size() == of_b.size() && matched(of_a, of_b).size() == of_a.size();
}

}  // namespace trilens
