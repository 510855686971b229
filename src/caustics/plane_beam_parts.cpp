// Curved beams divided by exact rays on one plane, as far as the light there asks.
#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <memory>
#include <set>

#include "caustics/beams/quadratic.h"
#include "caustics/plane_beams.h"

namespace trilens {
namespace {

/// Halvings of a beam's sides where its quadratic is wrong, and where there is none.
constexpr int kMostHalvings = 5, kMostCuts = 4;
/// Beams that the plane cuts off are left flat, which loses some of their light, where it is this share of
/// what is faint.
constexpr double kFaintFlat = 0.002;
/// Light so many times brighter than what is faint may fall beside its place as far as any; what is brighter
/// less far by as much, but for so small a share.
constexpr double kBright = 60, kLeastRoom = 1e-3, kMostRoom = 4;
/// Beams are in pieces as if the tolerance were so many times what they may be off by, where that is less.
constexpr double kPiecesOff = 4;
/// A beam of one piece, and of four: how much its sides may bend, as a share of the tolerance, its light from
/// linear, and its quarters' areas differ, which pieces follow.
constexpr double kOneBends = 0.02, kOneDiffers = 0.03, kOneUneven = 0.12;
constexpr double kFourBend = 0.08, kFourDiffer = 0.12, kFourUneven = 0.4;
/// Sides of beams that are not so many times brighter than what is faint may bend more by as much, at most so
/// many times.
constexpr double kDim = 20, kMostDim = 12;
/// As beams of few pieces have it, light is no brighter than so many times its mean, nor less bright.
constexpr double kMostDense = 2;

/// Of a side's quarter points and of an inner side's middle: weights of the three ends.
struct QuarterMiddle {
    Vec3 weights;
    std::size_t part, middle;  // whose exact ray it is
};

/// The weights of a beam's ends, and those in the middles of its sides.
const std::array<Vec3, 6> kNodes{Vec3(1, 0, 0),     Vec3(0, 1, 0),     Vec3(0, 0, 1),
                                 Vec3(0, 0.5, 0.5), Vec3(0.5, 0, 0.5), Vec3(0.5, 0.5, 0)};

/// The nine places at which a beam's four parts have exact rays that it has not.
std::array<QuarterMiddle, 9> quarter_middles() {
    const std::size_t ends[3][3] = {{0, 5, 4}, {5, 1, 3}, {4, 3, 2}};
    std::array<QuarterMiddle, 9> all;
    for (std::size_t part = 0; part < 3; ++part)
        for (std::size_t k = 0; k < 3; ++k)
            all[3 * part + k] = {0.5 * (kNodes[ends[part][(k + 1) % 3]] + kNodes[ends[part][(k + 2) % 3]]),
                                 part, k};
    return all;
}

}  // namespace

/// Of one beam: what it becomes. What it traces to divide the beam is forgotten but for what its parts need.
struct PlaneBeams::PartsMaker {
    const Source& source;
    const ReceiverPlane& plane;
    const PlaneBeamsParams& params;
    const Vec2& half;
    const Progress& progress;
    Id index;
    Way way;
    Parts parts{};
    using Side = std::pair<const BeamEnd*, const BeamEnd*>;
    std::map<Side, std::unique_ptr<const BeamEnd>> traced{};  // in the middles of parts' sides
    std::map<const BeamEnd*, BeamEnd> seen{};                 // of those with what they meet

    void make() {
        const BeamEnds& end = corners_of(source.beams, source.beams.beams[index]).end;
        add(end, source.refined.side_middles(index), 0);
        if (traced.empty()) return;
        std::set<const BeamEnd*> needed;
        for (const Curved& one : parts.curved) needed.insert(one.corners.end.begin(), one.corners.end.end());
        for (const Flat& one : parts.flat) needed.insert(one.corners.end.begin(), one.corners.end.end());
        for (auto& [side, middle] : traced)
            if (needed.contains(middle.get())) parts.ends.push_back(std::move(middle));
    }

