#include "caustics/beams/history_borders.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <span>
#include <utility>

namespace trilens {
namespace {

/// Of a side, until the brightest path's border is found; a half as bright path's needs one less.
constexpr int kBisections = 12;
/// What lies behind a border is looked for where both carry this share of the brightest path.
constexpr double kHiddenLight = 0.1;
/// Borders bend: a history is looked for beyond them from so many times their distance from its corner on.
constexpr double kWellBeyond = 1.25;

/// Borders of one side that bisection has not told apart yet.
struct BorderSearch {
    std::vector<HistoryBorder*> borders;
    Vec2 low{0}, high{0};  // where the histories are, and are not
    int bisections = 0;

    /// Whether the borders' paths, as bright as they are where they were met last, want more.
    bool is_open(double brightest) const {
        double strength = 0;
        for (const HistoryBorder* border : borders)
            strength = std::max(strength, strength_of(border->path.light));
        return !borders.empty() && std::ldexp(strength, kBisections - bisections) > brightest;
    }

    /// Whether before or beyond the border lies a history that neither end of the side has.
    bool hides(const BeamGrid& grid) const {
        const double least = kHiddenLight * grid.brightest();
        const HistoryBorder& border = *borders.front();
        if (strength_of(border.path.light) < least) return false;
        const auto is_new = [&](const LightPath& path) {
            return strength_of(path.light) >= least && !find_history(grid.paths(border.inside), path) &&
                   !find_history(grid.paths(border.outside), path);
        };
        const std::array<Vec2, 2> places{low, high};
        return std::any_of(places.begin(), places.end(), [&](const Vec2& place) {
            const LightPaths found = grid.paths_at(place);
            return std::any_of(found.paths.begin(), found.paths.end(), is_new);
        });
    }

