#include "caustics/refined_beams.h"

#include <algorithm>
#include <cmath>

namespace trilens {
namespace {

/// Halvings of a beam's sides.
constexpr int kMostLevels = 9;
/// Sides of a triangle bent by less than this share of the footprint are straight once they are halved: a
/// quarter of it remains.
constexpr double kStraight = 0.04;
/// Quarters of a triangle whose areas differ by less than this share are equally bright.
constexpr double kEvenQuarters = 0.06;
/// Triangles thinner than this share of the footprint need not be so.
constexpr double kThin = 0.1;
/// A piece that would bring less than this share of the light's mean over the scene, if all of it came to the
/// footprint, is not divided further.
constexpr double kFaintPiece = 3e-4;
/// One whose bent sides would put more than this beside its place, in the same measure, is.
constexpr double kMisplaced = 3e-2;
/// Rays between those at a part's ends and middles may lie so much farther out than they.
constexpr double kWider = 1.5;
/// What a point without a footprint is looked at by: a share of the scene's size.
constexpr double kPointSize = 1e-4;
/// Of one source; some 600 bytes each.
constexpr std::size_t kMostKept = 1 << 17;

using Ends = BeamEnds;

/// Of a triangle, whatever follows its corners.
double longest_side(std::span<const Vec2> at) {
    return std::max({length(at[1] - at[0]), length(at[2] - at[1]), length(at[0] - at[2])});
}

}  // namespace

std::array<BeamEnds, 4> quarters(const BeamEnds& end, const BeamEnds& middle) {
    return {{{end[0], middle[2], middle[1]},
             {middle[2], end[1], middle[0]},
             {middle[1], middle[0], end[2]},
             middle}};
}

std::shared_ptr<const BeamDivision> RecentDivisions::get(Id beam, std::uint32_t place, const Make& make) {
    const std::uint64_t key = std::uint64_t{beam} << 32 | place;
    Shard& shard = shard_[(key * 0x9e3779b97f4a7c15ULL) >> 58];  // Fibonacci hashing, to 64 shards
    {
        const std::lock_guard hold(shard.lock);
        const auto at = shard.known.find(key);
        if (at != shard.known.end()) return at->second;
    }
    auto division = std::make_shared<BeamDivision>();
    make(*division);
    const std::lock_guard hold(shard.lock);
    if (shard.known.size() >= kMostInShard) shard.known.clear();
    return shard.known.try_emplace(key, std::move(division)).first->second;
}

namespace {

std::array<BeamEnds, 4> quarters(const BeamEnds& end, const BeamDivision& by) {
    return quarters(end, BeamEnds{&by.middle[0], &by.middle[1], &by.middle[2]});
}

}  // namespace

/// A part of a beam between three ends.
struct RefinedBeams::Part {
    Ends end;
    const Lazy<BeamDivision>& kept;
    std::uint32_t place;  // of place_of_part
};

RefinedBeams::RefinedBeams(const LightSpace& space, const BeamSource& source, const Beams& beams,
                           const Progress& progress)
    : space_(space),
      source_(source),
      beams_(&beams),
      division_(std::make_unique<Lazy<BeamDivision>[]>(beams.beams.size())),
      kept_(std::make_unique<std::atomic<std::size_t>>(0)),
      recent_(std::make_unique<RecentDivisions>()) {
    find_sides(progress);
    const Vec3 all = beams.flux_arriving();
    mean_light_ = (all.x + all.y + all.z) / (space.size * space.size);
}

void RefinedBeams::find_sides(const Progress& progress) {
    struct Side {
        Id beam, a, b, known;
    };
    std::vector<Side> sides;
    std::unordered_map<std::uint64_t, Id> known;
    for (Id i = 0; i < beams_->beams.size(); ++i) {
        const auto& end = beams_->beams[i].end;
        std::array<Id, 3>& own = side_.emplace_back();
        for (std::size_t k = 0; k < 3; ++k) {
            const auto [a, b] = std::minmax(end[(k + 1) % 3], end[(k + 2) % 3]);
            const auto [at, is_new] =
                known.try_emplace((std::uint64_t{a} << 32) | b, static_cast<Id>(sides.size()));
            if (is_new) sides.push_back({i, a, b, kNone});
            own[k] = at->second;
            Id& middle = sides[at->second].known;
            if (middle == kNone) middle = beams_->beams[i].middle[k];
        }
    }
    side_middle_.resize(sides.size());
    LoopProgress done(progress, static_cast<double>(sides.size()));
    parallel_for(sides.size(), 64, [&](std::size_t first, std::size_t last) {
        for (std::size_t i = first; i < last; ++i) {
            done.stop_if_cancelled();
            const Side& side = sides[i];
            const BeamEnd &a = beams_->ends[side.a], &b = beams_->ends[side.b];
            const bool is_known = side.known != kNone &&
                                  !is_beyond_tear(a.origin, beams_->middles[side.known].origin, b.origin);
            side_middle_[i] = is_known ? beams_->middles[side.known] : middle(side.beam, a, b);
        }
        done.add(static_cast<double>(last - first));
    });
}

/// Where the history ends between, or is torn, its border is as straight as the beam has it.
BeamEnd RefinedBeams::middle(Id beam, const BeamEnd& a, const BeamEnd& b) const {
    const LightBeam& of = beams_->beams[beam];
    const LightHistory& history = beams_->histories[of.history];
    const LightWindow& window = beams_->windows[of.window];
    BeamEnd end;
    end.place = 0.5 * (a.place + b.place);
    end.film = window.density(end.place);
    const Ray ray = window.ray(end.place);
    const auto single = follow_history(space_, source_, ray, history);
    if (single && !is_beyond_tear(a.origin, single->path.ray.origin, b.origin)) {
        end.origin = single->path.ray.origin, end.direction = single->path.ray.direction;
        end.arriving = single->path.arriving;
        if (is_free(space_, ray, *single)) end.light = single->path.light;
        return end;
    }
    end.origin = 0.5 * (a.origin + b.origin);
    end.direction = normalize_or_zero(a.direction + b.direction);
    end.arriving = 0.5 * (a.arriving + b.arriving), end.light = 0.5 * (a.light + b.light);
    return end;
}

void RefinedBeams::look_ahead(Id beam, BeamEnd& end) const {
    const LightHistory& history = beams_->histories[beams_->beams[beam].history];
    if (history.medium != kNone) return;
    const Ray ray{end.origin, end.direction};
    const auto next = next_optic(*space_.optics, {ray, history.steps.back().optic, {}});
    const Hit hit = space_.objects->first_hit(ray);
    const bool is_first = hit.seen() && (!next || hit.t <= next->distance + next->touch);
    end.object = is_first ? hit.t : INFINITY;
    end.optic = next && !is_first ? next->distance : INFINITY;
}

void RefinedBeams::divide(Id beam, const Ends& end, BeamDivision& into) const {
    for (std::size_t k = 0; k < 3; ++k) into.middle[k] = middle(beam, *end[(k + 1) % 3], *end[(k + 2) % 3]);
}

const BeamDivision& RefinedBeams::division(Id beam) const {
    return division_[beam].get([&] {
        auto division = std::make_unique<BeamDivision>();
        for (std::size_t k = 0; k < 3; ++k) division->middle[k] = side_middle_[side_[beam][k]];
        return division;
    });
}

const BeamDivision& RefinedBeams::division(Id beam, const BeamEnds& end, const Lazy<BeamDivision>& of) const {
    return of.get([&] {
        auto division = std::make_unique<BeamDivision>();
        divide(beam, end, *division);
        return division;
    });
}

/// The same; `own` holds it where enough is kept.
const BeamDivision& RefinedBeams::division_for_now(Id beam, const Part& part,
                                                   std::shared_ptr<const BeamDivision>& own) const {
    if (const BeamDivision* kept = part.kept.find()) return *kept;
    if (kept_->load(std::memory_order_relaxed) < kMostKept) {
        kept_->fetch_add(1, std::memory_order_relaxed);
        return division(beam, part.end, part.kept);
    }
    own = recent_->get(beam, part.place, [&](BeamDivision& into) { divide(beam, part.end, into); });
    return *own;
}

BeamCorners RefinedBeams::corners(Id beam, const BeamEnds& end) const {
    const LightWindow& window = beams_->windows[beams_->beams[beam].window];
    return {end, window.measure(end[0]->place, end[1]->place, end[2]->place)};
}

struct RefinedBeams::Visit {
    const RefinedBeams& refined;
    Id beam;
    const ReceiverPlane& plane;
    const Use& use;
    double unit;  // of the plane's coordinates, that a footprint is wide
    double half;  // of the footprint

