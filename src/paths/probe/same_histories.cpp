#include "paths/probe/same_histories.h"

#include <algorithm>

namespace trilens {
namespace {

double largest_channel(const Vec3& v) {
    return std::max({v.x, v.y, v.z});
}

/// The segment of the same kind as `wanted` behind `parent`; kNone where there is none.
Id same_behind(Id parent, const PathSegment& wanted, const std::vector<PathSegment>& segments) {
    const auto same = std::find_if(segments.begin(), segments.end(), [&](const PathSegment& one) {
        return one.parent == parent && one.step == wanted.step && one.colours == wanted.colours &&
               one.medium == wanted.medium && one.ends == wanted.ends && one.principal == wanted.principal;
    });
    return same == segments.end() ? kNone : static_cast<Id>(same - segments.begin());
}

std::ptrdiff_t count_principal(const std::vector<PathSegment>& segments) {
    return std::count_if(segments.begin(), segments.end(),
                         [](const PathSegment& segment) { return segment.principal; });
}

}  // namespace

std::vector<std::size_t> matched(const std::vector<PathSegment>& histories,
                                 const std::vector<PathSegment>& segments) {
    std::vector<std::size_t> found;
    for (const PathSegment& wanted : histories) {
        const Id parent = wanted.parent == kNone ? kNone : static_cast<Id>(found[wanted.parent]);
        const Id same = same_behind(parent, wanted, segments);
        if (same == kNone) return {};
        found.push_back(same);
    }
    return found;
}

bool covers(const std::vector<std::size_t>& match, const std::vector<PathSegment>& segments) {
    for (std::size_t i = 0; i < segments.size(); ++i) {
        if (std::find(match.begin(), match.end(), i) != match.end()) continue;
        if (segments[i].principal || largest_channel(segments[i].weight) > kMuchLight * kLeastWeight)
            return false;
    }
    return true;
}

bool same_principal(const std::vector<PathSegment>& a, const std::vector<PathSegment>& b) {
    if (count_principal(a) != count_principal(b)) return false;
    std::vector<Id> found(a.size(), kNone);
    for (std::size_t i = 0; i < a.size(); ++i) {
        if (!a[i].principal) continue;
        found[i] = same_behind(a[i].parent == kNone ? kNone : found[a[i].parent], a[i], b);
        if (found[i] == kNone) return false;
    }
    return true;
}

}  // namespace trilens
