#include "caustics/beams/history_tears.h"

#include <algorithm>
#include <set>
#include <utility>

#include "base/util/parallel.h"
#include "caustics/beams/beam_grid.h"

namespace trilens {
namespace {

constexpr int kTearBisections = 12, kTrials = 3;
/// A jump that is less than this share of the whole after the trials closes: of a root, as at an outline seen
/// against something else, a third is left.
constexpr double kClosesBy = 0.6;
/// What is left of a tear's after all.
constexpr double kStaysOpen = 0.4;
/// The middle of a curve lies no farther from its chord's, in lengths of the chord; at a ball's outline a
/// third of one.
constexpr double kWildest = 2;

double jump(const PlacedPath& one, const PlacedPath& other) {
    return length(one.path.ray.origin - other.path.ray.origin);
}

/// The history in the middle between two places; none: it is not there.
std::optional<PlacedPath> middle_path(const BeamGrid& grid, const PlacedPath& one, const Vec2& other) {
    const std::vector<Step>* only[] = {&one.path.steps};
    PlacedPath middle{0.5 * (one.place + other), {}};
    const LightPaths found = grid.paths_at(middle.place, only);
    const LightPath* same = find_history(found.paths, one.path);
    if (!same) return std::nullopt;
    middle.path = *same;
    return middle;
}

}  // namespace

std::optional<HistoryTear> find_tear(const BeamGrid& grid, const PlacedPath& one, const PlacedPath& other) {
    HistoryTear tear{{one, other}};
    auto& [low, high] = tear.side;
    const double whole = jump(low, high);
    for (int i = 0; i < kTearBisections; ++i) {
        std::optional<PlacedPath> middle = middle_path(grid, low, high.place);
        if (!middle) return std::nullopt;
        PlacedPath& nearer = jump(low, *middle) > jump(*middle, high) ? high : low;
        nearer = *std::move(middle);
        if (i + 1 == kTrials && jump(low, high) < kClosesBy * whole) return std::nullopt;
    }
    if (jump(low, high) < kStaysOpen * whole) return std::nullopt;
    return tear;
}

bool is_beyond_tear(const Vec3& one, const Vec3& middle, const Vec3& other) {
    return length(middle - 0.5 * (one + other)) > kWildest * length(other - one);
}

/// Of sides on which that is not known yet.
void BeamGrid::find_tears(std::vector<SideHistory> sides, const Progress& progress) {
    std::sort(sides.begin(), sides.end());
    sides.erase(std::unique(sides.begin(), sides.end()), sides.end());
    std::erase_if(sides, [&](const SideHistory& side) { return tears_.contains(side); });
    std::vector<std::optional<HistoryTear>> found(sides.size());
    parallel_for(sides.size(), 4, [&](std::size_t from, std::size_t to) {
        for (std::size_t i = from; i < to; ++i) {
            progress.stop_if_cancelled();
            const auto [a, b, path] = sides[i];
            const LightPath& on_a = paths(a)[path];
            found[i] = find_tear(*this, {place(a), on_a}, {place(b), *find_history(paths(b), on_a)});
        }
    });
    for (std::size_t i = 0; i < sides.size(); ++i) tears_.emplace(sides[i], std::move(found[i]));
}

/// The triangle's sides at both of whose ends the history is.
std::vector<BeamGrid::SideHistory> BeamGrid::sides_with(const LightPath& like, Id triangle) const {
    std::vector<SideHistory> sides;
    const auto& corner = triangles_[triangle].corner;
    for (std::size_t k = 0; k < 3; ++k) {
        const auto [from, to] = std::minmax(corner[k], corner[(k + 1) % 3]);
        const LightPath* same = find_history(paths(from), like);
        if (same && find_history(paths(to), like))
            sides.emplace_back(from, to, static_cast<Id>(same - paths(from).data()));
    }
    return sides;
}

/// From triangle to triangle: where one goes in, it goes out.
void BeamGrid::follow_tears(const Progress& progress) {
    std::vector<SideHistory> torn;
    for (const auto& [side, tear] : tears_)
        if (tear) torn.push_back(side);
    while (!torn.empty()) {
        std::set<SideHistory> beside;
        for (const auto& [a, b, path] : torn)
            for (const Id triangle : sides_.at(edge_of(a, b)))
                if (triangle != kNone)
                    for (const SideHistory& side : sides_with(paths(a)[path], triangle)) beside.insert(side);
        std::erase_if(beside, [&](const SideHistory& side) { return tears_.contains(side); });
        find_tears({beside.begin(), beside.end()}, progress);
        torn.clear();
        for (const SideHistory& side : beside)
            if (tears_.at(side)) torn.push_back(side);
    }
}

/// Triangles in which one ends, or meets another or the end of its history: not two sides torn, and the
/// history at every corner.
std::vector<Id> BeamGrid::torn_oddly() const {
    std::set<Id> odd;
    for (const auto& [side, tear] : tears_) {
        if (!tear) continue;
        const auto& [a, b, path] = side;
        for (const Id t : sides_.at(edge_of(a, b))) {
            if (t == kNone) continue;
            const std::vector<SideHistory> sides = sides_with(paths(a)[path], t);
            const auto torn = std::count_if(sides.begin(), sides.end(), [&](const SideHistory& one) {
                return tears_.at(one).has_value();
            });
            if (sides.size() != 3 || torn != 2) odd.insert(t);
        }
    }
    return {odd.begin(), odd.end()};
}

}  // namespace trilens