    /// Of a triangle of which a part falls on the plane, or none.
    void use_part(const Ends& end) const {
        const BeamCorners corners = refined.corners(beam, end);
        const FallenBeams fallen = fall(corners, plane);
        for (std::size_t i = 0; i < fallen.count; ++i) use(corners, fallen.part[i]);
    }

    void use_whole(const Ends& end, const std::array<Vec2, 3>& at) const {
        if (is_beyond(at, 0)) return;
        FallenBeam fallen;
        fallen.at = at;
        for (std::size_t k = 0; k < 3; ++k) fallen.light[k] = end[k]->light, fallen.place[k] = end[k]->place;
        const BeamCorners corners = refined.corners(beam, end);
        fallen.measure = corners.measure;
        use(corners, fallen);
    }

    /// What all of the part would bring to the footprint (of a point: to what it is looked at by), as a share
    /// of the light's mean over the scene.
    double brightness(const Ends& end) const {
        double brightest = 0;
        for (const BeamEnd* one : end) brightest = std::max(brightest, strength_of(one->light));
        if (brightest == 0) return 0;
        const double area = unit * unit * plane.unit_area;
        return refined.corners(beam, end).measure * brightest / (refined.mean_light_ * area);
    }

    /// Whether its chords put little of what the part brings beside its place.
    static bool is_in_place(const std::array<Vec2, 6>& at, double bulge, double brightness) {
        const double area = std::fabs(cross(at[1] - at[0], at[2] - at[0]));
        return brightness * std::min(area, bulge * longest_side(at)) <= kMisplaced * area;
    }