    /// The exact rays at the middles of a part's sides; neighbours share them.
    BeamEnds middles(const BeamEnds& end) {
        BeamEnds middle;
        for (std::size_t k = 0; k < 3; ++k) {
            const BeamEnd *a = end[(k + 1) % 3], *b = end[(k + 2) % 3];
            std::unique_ptr<const BeamEnd>& known = traced[std::minmax(a, b, std::less<>())];
            if (!known) known = std::make_unique<const BeamEnd>(source.refined.middle(index, *a, *b));
            middle[k] = known.get();
        }
        return middle;
    }

    /// Of a part: where its beam's own ends do not tell, what its ends meet does.
    Way way_of(const BeamEnds& end, int level) {
        if (way != Way::kUnknown || level == 0) return way;
        const BeamEnds& whole = corners_of(source.beams, source.beams.beams[index]).end;
        BeamEnds looked = end;
        for (const BeamEnd*& one : looked) {
            if (one->object > 0 || std::find(whole.begin(), whole.end(), one) != whole.end()) continue;
            const auto [known, is_new] = seen.try_emplace(one, *one);
            if (is_new) source.refined.look_ahead(index, known->second);
            one = &known->second;
        }
        return way_to(looked, plane, params.same_place);
    }

    void add(const BeamEnds& end, const BeamEnds& middle, int level) {
        progress.stop_if_cancelled();
        const CurvedBeam beam{source.refined.corners(index, end), middle};
        const std::optional<std::array<Vec2, 6>> at = beam.fall(plane);
        if (!at) {
            if (level < kMostCuts && is_near(end) && !is_faint(beam.corners))
                return add_parts(end, middle, level);
            return add_flat(beam.corners, level);
        }
        const double bulge = bulge_on_plane(*at);
        if (is_beside(*at, 2 * bulge)) return;
        const double room = room_of(beam, *at);
        if (bulge > kNearlyStraight * room && level < kMostHalvings && is_off(end, middle, *at, room))
            return add_parts(end, middle, level);
        // Where the last optic may stand in the way of a part of it.
        if (level < kMostCuts && !beam.falls_evenly(plane) && way_of(end, level) == Way::kUnknown &&
            !is_faint(beam.corners))
            return add_parts(end, middle, level);
        add_curved(beam, *at, std::min(params.tolerance, kPiecesOff * room), level);
    }

    /// Whether the hull lies beside the face by more than `room`.
    template <std::size_t kCount>
    bool is_beside(const std::array<Vec2, kCount>& at, double room) const {
        PlaneBox box;
        for (const Vec2& one : at) box.include(one);
        return !box.meets({-half - room, half + room});
    }

    FallenBeams fallen(const BeamCorners& corners) const {
        return fall(corners, plane, std::max(half.x, half.y));
    }

    /// How many times brighter than in the mean it is somewhere, over a tolerance's width at folds.
    double peak(const std::array<Vec2, 6>& at) const {
        const double all = std::fabs(cross(at[1] - at[0], at[2] - at[0]));
        double longest = 0, least = INFINITY, most = -INFINITY;
        for (std::size_t k = 0; k < 6; ++k) {
            const double spread = quadratic_spread(at, kNodes[k]);
            least = std::min(least, spread), most = std::max(most, spread);
            if (k < 3) longest = std::max(longest, length(at[(k + 1) % 3] - at[k]));
        }
        const double at_fold = std::sqrt(std::max(longest / params.tolerance, 1.0));
        if (!(least * most > 0)) return at_fold;
        return std::clamp(all / std::min(std::fabs(least), std::fabs(most)), 1.0, at_fold);
    }

    static double strength_of_brightest(const CurvedBeam& beam) {
        double strength = 0;
        for (std::size_t k = 0; k < 3; ++k)
            strength = std::max(
                {strength, strength_of(beam.corners.end[k]->light), strength_of(beam.middle[k]->light)});
        return strength;
    }

