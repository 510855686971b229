#include "caustics/beams/beams.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <span>
#include <tuple>

#include "base/util/parallel.h"

namespace trilens {
namespace {

/// Of a side, until the brightest path's border is found; a half as bright path's needs one less.
constexpr int kBisections = 12;

/// The last place at which a history is, on the way between two corners of which one has it.
struct HistoryBorder {
    Id inside = kNone, outside = kNone;
    const LightPath* like = nullptr;
    Vec2 place{0};
    LightPath path;
};

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
void find_on_side(const BeamGrid& grid, std::span<HistoryBorder* const> borders,
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
        for (BorderSearch& part : search.bisect(grid))
            if (part.is_open(grid.brightest())) searches.push_back(std::move(part));
    }
}

/// A beam's part of the film times the mean of of(end) over its ends.
template <typename Of>
Vec3 beam_integral(const Beams& beams, const LightBeam& beam, const Of& of) {
    Vec3 sum(0);
    for (const Id end : beam.end) sum += of(beams.ends[end]);
    return beam.measure / 3 * sum;
}

using HistoryKey = std::tuple<std::vector<std::uint64_t>, std::vector<VeilSurface>, int, Id, bool>;

HistoryKey key_of(const LightHistory& history) {
    std::vector<std::uint64_t> steps;
    for (const Step& step : history.steps)
        steps.push_back(std::uint64_t{step.optic} * 4 + static_cast<std::uint64_t>(step.event));
    return {std::move(steps), history.veils, history.colours, history.medium, history.has_start};
}

class BeamMaker {
  public:
    BeamMaker(const BeamGrid& grid, Beams& beams) : grid_(grid), beams_(beams) {}
    void make(const Progress& progress);

  private:
    using Key = std::tuple<Id, Id, Id>;  // inside, outside or kNone at a corner, history

    Id history_of(const LightHistory& path);
    const LightPath* path_at(Id corner, Id history) const;
    std::vector<Id> histories_of(const BeamGrid::Triangle& triangle) const;
    void find_borders(const Progress& progress);
    Id end_of(Id corner, Id history);
    Id border_end(Id inside, Id outside, Id history);
    Id add_end(const Vec2& place, const LightPath& path);
    void add_beam(const std::array<Id, 3>& ends, Id history);
    void add_triangle(const BeamGrid::Triangle& triangle, Id history);
    void set_spreads(std::size_t first_end, std::size_t first_beam);