    bool is_beyond(std::span<const Vec2> at, double room) const {
        for (int c = 0; c < 2; ++c) {
            double low = INFINITY, high = -INFINITY;
            for (const Vec2& one : at) low = std::min(low, one[c]), high = std::max(high, one[c]);
            if (low - room > half || high + room < -half) return true;
        }
        return false;
    }

    /// Corners, then middles.
    bool is_flat(const std::array<Vec2, 6>& at, double bulge) const {
        if (bulge > kStraight * unit) return false;
        const double all = cross(at[1] - at[0], at[2] - at[0]);
        if (std::fabs(all) < kThin * unit * longest_side(at)) return true;
        const double quarter[4] = {cross(at[5] - at[0], at[4] - at[0]), cross(at[1] - at[5], at[3] - at[5]),
                                   cross(at[3] - at[4], at[2] - at[4]), cross(at[4] - at[3], at[5] - at[3])};
        return std::all_of(quarter, quarter + 4, [&](double one) {
            return std::fabs(4 * one - all) < kEvenQuarters * std::fabs(all);
        });
    }

    const BeamDivision& division(const Part& part, int level,
                                 std::shared_ptr<const BeamDivision>& own) const {
        return level == 0 ? refined.division(beam) : refined.division_for_now(beam, part, own);
    }

    /// Whether the cone around the rays, made half as wide again, holds a part of the footprint.
    bool may_come(const std::array<const BeamEnd*, 6>& rays) const {
        Vec3 center(0), axis(0);
        for (const BeamEnd* ray : rays) center += ray->origin / 6.0, axis += ray->direction;
        axis = normalize_or_zero(axis);
        double radius = 0, cosine = 1;
        for (const BeamEnd* ray : rays) {
            radius = std::max(radius, length(ray->origin - center));
            cosine = std::min(cosine, dot(ray->direction, axis));
        }
        const Vec3 way = plane.point - center;
        const double far = length(way), near = kWider * radius + plane.reach;
        if (far <= near) return true;
        return std::acos(std::clamp(dot(way, axis) / far, -1.0, 1.0)) <=
               kWider * std::acos(std::clamp(cosine, -1.0, 1.0)) + std::asin(near / far);
    }

