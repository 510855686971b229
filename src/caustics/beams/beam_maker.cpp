// A light's beams from its divided window, each as large as its own light allows.
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>
#include <tuple>
#include <unordered_map>
#include <unordered_set>
#include <vector>

#include "caustics/beams/beams.h"
#include "caustics/beams/hidden_histories.h"
#include "caustics/beams/merged_beams.h"
#include "caustics/beams/quadratic.h"

namespace trilens {
namespace {

/// Borders of paths that carry less than this share of the strongest of all are straight where they are to so
/// much of a side.
constexpr double kFaintBorder = 0.03, kStraightBorder = 0.02;

/// The corners that were looked at in a node, its own first, and the triangles in it.
struct NodeCorners {
    std::vector<std::pair<Id, Vec3>> corners;  // with weights of the node's own
    std::vector<Id> triangles;
};

/// One of a cut triangle's: at a corner of the grid, or where a history ends.
struct CutEnd {
    Id corner = kNone;  // kNone: at the border
    const HistoryBorder* border = nullptr;
    Vec2 place{0};
    const LightPath* path = nullptr;

    static CutEnd at(const HistoryBorder& border) { return {kNone, &border, border.place, &border.path}; }
};

constexpr std::array<Id, 3> kNoMiddles{kNone, kNone, kNone};

class BeamMaker {
  public:
    BeamMaker(BeamGrid& grid, Beams& beams) : grid_(grid), beams_(beams), histories_(grid, beams.histories) {}
    void make(const Progress& progress);

  private:
    BeamEnd ray_at(const Vec2& place, const LightPath& path) const;
    Id add_end(const Vec2& place, const LightPath& path);
    Id end_of(Id corner, Id history);
    Id border_end(const HistoryBorder& border, Id history);
    Id border_end(Id inside, Id outside, Id history) {
        return border_end(histories_.border(inside, outside, history), history);
    }
    bool falls(const std::array<Id, 3>& ends) const;
    void add_arriving(Id history, const Vec3& flux);
    Id known_middle(Id a, Id b, Id history);
    std::array<Id, 3> known_middles(const std::array<Id, 3>& corner, Id history);
    void add_beam(const std::array<Id, 3>& ends, Id history, const std::array<Id, 3>& middle = kNoMiddles);
    void add_tip(Id a, Id b, Id c, Id history);
    void add_stump(Id b, Id c, Id without, Id history);
    void add_triangle(const BeamGrid::Triangle& triangle, Id history);
    NodeCorners corners_in(Id node) const;
    bool add_merged(Id history, const NodeCorners& in);
    CutEnd corner_end(Id corner, Id history) const;
    bool is_faint_border(Id history, const NodeCorners& in) const;
    bool is_one_beam_between(const std::array<CutEnd, 3>& ends, Id history, const NodeCorners& in) const;
    bool is_cut_straight(const std::array<Vec2, 2>& line, Id history, const NodeCorners& in) const;
    bool add_cut(Id history, const NodeCorners& in);
    void add_node(Id node, const std::vector<Id>& histories);
    void set_spreads(std::size_t first_end, std::size_t first_beam);