    const BeamGrid& grid_;
    Beams& beams_;
    std::map<HistoryKey, Id> history_;
    std::vector<std::vector<Id>> at_corner_;  // per corner and path: its history
    std::map<Key, Id> end_;
    std::map<Key, std::size_t> border_;
    std::vector<HistoryBorder> borders_;
};

Id BeamMaker::history_of(const LightHistory& path) {
    const auto [at, is_new] = history_.try_emplace(key_of(path), static_cast<Id>(beams_.histories.size()));
    if (is_new) beams_.histories.push_back(path);
    return at->second;
}

const LightPath* BeamMaker::path_at(Id corner, Id history) const {
    const auto& ids = at_corner_[corner];
    for (std::size_t i = 0; i < ids.size(); ++i)
        if (ids[i] == history) return &grid_.paths(corner)[i];
    return nullptr;
}

std::vector<Id> BeamMaker::histories_of(const BeamGrid::Triangle& triangle) const {
    std::vector<Id> all;
    for (const Id corner : triangle.corner)
        for (const Id history : at_corner_[corner])
            if (std::find(all.begin(), all.end(), history) == all.end()) all.push_back(history);
    return all;
}

void BeamMaker::find_borders(const Progress& progress) {
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
    for (HistoryBorder& border : borders_)
        by_side[std::minmax(border.inside, border.outside)].push_back(&border);
    std::vector<const std::vector<HistoryBorder*>*> sides;
    for (const auto& [side, borders] : by_side) sides.push_back(&borders);
    LoopProgress done(progress, static_cast<double>(sides.size()));
    parallel_for(sides.size(), 4, [&](std::size_t from, std::size_t to) {
        for (std::size_t i = from; i < to; ++i) find_on_side(grid_, *sides[i], done);
        done.add(static_cast<double>(to - from));
    });
}

Id BeamMaker::add_end(const Vec2& place, const LightPath& path) {
    beams_.ends.push_back({place,
                           path.ray.origin,
                           path.ray.direction,
                           path.arriving,
                           path.light,
                           path.optic,
                           path.object,
                           grid_.window().density(place),
                           {}});
    return static_cast<Id>(beams_.ends.size() - 1);
}

Id BeamMaker::end_of(Id corner, Id history) {
    const auto [at, is_new] = end_.try_emplace({corner, kNone, history}, kNone);
    if (is_new) at->second = add_end(grid_.place(corner), *path_at(corner, history));
    return at->second;
}

Id BeamMaker::border_end(Id inside, Id outside, Id history) {
    const auto [at, is_new] = end_.try_emplace({inside, outside, history}, kNone);
    if (is_new) {
        const HistoryBorder& border = borders_[border_.at({inside, outside, history})];
        at->second = add_end(border.place, border.path);
    }
    return at->second;
}

void BeamMaker::add_beam(const std::array<Id, 3>& ends, Id history) {
    const double measure = grid_.window().measure(beams_.ends[ends[0]].place, beams_.ends[ends[1]].place,
                                                  beams_.ends[ends[2]].place);
    if (!(measure > 0)) return;
    const LightBeam beam{ends, history, measure, static_cast<Id>(beams_.windows.size() - 1)};
    const std::vector<Step>& steps = beams_.histories[history].steps;
    if (steps.size() == 1)
        beams_.arriving.try_emplace({steps[0].optic, steps[0].event}, Vec3(0)).first->second +=
            beam_integral(beams_, beam, [](const BeamEnd& end) { return end.arriving; });
    const bool falls = std::any_of(ends.begin(), ends.end(), [&](Id e) {
        return std::isfinite(beams_.ends[e].object) || !std::isfinite(beams_.ends[e].optic);
    });
    if (falls) beams_.beams.push_back(beam);
}

void BeamMaker::add_triangle(const BeamGrid::Triangle& triangle, Id history) {
    const auto& corner = triangle.corner;
    std::array<bool, 3> has{};
    int count = 0;
    for (std::size_t k = 0; k < 3; ++k) count += has[k] = path_at(corner[k], history) != nullptr;
    if (count == 3) {
        add_beam({end_of(corner[0], history), end_of(corner[1], history), end_of(corner[2], history)},
                 history);
        return;
    }
    for (std::size_t k = 0; k < 3; ++k) {
        const Id a = corner[k], b = corner[(k + 1) % 3], c = corner[(k + 2) % 3];
        if (count == 1 && has[k])
            add_beam({end_of(a, history), border_end(a, b, history), border_end(a, c, history)}, history);
        if (count == 2 && !has[k]) {
            const Id at_b = end_of(b, history), at_c = end_of(c, history);
            const Id from_b = border_end(b, a, history), from_c = border_end(c, a, history);
            add_beam({at_b, at_c, from_c}, history);
            add_beam({at_b, from_c, from_b}, history);
        }
    }
}

/// How origin and direction change with the place, per beam, and their means at the ends.
struct BeamSlope {
    Vec3 origin_u{0}, origin_v{0}, direction_u{0}, direction_v{0};
    double weight = 0;
};

void BeamMaker::set_spreads(std::size_t first_end, std::size_t first_beam) {
    std::vector<BeamSlope> slopes(beams_.ends.size() - first_end);
    for (std::size_t i = first_beam; i < beams_.beams.size(); ++i) {
        const auto& end = beams_.beams[i].end;
        const BeamEnd &a = beams_.ends[end[0]], &b = beams_.ends[end[1]], &c = beams_.ends[end[2]];
        const Vec2 ab = b.place - a.place, ac = c.place - a.place;
        const double area = ab.x * ac.y - ab.y * ac.x;
        if (area == 0) continue;
        const double sign = area > 0 ? 1 : -1;  // weighted with the area, which cancels its own division
        const auto slope = [&](const Vec3& to_b, const Vec3& to_c) {
            return std::array<Vec3, 2>{sign * (ac.y * to_b - ab.y * to_c),
                                       sign * (ab.x * to_c - ac.x * to_b)};
        };
        const auto origin = slope(b.origin - a.origin, c.origin - a.origin);
        const auto direction = slope(b.direction - a.direction, c.direction - a.direction);
        for (const Id e : end) {
            BeamSlope& mean = slopes[e - first_end];
            mean.origin_u += origin[0], mean.origin_v += origin[1];
            mean.direction_u += direction[0], mean.direction_v += direction[1];
            mean.weight += std::fabs(area);
        }
    }
    for (std::size_t i = 0; i < slopes.size(); ++i) {
        BeamEnd& end = beams_.ends[first_end + i];
        const BeamSlope& s = slopes[i];
        if (!(s.weight > 0)) continue;
        const double per = 1 / (s.weight * s.weight);
        end.spread = {per * triple(s.origin_u, s.origin_v, end.direction),
                      per * (triple(s.direction_u, s.origin_v, end.direction) +
                             triple(s.origin_u, s.direction_v, end.direction)),
                      per * triple(s.direction_u, s.direction_v, end.direction)};
    }
}

void BeamMaker::make(const Progress& progress) {
    for (std::size_t i = 0; i < beams_.histories.size(); ++i)
        history_.emplace(key_of(beams_.histories[i]), static_cast<Id>(i));
    beams_.windows.push_back(grid_.window());
    at_corner_.resize(grid_.corner_count());
    for (Id corner = 0; corner < at_corner_.size(); ++corner)
        for (const LightPath& path : grid_.paths(corner)) at_corner_[corner].push_back(history_of(path));
    find_borders(progress);
    const std::size_t first_end = beams_.ends.size(), first_beam = beams_.beams.size();
    for (const BeamGrid::Triangle& triangle : grid_.triangles())
        for (const Id history : histories_of(triangle)) add_triangle(triangle, history);
    set_spreads(first_end, first_beam);
}

}  // namespace

