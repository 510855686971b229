#include "caustics/beams/beam_grid.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/util/error.h"
#include "base/util/parallel.h"
#include "caustics/beams/quadratic.h"

namespace trilens {
namespace {

/// Paths that carry less than this share of the strongest path of all are not looked at closely: their beams
/// are as the others need them.
constexpr double kFaintLight = 0.03;

/// A triangle's base may be bent by so many tolerances where all of its corners have the same histories: what
/// falls is as a quadratic has it, which is off by a fraction of that, and is divided where it is too much. A
/// border is straight, and as near to its place as triangles are small.
constexpr double kMostBends = 4;

/// What is spread until it is this share of what is faint may fall where it will.
constexpr double kLetBe = 0.05;

/// Beyond the most triangles, this part of them is kept for those in which histories hide.
constexpr std::size_t kReserve = 4;
/// Of the usual number of triangles at most, however small the tolerance.
constexpr double kMostTimes = 4;
/// Of a tolerance, for the truth.
constexpr double kFinerTruth = 16;

/// Halves of a triangle whose areas differ by this share of it are too unequally bright to stand for one.
constexpr double kUnevenHalves = 0.25;

/// Light at a base's middle that differs from that between its ends by this share of the most bends there.
constexpr double kUnevenLight = 0.02;

/// Whether every history of one that carries so much is one of the other.
bool has_all(const std::vector<LightPath>& paths, const std::vector<LightPath>& of, double least) {
    return std::all_of(of.begin(), of.end(), [&](const LightPath& path) {
        return strength_of(path.light) < least || find_history(paths, path) != nullptr;
    });
}

}  // namespace

BeamGrid::BeamGrid(const LightSpace& space, const BeamSource& source, const LightWindow& window, Id first)
    : space_(space), source_(source), window_(window), first_(first) {}

LightPaths BeamGrid::paths_at(const Vec2& place, std::span<const std::vector<Step>* const> only) const {
    return light_paths(space_, source_, window_.ray(place), first_, only);
}

/// Squares of two triangles each, whose common side is the base of both.
void BeamGrid::start(int cells) {
    const Id row = static_cast<Id>(cells) + 1;
    for (Id j = 0; j < row; ++j)
        for (Id i = 0; i < row; ++i) places_.push_back(Vec2(i, j) * (2.0 / cells) - Vec2(1));
    for (Id j = 0; j + 1 < row; ++j)
        for (Id i = 0; i + 1 < row; ++i) {
            const Id a = j * row + i, b = a + 1, c = a + row + 1, d = a + row;
            triangles_.push_back({{c, a, b}, 0});
            triangles_.push_back({{a, c, d}, 0});
        }
    for (Id t = 0; t < triangles_.size(); ++t) {
        link(t);
        nodes_.push_back({triangles_[t].corner, t, kNone});
        node_of_.push_back(t);
    }
    root_count_ = static_cast<Id>(nodes_.size());
}

void BeamGrid::trace_new_corners(const Progress& progress) {
    paths_.resize(places_.size());
    LoopProgress done(progress, static_cast<double>(places_.size() - traced_));
    parallel_for(places_.size() - traced_, 16, [&](std::size_t from, std::size_t to) {
        for (std::size_t i = traced_ + from; i < traced_ + to; ++i) {
            done.stop_if_cancelled();
            paths_[i] = paths_at(places_[i]);
        }
        done.add(static_cast<double>(to - from));
    });
    for (std::size_t i = traced_; i < places_.size(); ++i)
        for (const LightPath& path : paths_[i].paths) {
            brightest_ = std::max(brightest_, strength_of(path.light));
            most_arriving_ = std::max(most_arriving_, strength_of(path.arriving));
        }
    traced_ = places_.size();
}

Id BeamGrid::middle_of(Id a, Id b) {
    const auto [at, is_new] = middles_.try_emplace(edge_of(a, b), static_cast<Id>(places_.size()));
    if (is_new) places_.push_back(0.5 * (places_[a] + places_[b]));
    return at->second;
}

void BeamGrid::link(Id triangle) {
    const auto& corner = triangles_[triangle].corner;
    for (std::size_t k = 0; k < 3; ++k) {
        auto& sides =
            sides_.try_emplace(edge_of(corner[k], corner[(k + 1) % 3]), std::array<Id, 2>{kNone, kNone})
                .first->second;
        sides[sides[0] == kNone ? 0 : 1] = triangle;
    }
}

void BeamGrid::unlink(Id triangle) {
    const auto& corner = triangles_[triangle].corner;
    for (std::size_t k = 0; k < 3; ++k) {
        auto& sides = sides_[edge_of(corner[k], corner[(k + 1) % 3])];
        (sides[0] == triangle ? sides[0] : sides[1]) = kNone;
    }
}

void BeamGrid::bisect(Id triangle, Id middle) {
    unlink(triangle);
    const Triangle parent = triangles_[triangle];
    const auto [a, b, c] = parent.corner;
    triangles_[triangle] = {{c, a, middle}, parent.level + 1};
    triangles_.push_back({{b, c, middle}, parent.level + 1});
    const Id added = static_cast<Id>(triangles_.size() - 1);
    link(triangle);
    link(added);
    Node& node = nodes_[node_of_[triangle]];
    node.triangle = kNone, node.first_child = static_cast<Id>(nodes_.size());
    node_of_[triangle] = node.first_child;
    node_of_.push_back(node.first_child + 1);
    nodes_.push_back({triangles_[triangle].corner, triangle, kNone});
    nodes_.push_back({triangles_[added].corner, added, kNone});
}

/// The one on the other side of the base is bisected with it, and before that until its base is the same.
void BeamGrid::split(Id triangle) {
    const Id a = triangles_[triangle].corner[0], b = triangles_[triangle].corner[1];
    const auto other_side = [&] {
        const auto& sides = sides_.at(edge_of(a, b));
        return sides[0] == triangle ? sides[1] : sides[0];
    };
    Id other = other_side();
    if (other != kNone) {
        const auto& base = triangles_[other].corner;
        if (edge_of(base[0], base[1]) != edge_of(a, b)) {
            split(other);
            other = other_side();
        }
    }
    const Id middle = middle_of(a, b);
    bisect(triangle, middle);
    if (other != kNone) bisect(other, middle);
}

double BeamGrid::mean_arriving() const {
    double sum = 0;
    for (const Triangle& triangle : triangles_) {
        const auto& [a, b, c] = triangle.corner;
        const double measure = window_.measure(place(a), place(b), place(c));
        for (const Id corner : triangle.corner)
            if (!paths(corner).empty()) sum += measure / 3 * strength_of(paths(corner).front().arriving);
    }
    return sum / (space_.size * space_.size);
}

/// The paths of one history at a triangle's corners, and in the middle of its base.
struct BeamGrid::Corners {
    const LightPath &a, &b, &middle;
    const LightPath* c;  // null: it is not there
    double measure = 0;  // of the light's film in the triangle
};

/// Whether the middle's light falls too far from the middle between that of the base's ends, where it meets
/// an object, or the triangle's halves are too unequally bright there. What is spread widely is let be.
bool BeamGrid::is_uneven(const Corners& corners, double tolerance) const {
    const Ray& ray = corners.middle.ray;
    if (!std::isfinite(corners.middle.object)) return false;
    const Vec3 there = ray.origin + corners.middle.object * ray.direction;
    // On the plane across the middle's ray, which receivers face best.
    const auto fallen = [&](const LightPath& path) -> std::optional<Vec3> {
        const double along = dot(path.ray.direction, ray.direction);
        const double t = dot(there - path.ray.origin, ray.direction) / along;
        if (!(along > 0.1) || !std::isfinite(t)) return std::nullopt;
        return path.ray.origin + t * path.ray.direction;
    };
    const std::optional<Vec3> at_a = fallen(corners.a), at_b = fallen(corners.b);
    if (!at_a || !at_b) return true;
    // Paths that carry less may be off by more.
    const double strength = strength_of(corners.middle.light);
    const double room = tolerance * brightest_ / strength;
    const bool is_bent = length(0.5 * (*at_a + *at_b) - there) > room;
    const std::optional<Vec3> at_c = corners.c ? fallen(*corners.c) : std::nullopt;
    if (!at_c) return is_bent;
    const double first = triple(*at_a - there, *at_c - there, ray.direction),
                 second = triple(*at_c - there, *at_b - there, ray.direction);
    const double both = std::fabs(first) + std::fabs(second);
    if (strength * corners.measure < faint_ * 0.5 * both) return false;
    return is_bent || (both > room * room && std::fabs(first - second) > kUnevenHalves * both);
}

/// Whether its corners have different histories of any that carry so much.
bool BeamGrid::is_mixed(const Triangle& triangle, double least) const {
    const auto& [a, b, c] = triangle.corner;
    const auto differ = [&](Id one, Id other) {
        return !has_all(paths(one), paths(other), least) || !has_all(paths(other), paths(one), least);
    };
    return differ(a, b) || differ(a, middles_.at(edge_of(a, b))) || differ(a, c);
}

/// Whether what comes to the first optic turns along its base: at the edges of a spot's cone, where light is
/// no straight line, and no quadratic either.
bool BeamGrid::is_unevenly_lit(const Triangle& triangle) const {
    const Id a = triangle.corner[0], b = triangle.corner[1], middle = middles_.at(edge_of(a, b));
    if (paths(a).empty() || paths(b).empty() || paths(middle).empty()) return false;  // a border's
    const auto arriving = [&](Id corner) { return paths(corner).front().arriving; };
    const Vec3 bend = 0.5 * (arriving(a) + arriving(b)) - arriving(middle);
    return strength_of(glm::abs(bend)) > kUnevenLight * most_arriving_;
}

/// Those at both ends of its base and in its middle that are not where they should be there.
std::vector<BeamGrid::SideHistory> BeamGrid::uneven_histories(const Triangle& triangle) const {
    const Id a = std::min(triangle.corner[0], triangle.corner[1]),
             b = std::max(triangle.corner[0], triangle.corner[1]);
    const std::vector<LightPath>&at_middle = paths(middles_.at(edge_of(a, b))),
          &at_c = paths(triangle.corner[2]);
    const double least = kFaintLight * brightest_;
    const double measure = window_.measure(place(a), place(b), place(triangle.corner[2]));
    const double tolerance = (is_mixed(triangle, 0) ? 1 : kMostBends) * tolerance_;
    std::vector<SideHistory> uneven;
    for (Id i = 0; i < paths(a).size(); ++i) {
        const LightPath& on_a = paths(a)[i];
        const LightPath *on_b = find_history(paths(b), on_a), *middle = find_history(at_middle, on_a);
        if (!on_b || !middle || strength_of(middle->light) < least) continue;
        if (is_uneven({on_a, *on_b, *middle, find_history(at_c, on_a), measure}, tolerance))
            uneven.emplace_back(a, b, i);
    }
    return uneven;
}

/// Of triangles whose bases' middles have been traced. A history's tear is a border as that between two is.
std::vector<char> BeamGrid::are_too_coarse(std::span<const Id> asked, const Progress& progress) {
    std::vector<char> coarse(asked.size());
    std::vector<std::vector<SideHistory>> uneven(asked.size());
    parallel_for(asked.size(), 256, [&](std::size_t from, std::size_t to) {
        for (std::size_t i = from; i < to; ++i) {
            const Triangle& triangle = triangles_[asked[i]];
            uneven[i] = uneven_histories(triangle);
            coarse[i] = triangle.level < params_.lit_levels && is_unevenly_lit(triangle);
            if (triangle.level >= params_.mixed_levels) continue;
            coarse[i] |= !uneven[i].empty() || is_mixed(triangle, kFaintLight * brightest_);
            uneven[i].clear();
        }
    });
    std::vector<SideHistory> doubtful;
    for (const auto& histories : uneven) doubtful.insert(doubtful.end(), histories.begin(), histories.end());
    find_tears(std::move(doubtful), progress);
    for (std::size_t i = 0; i < asked.size(); ++i)
        for (const SideHistory& one : uneven[i]) coarse[i] |= !tears_.at(one);
    return coarse;
}

/// Splits those of the triangles that are marked. What came of it: halves of what was split, wherever they
/// stand.
std::vector<Id> BeamGrid::split_marked(std::span<const Id> triangles, std::span<const char> marked) {
    const std::size_t before = triangles_.size();
    const std::vector<Triangle> was(triangles_);
    for (std::size_t i = 0; i < triangles.size(); ++i) {
        const Id t = triangles[i];
        if (marked[i] && triangles_[t].corner == was[t].corner) split(t);  // else its neighbour has done it
    }
    std::vector<Id> halves;
    for (Id t = 0; t < triangles_.size(); ++t)
        if (t >= before || triangles_[t].corner != was[t].corner) halves.push_back(t);
    return halves;
}

std::vector<Id> BeamGrid::split_where_room(std::span<const Id> triangles) {
    std::vector<char> marked(triangles.size());
    for (std::size_t i = 0; i < triangles.size(); ++i) marked[i] = has_room(triangles[i]);
    return split_marked(triangles, marked);
}

/// Rounds until nothing is too coarse: each takes triangles of one level, and neighbours that they need.
void BeamGrid::divide_from(std::vector<Id> asked, const Progress& progress) {
    const double rounds = params_.most_levels + 1;
    for (double round = 0; !asked.empty(); ++round) {
        for (const Id t : asked) middle_of(triangles_[t].corner[0], triangles_[t].corner[1]);
        trace_new_corners(progress.part(std::min(round / rounds, 1.0), round < rounds ? 1 / rounds : 0));
        if (faint_ == 0) faint_ = kLetBe * kFaintShare * mean_arriving();
        std::vector<char> coarse = are_too_coarse(asked, progress);
        for (std::size_t i = 0; i < asked.size(); ++i)
            if (coarse[i] && !has_room(asked[i])) ++coarse_, coarse[i] = false;
        asked = split_marked(asked, coarse);
    }
    trace_new_corners(progress.part(1, 0));
}

void BeamGrid::divide_all(std::vector<Id> asked, const Progress& progress) {
    for (Progress part = progress; !asked.empty(); part = progress.part(1, 0)) {
        divide_from(asked, part);
        follow_tears(part);
        asked = split_where_room(torn_oddly());
    }
}

BeamGridParams BeamGridParams::within(double tolerance) {
    // A flat triangle, and a straight piece of a border in one, are off by the square of their size; a
    // bisection halves it.
    BeamGridParams params;
    const double times = std::max(1.0, params.tolerance / tolerance);
    const int more = static_cast<int>(std::ceil(std::log2(times)));
    params.most_levels += more, params.mixed_levels += more, params.lit_levels += more;
    params.most_triangles =
        static_cast<std::size_t>(std::min(times, kMostTimes) * static_cast<double>(params.most_triangles));
    params.tolerance = tolerance;
    return params;
}

BeamGridParams BeamGridParams::truth(double tolerance) {
    return within(tolerance / kFinerTruth);
}

void BeamGrid::divide(const BeamGridParams& params, const Progress& progress) {
    params_ = params;
    tolerance_ = params.tolerance * space_.size;
    most_triangles_ = params.most_triangles;
    start(params.first_cells);
    std::vector<Id> all(triangles_.size());
    std::iota(all.begin(), all.end(), Id{0});
    divide_all(all, progress);
}

bool BeamGrid::divide_more(std::span<const Id> triangles, const Progress& progress) {
    most_triangles_ = params_.most_triangles + params_.most_triangles / kReserve;
    const std::vector<Id> halves = split_where_room(triangles);
    divide_all(halves, progress);
    return !halves.empty();
}

}  // namespace trilens