    /// How many times brighter it is, in the mean, than what is faint.
    double brightness(const CurvedBeam& beam, const std::array<Vec2, 6>& at) const {
        const double area = 0.5 * std::fabs(cross(at[1] - at[0], at[2] - at[0]));
        return strength_of_brightest(beam) * beam.corners.measure / (params.faint_light * area);
    }

    /// How far it may be off.
    double room_of(const CurvedBeam& beam, const std::array<Vec2, 6>& at) const {
        const double brightest = (params.is_alone ? peak(at) : 1) * brightness(beam, at);
        if (brightest < 1) return INFINITY;
        return params.tolerance *
               std::max(kMostOff, kFaintOff * params.brightest / strength_of_brightest(beam)) *
               std::clamp(kBright / brightest, kLeastRoom, kMostRoom);
    }

    /// How much its quarters' areas differ from a quarter, as a share.
    static double unevenness(const std::array<Vec2, 6>& at) {
        const double all = cross(at[1] - at[0], at[2] - at[0]);
        double most = 0;
        const std::size_t quarter[4][3] = {{0, 5, 4}, {5, 1, 3}, {4, 3, 2}, {3, 4, 5}};
        for (const auto& q : quarter) {
            const double area = cross(at[q[1]] - at[q[0]], at[q[2]] - at[q[0]]);
            most = std::max(most, std::fabs(4 * area / all - 1));
        }
        return most;
    }

    /// How much its light differs from linear, as a share.
    static double difference(const std::array<Vec3, 6>& light) {
        double brightest = 0, bends = 0;
        for (std::size_t k = 0; k < 3; ++k) {
            const double a = strength_of(light[(k + 1) % 3]), b = strength_of(light[(k + 2) % 3]),
                         m = strength_of(light[3 + k]);
            brightest = std::max({brightest, a, m}), bends = std::max(bends, std::fabs(m - 0.5 * (a + b)));
        }
        return brightest > 0 ? bends / brightest : 0;
    }

    /// `tolerance`: of its sides' bends.
    static int sides_of(const FallenCurve& curve, double tolerance) {
        const double bulge = bulge_on_plane(curve.at), uneven = unevenness(curve.at),
                     differs = difference(curve.light);
        if (bulge <= kOneBends * tolerance && uneven <= kOneUneven && differs <= kOneDiffers) return 1;
        return bulge <= kFourBend * tolerance && uneven <= kFourUneven && differs <= kFourDiffer ? 2 : 4;
    }

    /// Of one in few pieces: as its quadratic spreads its light.
    static void spread_light(Curved& one) {
        const std::array<Vec2, 6>& at = one.curve.at;
        const PieceGrid& grid = PieceGrid::of(one.sides);
        double all = 0;
        for (std::size_t p = 0; p < grid.pieces; ++p) {
            std::array<Vec2, 3> corner{};
            for (std::size_t k = 0; k < 3; ++k)
                for (std::size_t c = 0; c < 6; ++c) corner[k] += grid.quadratic[grid.piece[p][k]][c] * at[c];
            all += one.part[p] = std::fabs(cross(corner[1] - corner[0], corner[2] - corner[0]));
        }
        for (std::size_t p = 0; p < grid.pieces; ++p) one.part[p] *= static_cast<double>(grid.pieces) / all;
        for (std::size_t k = 0; k < 6; ++k)
            one.spread[k] *=
                std::clamp(all / std::fabs(quadratic_spread(at, kNodes[k])), 1 / kMostDense, kMostDense);
        Vec3 mean(0);
        for (std::size_t p = 0; p < grid.pieces; ++p)
            for (const std::size_t n : grid.piece[p])
                for (std::size_t c = 0; c < 6; ++c)
                    mean += one.part[p] / (3.0 * static_cast<double>(grid.pieces)) * grid.quadratic[n][c] *
                            one.spread[c];
        for (Vec3& light : one.spread)
            for (int c = 0; c < 3; ++c) light[c] *= mean[c] > 0 ? one.mean_light[c] / mean[c] : 1;
    }