void add_beams(const BeamGrid& grid, Beams& beams, const Progress& progress) {
    BeamMaker(grid, beams).make(progress);
}

std::vector<Vec3> Beams::flux_by_history() const {
    std::vector<Vec3> flux(histories.size(), Vec3(0));
    for (const LightBeam& beam : beams)
        flux[beam.history] += beam_integral(*this, beam, [](const BeamEnd& end) { return end.light; });
    return flux;
}

/// Each optic's light arrives once: by reflection or refraction, whichever history has more of it (total
/// reflection ends the one, and without Fresnel's equations glass has only the other).
Vec3 Beams::flux_arriving() const {
    std::map<Id, Vec3> by_optic;
    for (const auto& [step, flux] : arriving) {
        Vec3& most = by_optic.try_emplace(step.first, Vec3(0)).first->second;
        most = glm::max(most, flux);
    }
    Vec3 sum(0);
    for (const auto& [optic, flux] : by_optic) sum += flux;
    return sum;
}

Vec3 Beams::flux_on_objects() const {
    Vec3 sum(0);
    for (const LightBeam& beam : beams)
        sum += beam_integral(
            *this, beam, [](const BeamEnd& end) { return std::isfinite(end.object) ? end.light : Vec3(0); });
    return sum;
}

Vec3 Beams::flux_away() const {
    Vec3 sum(0);
    for (const LightBeam& beam : beams)
        sum += beam_integral(*this, beam, [](const BeamEnd& end) {
            return std::isfinite(end.object) || std::isfinite(end.optic) ? Vec3(0) : end.light;
        });
    return sum;
}

}  // namespace trilens