    /// Of a part some of whose rays go away from the plane: divided until what crosses its horizon is faint.
    void visit_half(const Part& part, int level) const {
        if (level + 1 >= kMostLevels || brightness(part.end) < kFaintPiece) return use_part(part.end);
        std::shared_ptr<const BeamDivision> own;
        const BeamDivision& by = division(part, level, own);
        const std::array<const BeamEnd*, 6> rays{part.end[0],   part.end[1],   part.end[2],
                                                 &by.middle[0], &by.middle[1], &by.middle[2]};
        if (std::none_of(rays.begin(), rays.end(),
                         [&](const BeamEnd* ray) { return place_on(plane, *ray).has_value(); }) ||
            !may_come(rays))
            return;
        const std::array<Ends, 4> parts = quarters(part.end, by);
        for (std::size_t i = 0; i < 4; ++i)
            visit({parts[i], by.part[i], place_of_part(part.place, i)}, level + 1, INFINITY);
    }

    void visit(const Part& part, int level, double guess) const {
        const Ends& end = part.end;
        std::array<Vec2, 6> at;
        for (std::size_t k = 0; k < 3; ++k) {
            const std::optional<Vec2> on = place_on(plane, *end[k]);
            if (!on) return visit_half(part, level);
            at[k] = *on;
        }
        if (is_beyond(std::span(at).first(3), guess)) return;
        std::shared_ptr<const BeamDivision> own;
        const BeamDivision& by = division(part, level, own);
        double bulge = 0;
        for (std::size_t k = 0; k < 3; ++k) {
            const std::optional<Vec2> on = place_on(plane, by.middle[k]);
            if (!on) return visit_half(part, level);
            at[3 + k] = *on;
            bulge = std::max(bulge, length(*on - 0.5 * (at[(k + 1) % 3] + at[(k + 2) % 3])));
        }
        if (is_beyond(at, bulge)) return;
        const std::array<Ends, 4> parts = quarters(end, by);
        const std::array<std::array<Vec2, 3>, 4> on_plane{
            {{at[0], at[5], at[4]}, {at[5], at[1], at[3]}, {at[4], at[3], at[2]}, {at[3], at[4], at[5]}}};
        const double bright = brightness(end);
        const bool is_last = level + 1 >= kMostLevels || bright < kFaintPiece ||
                             (is_flat(at, bulge) && is_in_place(at, bulge, bright));
        for (std::size_t i = 0; i < 4; ++i) {
            if (is_last)
                use_whole(parts[i], on_plane[i]);
            else
                visit({parts[i], by.part[i], place_of_part(part.place, i)}, level + 1, 0.5 * bulge);
        }
    }
};

void RefinedBeams::for_each_piece(Id beam, const ReceiverPlane& plane, double guess, const Use& use) const {
    const Ends end = corners_of(*beams_, beams_->beams[beam]).end;
    std::array<Vec2, 3> at;
    bool whole = true;
    for (std::size_t k = 0; k < 3 && whole; ++k) {
        const std::optional<Vec2> on = place_on(plane, *end[k]);
        whole = on.has_value();
        if (on) at[k] = *on;
    }
    const Visit visit{*this,
                      beam,
                      plane,
                      use,
                      plane.has_footprint ? 1 : kPointSize * space_.size,
                      plane.has_footprint ? 0.5 : 0};
    if (!whole) return visit.visit_half({end, division_[beam], kWholeBeam}, 0);
    visit.visit({end, division_[beam], kWholeBeam}, 0, std::max(guess, 0.5 * longest_side(at)));
}

void RefinedBeams::for_each_curved_piece(Id beam, const ReceiverPlane& plane, const Use& use) const {
    const BeamCorners corners = corners_of(*beams_, beams_->beams[beam]);
    const CurvedBeam curved{corners, side_middles(beam)};
    const std::optional<std::array<Vec2, 6>> at = curved.fall(plane);
    if (at)
        return curved.for_each_piece({*at, curved.lights()}, plane.has_footprint ? 0.5 : 0,
                                     PieceGrid::kMostSides, use);
    const FallenBeams fallen = fall(corners, plane);
    for (std::size_t i = 0; i < fallen.count; ++i) use(corners, fallen.part[i]);
}

}  // namespace trilens