    void add_curved(const CurvedBeam& beam, const std::array<Vec2, 6>& at, double tolerance, int level) {
        Curved one{beam.corners, {at, beam.lights()}, index, way_of(beam.corners.end, level)};
        if (one.way == Way::kStopped) return;
        const double dim = std::clamp(kDim / brightness(beam, at), 1.0, kMostDim);
        one.sides = sides_of(one.curve, dim * tolerance);
        one.mean_light = mean_light(one.curve.light, one.sides);
        one.spread = one.curve.light;
        if (one.sides < PieceGrid::kMostSides) spread_light(one);
        const LightBeam& of = source.beams.beams[index];
        one.is_plain = one.way == Way::kFree && source.beams.histories[of.history].medium == kNone;
        parts.curved.push_back(one);
    }

    void add_parts(const BeamEnds& end, const BeamEnds& middle, int level) {
        for (const BeamEnds& part : quarters(end, middle)) add(part, middles(part), level + 1);
    }

    /// Whether any of it comes to the face.
    bool is_near(const BeamEnds& end) const {
        const FallenBeams flats = fallen(source.refined.corners(index, end));
        for (std::size_t i = 0; i < flats.count; ++i)
            if (!is_beside(flats.part[i].at, 0)) return true;
        return false;
    }

    /// Whether it brings little light to the plane, wherever its ends fall: by its width across the rays
    /// there, since its flat triangle may have no bounds.
    bool is_faint(const BeamCorners& corners) const {
        double strength = 0;
        for (const BeamEnd* end : corners.end) strength = std::max(strength, strength_of(end->light));
        bool falls = false;
        for (const BeamEnd* end : corners.end) {
            const double height = dot(end->origin - plane.point, plane.normal),
                         fall = -dot(end->direction, plane.normal);
            if (!(height >= 0) || !(fall > kGrazingFall)) continue;
            falls = true;
            std::array<Vec3, 3> at;
            for (std::size_t k = 0; k < 3; ++k)
                at[k] = corners.end[k]->origin + height / fall * corners.end[k]->direction;
            const double area = 0.5 * length(cross(at[1] - at[0], at[2] - at[0]));
            if (!(strength * corners.measure * fall < kFaintFlat * params.faint_light * area)) return false;
        }
        return falls;
    }

    void add_flat(const BeamCorners& corners, int level) {
        const FallenBeams flats = fallen(corners);
        for (std::size_t i = 0; i < flats.count; ++i) {
            if (is_beside(flats.part[i].at, 0)) continue;
            const Way of_part = way_of(corners.end, level);
            if (of_part != Way::kStopped) parts.flat.push_back({corners, flats.part[i], index, of_part});
        }
    }

    bool is_off(const BeamEnds& end, const BeamEnds& middle, const std::array<Vec2, 6>& at, double room) {
        static const std::array<QuarterMiddle, 9> places = quarter_middles();
        const std::array<BeamEnds, 4> quarter = quarters(end, middle);
        for (const QuarterMiddle& one : places) {
            const BeamEnd& exact = *middles(quarter[one.part])[one.middle];
            const std::optional<Vec2> there = place_on(plane, exact);
            if (!there) return true;
            const std::array<double, 6> weights = quadratic_weights(one.weights);
            Vec2 quadratic(0);
            for (std::size_t k = 0; k < 6; ++k) quadratic += weights[k] * at[k];
            if (length(*there - quadratic) > room) return true;
        }
        return false;
    }
};

PlaneBeams::Parts PlaneBeams::parts_of(const Target& target, Id beam) {
    const BeamCorners corners = corners_of(target.source.beams, target.source.beams.beams[beam]);
    const Way way = way_to(corners.end, target.plane, target.params.same_place);
    if (way == Way::kStopped) return {};
    PartsMaker maker{target.source, target.plane, target.params, target.half, target.progress, beam, way};
    maker.make();
    return std::move(maker.parts);
}

}  // namespace trilens