    /// What becomes of it at the middle: of those that are there, and those that are not.
    std::array<BorderSearch, 2> bisect(const BeamGrid& grid) const {
        std::vector<const std::vector<Step>*> only;
        for (const HistoryBorder* border : borders) only.push_back(&border->like->steps);
        const Vec2 middle = 0.5 * (low + high);
        const LightPaths found = grid.paths_at(middle, only);
        std::array<BorderSearch, 2> parts{BorderSearch{{}, middle, high, bisections + 1},
                                          BorderSearch{{}, low, middle, bisections + 1}};
        for (HistoryBorder* border : borders) {
            const LightPath* same = find_history(found.paths, *border->like);
            if (same) border->place = middle, border->path = *same;
            parts[same ? 0 : 1].borders.push_back(border);
        }
        return parts;
    }
};

/// Of all borders of one side. Where several histories end together they are followed together.
void find_borders_on_side(const BeamGrid& grid, std::span<HistoryBorder* const> borders,
                          const LoopProgress& progress) {
    std::vector<BorderSearch> searches;
    for (HistoryBorder* border : borders) {
        border->place = grid.place(border->inside);
        border->path = *border->like;
        const auto same = std::find_if(searches.begin(), searches.end(), [&](const BorderSearch& one) {
            return one.borders[0]->inside == border->inside && one.borders.size() < FollowParams::kMostOnly;
        });
        if (same != searches.end())
            same->borders.push_back(border);
        else
            searches.push_back({{border}, grid.place(border->inside), grid.place(border->outside), 0});
    }
    while (!searches.empty()) {
        progress.stop_if_cancelled();
        const BorderSearch search = std::move(searches.back());
        searches.pop_back();
        for (BorderSearch& part : search.bisect(grid)) {
            if (part.is_open(grid.brightest()))
                searches.push_back(std::move(part));
            else if (!part.borders.empty())
                part.borders.front()->hides = part.hides(grid);
        }
    }
}

}  // namespace

GridHistories::HistoryKey GridHistories::key_of(const LightHistory& history) {
    std::vector<std::uint64_t> steps;
    for (const Step& step : history.steps)
        steps.push_back(std::uint64_t{step.optic} * 4 + static_cast<std::uint64_t>(step.event));
    return {std::move(steps), history.veils, history.colours, history.medium, history.has_start};
}

GridHistories::GridHistories(const BeamGrid& grid, std::vector<LightHistory>& all) : grid_(grid), all_(all) {
    for (const LightHistory& one : all) number_.try_emplace(key_of(one), static_cast<Id>(number_.size()));
    number_paths();
}

/// Of corners that are new.
void GridHistories::number_paths() {
    for (Id corner = static_cast<Id>(at_corner_.size()); corner < grid_.corner_count(); ++corner) {
        std::vector<Id>& numbers = at_corner_.emplace_back();
        for (const LightPath& path : grid_.paths(corner)) {
            const auto [at, is_new] = number_.try_emplace(key_of(path), static_cast<Id>(all_.size()));
            if (is_new) all_.push_back(path);
            numbers.push_back(at->second);
        }
    }
}

const LightPath* GridHistories::path_at(Id corner, Id history) const {
    const auto& ids = at_corner_[corner];
    for (std::size_t i = 0; i < ids.size(); ++i)
        if (ids[i] == history) return &grid_.paths(corner)[i];
    return nullptr;
}

std::vector<Id> GridHistories::histories_of(const BeamGrid::Triangle& triangle) const {
    std::vector<Id> all;
    for (const Id corner : triangle.corner)
        for (const Id history : at_corner_[corner])
            if (std::find(all.begin(), all.end(), history) == all.end()) all.push_back(history);
    return all;
}

void GridHistories::find_borders(const Progress& progress) {
    number_paths();
    const std::size_t known = borders_.size();
    for (const BeamGrid::Triangle& triangle : grid_.triangles())
        for (const Id history : histories_of(triangle))
            for (std::size_t k = 0; k < 3; ++k) {
                Id inside = triangle.corner[k], outside = triangle.corner[(k + 1) % 3];
                const LightPath *one = path_at(inside, history), *other = path_at(outside, history);
                if ((one != nullptr) == (other != nullptr)) continue;
                if (!one) std::swap(inside, outside);
                if (!border_.try_emplace({inside, outside, history}, borders_.size()).second) continue;
                borders_.push_back({inside, outside, one ? one : other, {}, {}});
            }
    std::map<std::pair<Id, Id>, std::vector<HistoryBorder*>> by_side;
    for (std::size_t i = known; i < borders_.size(); ++i)
        by_side[std::minmax(borders_[i].inside, borders_[i].outside)].push_back(&borders_[i]);
    std::vector<const std::vector<HistoryBorder*>*> sides;
    for (const auto& [side, borders] : by_side) sides.push_back(&borders);
    LoopProgress done(progress, static_cast<double>(sides.size()));
    parallel_for(sides.size(), 4, [&](std::size_t from, std::size_t to) {
        for (std::size_t i = from; i < to; ++i) find_borders_on_side(grid_, *sides[i], done);
        done.add(static_cast<double>(to - from));
    });
    add_tears();
}

/// They are known already: a border of either end.
void GridHistories::add_tears() {
    for (const auto& [side, tear] : grid_.tears()) {
        if (!tear) continue;
        const auto& [a, b, path] = side;
        const Id history = at_corner_[a][path], end[2] = {a, b};
        for (const std::size_t k : {0, 1}) {
            border_.try_emplace({end[k], end[1 - k], history}, borders_.size());
            borders_.push_back(
                {end[k], end[1 - k], path_at(end[k], history), tear->side[k].place, tear->side[k].path});
        }
    }
}

std::vector<Id> GridHistories::triangles_that_hide() const {
    std::set<std::pair<Id, Id>> sides;
    for (const HistoryBorder& border : borders_)
        if (border.hides) sides.insert(std::minmax(border.inside, border.outside));
    std::vector<Id> found;
    for (Id t = 0; t < grid_.triangles().size(); ++t) {
        const auto& corner = grid_.triangles()[t].corner;
        for (std::size_t k = 0; k < 3; ++k)
            if (sides.contains(std::minmax(corner[k], corner[(k + 1) % 3]))) {
                found.push_back(t);
                break;
            }
    }
    return found;
}

bool GridHistories::is_mixed(const BeamGrid::Triangle& triangle) const {
    const double least = kHiddenLight * grid_.brightest();
    const auto lacks = [&](Id corner, const LightPath& path) {
        return strength_of(path.light) >= least && !find_history(grid_.paths(corner), path);
    };
    for (const Id one : triangle.corner)
        for (const Id other : triangle.corner)
            if (one != other && std::any_of(grid_.paths(one).begin(), grid_.paths(one).end(),
                                            [&](const LightPath& path) { return lacks(other, path); }))
                return true;
    return false;
}

bool GridHistories::hides_at(const BeamGrid::Triangle& triangle, const Vec3& weights) const {
    const auto& corner = triangle.corner;
    const double least = kHiddenLight * grid_.brightest();
    const auto is_hidden = [&](const LightPath& path) {
        if (strength_of(path.light) < least) return false;
        std::size_t count = 0, inside = 0;
        const LightPath* there = nullptr;
        for (std::size_t k = 0; k < 3; ++k)
            if (const LightPath* at = find_history(grid_.paths(corner[k]), path))
                ++count, inside = k, there = at;
        if (count != 1) return count == 0;
        // The corner's part of the triangle is where the other two's weights, each over its share of the side
        // up to the border, add up to less than 1.
        const std::vector<LightPath>& paths = grid_.paths(corner[inside]);
        const Id history = at_corner_[corner[inside]][static_cast<std::size_t>(there - paths.data())];
        const Vec2 from = grid_.place(corner[inside]);
        double sum = 0;
        for (const std::size_t turn : {1, 2}) {
            const std::size_t k = (inside + turn) % 3;
            const Vec2 to_border = border(corner[inside], corner[k], history).place - from;
            sum += weights[static_cast<int>(k)] * length(grid_.place(corner[k]) - from) / length(to_border);
        }
        return sum > kWellBeyond;
    };
    const Vec2 place = weights.x * grid_.place(corner[0]) + weights.y * grid_.place(corner[1]) +
                       weights.z * grid_.place(corner[2]);
    const LightPaths found = grid_.paths_at(place);
    return std::any_of(found.paths.begin(), found.paths.end(), is_hidden);
}

const HistoryBorder* GridHistories::border_between(Id inside, Id outside, Id history) const {
    for (;;) {
        const auto found = border_.find({inside, outside, history});
        if (found != border_.end()) return &borders_[found->second];
        const Id middle = grid_.middle_between(inside, outside);
        if (middle == kNone) return nullptr;
        (path_at(middle, history) ? inside : outside) = middle;
    }
}

}  // namespace trilens