    BeamGrid& grid_;
    Beams& beams_;
    GridHistories histories_;
    std::unordered_map<std::uint64_t, Id> middle_;  // by corner and history
    std::map<std::tuple<Id, Id, Id>, Id> end_;      // by corner inside, outside or kNone at a corner, history
    MergeParams merge_;
};

BeamEnd BeamMaker::ray_at(const Vec2& place, const LightPath& path) const {
    return {place,      path.ray.origin, path.ray.direction, path.arriving,
            path.light, path.optic,      path.object,        grid_.window().density(place),
            {}};
}

Id BeamMaker::add_end(const Vec2& place, const LightPath& path) {
    beams_.ends.push_back(ray_at(place, path));
    return static_cast<Id>(beams_.ends.size() - 1);
}

Id BeamMaker::end_of(Id corner, Id history) {
    const auto [at, is_new] = end_.try_emplace({corner, kNone, history}, kNone);
    if (is_new) at->second = add_end(grid_.place(corner), *histories_.path_at(corner, history));
    return at->second;
}

Id BeamMaker::border_end(const HistoryBorder& border, Id history) {
    const auto [at, is_new] = end_.try_emplace({border.inside, border.outside, history}, kNone);
    if (is_new) at->second = add_end(border.place, border.path);
    return at->second;
}

/// Whether any of it does not only go on to another optic.
bool BeamMaker::falls(const std::array<Id, 3>& ends) const {
    return std::any_of(ends.begin(), ends.end(), [&](Id e) { return beams_.ends[e].falls(); });
}

/// Of a part of the film.
void BeamMaker::add_arriving(Id history, const Vec3& flux) {
    const std::vector<Step>& steps = beams_.histories[history].steps;
    if (steps.size() == 1)
        beams_.arriving.try_emplace({steps[0].optic, steps[0].event}, Vec3(0)).first->second += flux;
}

/// Of two corners' side, where the history's ray was looked at there.
Id BeamMaker::known_middle(Id a, Id b, Id history) {
    const Id corner = grid_.middle_between(a, b);
    const LightPath* path = corner == kNone ? nullptr : histories_.path_at(corner, history);
    if (!path) return kNone;
    const auto [at, is_new] =
        middle_.try_emplace(std::uint64_t{corner} << 32 | history, static_cast<Id>(beams_.middles.size()));
    if (is_new) beams_.middles.push_back(ray_at(grid_.place(corner), *path));
    return at->second;
}

std::array<Id, 3> BeamMaker::known_middles(const std::array<Id, 3>& corner, Id history) {
    return {known_middle(corner[1], corner[2], history), known_middle(corner[2], corner[0], history),
            known_middle(corner[0], corner[1], history)};
}

void BeamMaker::add_beam(const std::array<Id, 3>& ends, Id history, const std::array<Id, 3>& middle) {
    const double measure = grid_.window().measure(beams_.ends[ends[0]].place, beams_.ends[ends[1]].place,
                                                  beams_.ends[ends[2]].place);
    if (!(measure > 0)) return;
    LightBeam beam{ends, history, measure, static_cast<Id>(beams_.windows.size() - 1), {}, middle};
    beam.flux = beam_integral(beams_, beam, [](const BeamEnd& end) { return end.light; });
    add_arriving(history, beam_integral(beams_, beam, [](const BeamEnd& end) { return end.arriving; }));
    if (falls(ends)) beams_.beams.push_back(beam);
}

/// A corner and what of its two sides is its history's.
void BeamMaker::add_tip(Id a, Id b, Id c, Id history) {
    add_beam({end_of(a, history), border_end(a, b, history), border_end(a, c, history)}, history);
}

/// Two corners, and what of the sides to the third is their history's.
void BeamMaker::add_stump(Id b, Id c, Id without, Id history) {
    const Id at_b = end_of(b, history), at_c = end_of(c, history);
    const Id from_b = border_end(b, without, history), from_c = border_end(c, without, history);
    add_beam({at_b, at_c, from_c}, history);
    add_beam({at_b, from_c, from_b}, history);
}

/// A tear that ends inside of it is left as it is.
void BeamMaker::add_triangle(const BeamGrid::Triangle& triangle, Id history) {
    std::array<Id, 3> corner = triangle.corner;
    const auto has = [&](Id one) { return histories_.path_at(one, history) != nullptr; };
    const auto torn = [&](Id one, Id other) { return histories_.is_torn(one, other, history); };
    const auto count = std::count_if(corner.begin(), corner.end(), has);
    for (int turn = 0; turn < 3; ++turn) {
        const auto [a, b, c] = corner;
        if (count == 1 && has(a)) return add_tip(a, b, c, history);
        if (count == 2 && !has(a)) {
            if (!torn(b, c)) return add_stump(b, c, a, history);
            add_tip(b, c, a, history);
            return add_tip(c, a, b, history);
        }
        if (count == 3 && torn(a, b) && torn(a, c) && !torn(b, c)) {
            add_tip(a, b, c, history);
            return add_stump(b, c, a, history);
        }
        std::rotate(corner.begin(), corner.begin() + 1, corner.end());
    }
    if (count == 3)
        add_beam({end_of(corner[0], history), end_of(corner[1], history), end_of(corner[2], history)},
                 history, known_middles(corner, history));
}

NodeCorners BeamMaker::corners_in(Id node) const {
    NodeCorners found;
    std::unordered_set<Id> known;
    const auto add = [&](Id corner, const Vec3& weights) {
        if (corner != kNone && known.insert(corner).second) found.corners.emplace_back(corner, weights);
    };
    const auto visit = [&](const auto& again, Id at, const std::array<Vec3, 3>& weights) -> void {
        const BeamGrid::Node& one = grid_.nodes()[at];
        for (std::size_t k = 0; k < 3; ++k) add(one.corner[k], weights[k]);
        const Vec3 middle = 0.5 * (weights[0] + weights[1]);
        add(grid_.middle_between(one.corner[0], one.corner[1]), middle);
        if (one.triangle != kNone) return found.triangles.push_back(one.triangle);
        again(again, one.first_child, {weights[2], weights[0], middle});
        again(again, one.first_child + 1, {weights[1], weights[2], middle});
    };
    visit(visit, node, {Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1)});
    return found;
}

/// One beam for all of the history's in a node; false: it takes more.
bool BeamMaker::add_merged(Id history, const NodeCorners& in) {
    const double measure = grid_.window().measure(
        grid_.place(in.corners[0].first), grid_.place(in.corners[1].first), grid_.place(in.corners[2].first));
    std::vector<MergeSample> samples;
    for (const auto& [corner, weights] : in.corners) {
        samples.push_back({weights, histories_.path_at(corner, history)});
        if (!samples.back().path) return false;
    }
    if (!is_one_beam(samples, measure, merge_)) return false;
    LightBeam beam{{}, history, measure, static_cast<Id>(beams_.windows.size() - 1), {}, kNoMiddles};
    Vec3 arriving(0);
    for (const Id t : in.triangles) {
        const auto& [a, b, c] = grid_.triangles()[t].corner;
        const double part = grid_.window().measure(grid_.place(a), grid_.place(b), grid_.place(c));
        for (const Id corner : {a, b, c}) {
            const LightPath& path = *histories_.path_at(corner, history);
            beam.flux += part / 3 * path.light, arriving += part / 3 * path.arriving;
        }
    }
    add_arriving(history, arriving);
    if (!(beam.measure > 0) || !samples[0].path->falls()) return true;
    for (std::size_t k = 0; k < 3; ++k) beam.end[k] = end_of(in.corners[k].first, history);
    beam.middle = known_middles({in.corners[0].first, in.corners[1].first, in.corners[2].first}, history);
    beams_.beams.push_back(beam);
    return true;
}

CutEnd BeamMaker::corner_end(Id corner, Id history) const {
    return {corner, nullptr, grid_.place(corner), histories_.path_at(corner, history)};
}

/// Whether so little goes there that its border need not be followed closely.
bool BeamMaker::is_faint_border(Id history, const NodeCorners& in) const {
    if (beams_.histories[history].steps.size() == 1) return false;  // it tells what arrives
    return std::all_of(in.corners.begin(), in.corners.end(), [&](const auto& corner) {
        const LightPath* path = histories_.path_at(corner.first, history);
        return !path || strength_of(path->light) < kFaintBorder * grid_.brightest();
    });
}

/// Whether what is known inside of a triangle of ends is as one beam between them has it.
bool BeamMaker::is_one_beam_between(const std::array<CutEnd, 3>& ends, Id history,
                                    const NodeCorners& in) const {
    std::vector<MergeSample> samples{
        {Vec3(1, 0, 0), ends[0].path}, {Vec3(0, 1, 0), ends[1].path}, {Vec3(0, 0, 1), ends[2].path}};
    const Vec2 ab = ends[1].place - ends[0].place, ac = ends[2].place - ends[0].place;
    const double area = cross(ab, ac);
    if (area == 0) return false;
    for (const auto& [corner, of_node] : in.corners) {
        const LightPath* path = histories_.path_at(corner, history);
        const Vec2 way = grid_.place(corner) - ends[0].place;
        const double b = cross(way, ac) / area, c = cross(ab, way) / area;
        if (path && b >= 0 && c >= 0 && b + c <= 1) samples.push_back({Vec3(1 - b - c, b, c), path});
    }
    return is_one_beam(samples, grid_.window().measure(ends[0].place, ends[1].place, ends[2].place), merge_);
}

/// Whether all that is known of the history lies on one side of a straight line between two of its borders,
/// nearly.
bool BeamMaker::is_cut_straight(const std::array<Vec2, 2>& line, Id history, const NodeCorners& in) const {
    const auto [from, to] = line;
    const double slack = kStraightBorder * length(to - from) *
                         length(grid_.place(in.corners[0].first) - grid_.place(in.corners[1].first));
    bool found[2][2] = {};  // on either side: corners that lack it, and that have it
    for (const auto& [corner, weights] : in.corners) {
        const double beside = cross(to - from, grid_.place(corner) - from);
        if (std::fabs(beside) > slack)
            found[beside > 0][histories_.path_at(corner, history) != nullptr] = true;
    }
    const bool is_mixed = (found[0][0] && found[0][1]) || (found[1][0] && found[1][1]);
    return !is_mixed && !(found[0][1] && found[1][1]);
}

/// The beams of a node that the history's border cuts straight, where little goes; false: it takes more.
bool BeamMaker::add_cut(Id history, const NodeCorners& in) {
    std::array<Id, 3> corner{in.corners[0].first, in.corners[1].first, in.corners[2].first};
    const auto has = [&](Id known) { return histories_.path_at(known, history) != nullptr; };
    const auto count = std::count_if(corner.begin(), corner.end(), has);
    if (count == 0 || count == 3 || !is_faint_border(history, in)) return false;
    // The first corner is the one that differs.
    while (has(corner[0]) != (count == 1) || has(corner[1]) == (count == 1))
        std::rotate(corner.begin(), corner.begin() + 1, corner.end());
    const auto [a, b, c] = corner;
    const HistoryBorder *at_b = count == 1 ? histories_.border_between(a, b, history)
                                           : histories_.border_between(b, a, history),
                        *at_c = count == 1 ? histories_.border_between(a, c, history)
                                           : histories_.border_between(c, a, history);
    if (!at_b || !at_c || !is_cut_straight({at_b->place, at_c->place}, history, in)) return false;

    const CutEnd from_b = CutEnd::at(*at_b), from_c = CutEnd::at(*at_c);
    std::vector<std::array<CutEnd, 3>> beams;
    if (count == 1) {
        beams = {{corner_end(a, history), from_b, from_c}};
    } else {
        const CutEnd whole_b = corner_end(b, history), whole_c = corner_end(c, history);
        beams = {{whole_b, whole_c, from_c}, {whole_b, from_c, from_b}};
    }
    for (const auto& ends : beams)
        if (!is_one_beam_between(ends, history, in)) return false;
    for (const auto& ends : beams) {
        std::array<Id, 3> end;
        for (std::size_t k = 0; k < 3; ++k)
            end[k] = ends[k].border ? border_end(*ends[k].border, history) : end_of(ends[k].corner, history);
        add_beam(end, history);
    }
    return true;
}

void BeamMaker::add_node(Id node, const std::vector<Id>& histories) {
    const BeamGrid::Node& one = grid_.nodes()[node];
    if (one.triangle != kNone) {
        for (const Id history : histories) add_triangle(grid_.triangles()[one.triangle], history);
        return;
    }
    const NodeCorners in = corners_in(node);
    std::vector<Id> divided;
    for (const Id history : histories) {
        const bool is_there = std::any_of(in.corners.begin(), in.corners.end(), [&](const auto& corner) {
            return histories_.path_at(corner.first, history) != nullptr;
        });
        if (is_there && !add_merged(history, in) && !add_cut(history, in)) divided.push_back(history);
    }
    if (divided.empty()) return;
    add_node(one.first_child, divided);
    add_node(one.first_child + 1, divided);
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
        const double area = cross(ab, ac);
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
    beams_.windows.push_back(grid_.window());
    histories_.find_borders(progress);
    find_hidden_histories(grid_, histories_, progress.part(1, 0));
    const std::size_t first_end = beams_.ends.size(), first_beam = beams_.beams.size();
    merge_ = {grid_.tolerance(), grid_.scene_size(), grid_.brightest(), kFaintShare * grid_.mean_arriving()};
    std::vector<Id> all(beams_.histories.size());
    std::iota(all.begin(), all.end(), Id{0});
    for (Id root = 0; root < grid_.root_count(); ++root) {
        progress.stop_if_cancelled();
        add_node(root, all);
    }
    set_spreads(first_end, first_beam);
}

}  // namespace

void add_beams(BeamGrid& grid, Beams& beams, const Progress& progress) {
    BeamMaker(grid, beams).make(progress);
}

}  // namespace trilens
