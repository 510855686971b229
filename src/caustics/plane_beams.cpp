#include "caustics/plane_beams.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <map>
#include <memory>
#include <numeric>
#include <set>

#include "base/util/parallel.h"

namespace trilens {
namespace {

constexpr std::uint32_t kPerLeaf = 4;
/// Halvings of a beam's sides where its quadratic is wrong, and where there is none.
constexpr int kMostHalvings = 5, kMostCuts = 4;
/// A quadratic may be off by this share of the tolerance, and of a path that carries less than the brightest
/// by so much more of it.
constexpr double kMostOff = 0.25, kFaintOff = 0.05;
/// Beams that the plane cuts off are left flat, which loses some of their light, where it is this share of
/// what is faint.
constexpr double kFaintFlat = 0.05;
/// A beam whose sides are straight to so many times that needs no look at its quadratic.
constexpr double kNearlyStraight = 6;
/// A beam of one piece, and of four: how much its sides may bend, as a share of the tolerance, and its
/// quarters' areas and its light differ.
constexpr double kOneBends = 0.02, kOneDiffers = 0.03;
constexpr double kFourBend = 0.08, kFourDiffer = 0.12;

double sum_of(const Vec3& light) {
    return light.x + light.y + light.z;
}

/// Of a side's quarter points and of an inner side's middle: weights of the three ends.
struct QuarterMiddle {
    Vec3 weights;
    std::size_t part, middle;  // whose exact ray it is
};

/// The nine places at which a beam's four parts have exact rays that it has not.
std::array<QuarterMiddle, 9> quarter_middles() {
    const std::array<Vec3, 6> at{Vec3(1, 0, 0),     Vec3(0, 1, 0),     Vec3(0, 0, 1),
                                 Vec3(0, 0.5, 0.5), Vec3(0.5, 0, 0.5), Vec3(0.5, 0.5, 0)};
    const std::size_t ends[3][3] = {{0, 5, 4}, {5, 1, 3}, {4, 3, 2}};
    std::array<QuarterMiddle, 9> all;
    for (std::size_t part = 0; part < 3; ++part)
        for (std::size_t k = 0; k < 3; ++k)
            all[3 * part + k] = {0.5 * (at[ends[part][(k + 1) % 3]] + at[ends[part][(k + 2) % 3]]), part, k};
    return all;
}

ReceiverPlane plane_of(const ReceiverFace& face, const Vec3& normal) {
    Receiver receiver;
    receiver.point = face.center;
    receiver.normal = normal;
    ReceiverPlane plane(receiver, 0);
    plane.dual_s = face.along, plane.dual_t = cross(normal, face.along);
    return plane;
}

}  // namespace

Way way_to(const Beams& beams, const LightBeam& beam, const ReceiverPlane& plane, double same_place) {
    int free = 0, stopped = 0;
    for (const Id e : beam.end) {
        const BeamEnd& end = beams.ends[e];
        const double fall = -dot(end.direction, plane.normal);
        const double t = dot(end.origin - plane.point, plane.normal) / fall;
        if (!(fall > 0)) return Way::kUnknown;
        if (std::fabs(end.object - t) <= same_place / fall) ++free;
        if (end.optic < t) ++stopped;
    }
    return free == 3 ? Way::kFree : stopped == 3 ? Way::kStopped : Way::kUnknown;
}

/// Of one beam: what it becomes. What it traces to divide the beam is forgotten but for what its parts need.
struct PlaneBeams::Maker {
    const Source& source;
    const ReceiverPlane& plane;
    const PlaneBeamsParams& params;
    const Progress& progress;
    const Vec2& half;  // of the rectangle around the face
    Id index;
    Way way;
    std::vector<Curved> curved;
    std::vector<Flat> flat;
    using Side = std::pair<const BeamEnd*, const BeamEnd*>;
    std::map<Side, std::unique_ptr<const BeamEnd>> traced;  // in the middles of parts' sides
    std::vector<std::unique_ptr<const BeamEnd>> ends;       // of those the ends of its parts

    void make() {
        const BeamEnds& end = corners_of(source.beams, source.beams.beams[index]).end;
        add(end, source.refined.side_middles(index), 0);
        std::set<const BeamEnd*> needed;
        for (const Curved& one : curved) needed.insert(one.corners.end.begin(), one.corners.end.end());
        for (const Flat& one : flat) needed.insert(one.corners.end.begin(), one.corners.end.end());
        for (auto& [side, middle] : traced)
            if (needed.contains(middle.get())) ends.push_back(std::move(middle));
        traced.clear();
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

    void add(const BeamEnds& end, const BeamEnds& middle, int level) {
        progress.stop_if_cancelled();
        const CurvedBeam beam{source.refined.corners(index, end), middle};
        const std::optional<std::array<Vec2, 6>> at = beam.fall(plane);
        if (!at) {
            if (level < kMostCuts && is_near(end) && !is_faint(beam.corners))
                return add_parts(end, middle, level);
            return add_flat(beam.corners);
        }
        const double bulge = bulge_on_plane(*at);
        if (is_beside(*at, 2 * bulge)) return;
        const double room = room_of(beam, *at);
        if (bulge > kNearlyStraight * room && level < kMostHalvings && is_off(end, middle, *at, room))
            return add_parts(end, middle, level);
        add_curved(beam, *at, bulge);
    }

    /// Whether the hull lies beside the face by more than `room`.
    template <std::size_t kCount>
    bool is_beside(const std::array<Vec2, kCount>& at, double room) const {
        Box2 box;
        for (const Vec2& one : at) box.include(one);
        return !box.meets({-half - room, half + room});
    }

    FallenBeams fallen(const BeamCorners& corners) const {
        return fall(corners, plane, std::max(half.x, half.y));
    }

    /// How far it may be off.
    double room_of(const CurvedBeam& beam, const std::array<Vec2, 6>& at) const {
        double strength = 0;
        for (std::size_t k = 0; k < 3; ++k)
            strength =
                std::max({strength, sum_of(beam.corners.end[k]->light), sum_of(beam.middle[k]->light)});
        const double area = 0.5 * std::fabs(cross_on_plane(at[1] - at[0], at[2] - at[0]));
        if (strength * beam.corners.measure < params.faint_light * area) return INFINITY;
        return params.tolerance * std::max(kMostOff, kFaintOff * params.brightest / strength);
    }

    /// How much its quarters' areas differ from a quarter, and its light from linear, as shares.
    static double unevenness(const FallenCurve& curve) {
        const auto& at = curve.at;
        const double all = cross_on_plane(at[1] - at[0], at[2] - at[0]);
        double most = 0;
        const std::size_t quarter[4][3] = {{0, 5, 4}, {5, 1, 3}, {4, 3, 2}, {3, 4, 5}};
        for (const auto& q : quarter) {
            const double area = cross_on_plane(at[q[1]] - at[q[0]], at[q[2]] - at[q[0]]);
            most = std::max(most, std::fabs(4 * area / all - 1));
        }
        double brightest = 0, bends = 0;
        for (std::size_t k = 0; k < 3; ++k) {
            const double a = sum_of(curve.light[(k + 1) % 3]), b = sum_of(curve.light[(k + 2) % 3]),
                         m = sum_of(curve.light[3 + k]);
            brightest = std::max({brightest, a, m}), bends = std::max(bends, std::fabs(m - 0.5 * (a + b)));
        }
        return brightest > 0 ? std::max(most, bends / brightest) : most;
    }

    int sides_of(const FallenCurve& curve, double bulge) const {
        const double uneven = unevenness(curve);
        if (bulge <= kOneBends * params.tolerance && uneven <= kOneDiffers) return 1;
        return bulge <= kFourBend * params.tolerance && uneven <= kFourDiffer ? 2 : 4;
    }

    void add_curved(const CurvedBeam& beam, const std::array<Vec2, 6>& at, double bulge) {
        Curved one{beam.corners, {at, beam.lights()}, index, way};
        one.sides = sides_of(one.curve, bulge);
        one.mean_light = mean_light(one.curve.light, one.sides);
        one.strips = strips_around(at);
        const LightBeam& of = source.beams.beams[index];
        one.is_plain = way == Way::kFree && source.beams.histories[of.history].medium == kNone;
        curved.push_back(one);
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
        for (const BeamEnd* end : corners.end) strength = std::max(strength, sum_of(end->light));
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

    void add_flat(const BeamCorners& corners) {
        const FallenBeams flats = fallen(corners);
        for (std::size_t i = 0; i < flats.count; ++i)
            if (!is_beside(flats.part[i].at, 0)) flat.push_back({corners, flats.part[i], index, way});
    }

    bool is_off(const BeamEnds& end, const BeamEnds& middle, const std::array<Vec2, 6>& at, double room) {
        static const std::array<QuarterMiddle, 9> places = quarter_middles();
        const std::array<BeamEnds, 4> parts = quarters(end, middle);
        for (const QuarterMiddle& one : places) {
            const BeamEnd& exact = *middles(parts[one.part])[one.middle];
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

PlaneBeams::PlaneBeams(const Source& source, const ReceiverFace& face, const Vec3& normal,
                       const PlaneBeamsParams& params, const Progress& progress)
    : plane_(plane_of(face, normal)) {
    std::vector<Id> near;
    source.tree.for_each_near(face.center, face.radius + params.reach,
                              [&](Id beam) { near.push_back(beam); });
    const Vec2 half = face.half + params.reach;
    struct Made {
        std::vector<Curved> curved;
        std::vector<Flat> flat;
        std::vector<std::unique_ptr<const BeamEnd>> ends;
    };
    std::vector<Made> made(near.size());
    LoopProgress done(progress, static_cast<double>(near.size()));
    parallel_for(near.size(), 32, [&](std::size_t from, std::size_t to) {
        for (std::size_t i = from; i < to; ++i) {
            const LightBeam& beam = source.beams.beams[near[i]];
            const Way way = way_to(source.beams, beam, plane_, params.same_place);
            if (way == Way::kStopped) continue;
            Maker maker{source, plane_, params, progress, half, near[i], way, {}, {}, {}, {}};
            maker.make();
            made[i] = {std::move(maker.curved), std::move(maker.flat), std::move(maker.ends)};
        }
        done.add(static_cast<double>(to - from));
    });
    for (Made& one : made) {
        std::move(one.ends.begin(), one.ends.end(), std::back_inserter(ends_));
        curved_.insert(curved_.end(), one.curved.begin(), one.curved.end());
        flat_.insert(flat_.end(), one.flat.begin(), one.flat.end());
    }
    order_.resize(curved_.size() + flat_.size());
    std::iota(order_.begin(), order_.end(), std::uint32_t{0});
    for (const std::uint32_t entry : order_) boxes_.push_back(box_of(entry));
    if (!order_.empty()) build(0, static_cast<std::uint32_t>(order_.size()));
    std::vector<Box2> in_order;
    in_order.reserve(order_.size());
    for (const std::uint32_t entry : order_) in_order.push_back(boxes_[entry]);
    boxes_ = std::move(in_order);
}

PlaneBeams::Box2 PlaneBeams::hull_box(const std::array<Vec2, 6>& at) {
    Box2 box;
    for (const Vec2& point : bezier_points(at)) box.include(point);
    return box;
}

std::array<Vec2, 6> PlaneBeams::fallen_on(const Curved& one, const Map& map) {
    std::array<Vec2, 6> at;
    for (std::size_t k = 0; k < 6; ++k) at[k] = map(one.curve.at[k]);
    return at;
}

bool PlaneBeams::is_inside(const std::array<Vec2, 6>& at) {
    const Box2 box = hull_box(at);
    return std::max({-box.low.x, -box.low.y, box.high.x, box.high.y}) <= 0.5;
}

/// Those of its sides' directions that its Bezier points lie in: they part it from what is beside (separating
/// axes).
std::array<PlaneBeams::Strip, 3> PlaneBeams::strips_around(const std::array<Vec2, 6>& at) {
    const std::array<Vec2, 6> hull = bezier_points(at);
    std::array<Strip, 3> strips;
    for (std::size_t k = 0; k < 3; ++k) {
        const Vec2 side = hull[(k + 1) % 3] - hull[k];
        const Vec2 normal(-side.y, side.x);
        strips[k] = {normal, INFINITY, -INFINITY};
        for (const Vec2& point : hull) {
            strips[k].low = std::min(strips[k].low, dot(normal, point));
            strips[k].high = std::max(strips[k].high, dot(normal, point));
        }
    }
    return strips;
}

/// All that comes to the footprint, times its part of the film.
Vec3 PlaneBeams::light_of(const Curved& one, const std::array<Vec2, 6>& at) {
    const double measure = one.corners.measure;
    if (is_inside(at)) return measure * one.mean_light;
    const PieceGrid& grid = PieceGrid::of(one.sides);
    CutPieces cut;
    cut_pieces(at, one.sides, cut);
    std::array<double, 6> weights{};  // of the light at the beam's ends and middles
    for (std::size_t p = 0; p < grid.pieces; ++p) {
        if (!(cut.share[p] > 0)) continue;
        for (std::size_t k = 0; k < 3; ++k) {
            const double weight = cut.share[p] * cut.weight[k][p];
            const std::array<double, 6>& quadratic = grid.quadratic[grid.piece[p][k]];
            for (std::size_t c = 0; c < 6; ++c) weights[c] += weight * quadratic[c];
        }
    }
    Vec3 light(0);
    for (std::size_t c = 0; c < 6; ++c) light += weights[c] * one.curve.light[c];
    return measure / static_cast<double>(grid.pieces) * light;
}

PlaneBeams::Box2 PlaneBeams::box_of(std::uint32_t entry) const {
    if (entry < curved_.size()) return hull_box(curved_[entry].curve.at);
    Box2 box;
    for (const Vec2& at : flat_[entry - curved_.size()].fallen.at) box.include(at);
    return box;
}

PlaneBeams::Map PlaneBeams::map_to(const ReceiverPlane& footprint) const {
    Map map;
    map.origin = footprint.at(plane_.point);
    map.turn = Mat2(Vec2(dot(plane_.dual_s, footprint.dual_s), dot(plane_.dual_s, footprint.dual_t)),
                    Vec2(dot(plane_.dual_t, footprint.dual_s), dot(plane_.dual_t, footprint.dual_t)));
    return map;
}

PlaneBeams::Parallelogram PlaneBeams::parallelogram_of(const ReceiverPlane& footprint, const Map& map) {
    const Mat2 back = glm::inverse(map.turn);
    return {-(back * map.origin), footprint.has_footprint ? 0.5 * back : Mat2(0)};
}

PlaneBeams::Box2 PlaneBeams::box_of(const Parallelogram& footprint) {
    const Vec2 half = glm::abs(footprint.half[0]) + glm::abs(footprint.half[1]);
    return {footprint.middle - half, footprint.middle + half};
}

void PlaneBeams::build(std::uint32_t first, std::uint32_t end) {
    const auto at = static_cast<std::uint32_t>(nodes_.size());
    nodes_.emplace_back();
    Node node;
    Box2 middles;
    const auto middle_of = [&](std::uint32_t entry) { return boxes_[entry].low + boxes_[entry].high; };
    for (std::uint32_t i = first; i < end; ++i) {
        node.box.include(boxes_[order_[i]].low), node.box.include(boxes_[order_[i]].high);
        middles.include(middle_of(order_[i]));
    }
    if (end - first <= kPerLeaf) {
        node.first = first, node.end = end;
    } else {
        const Vec2 wide = middles.high - middles.low;
        const int k = wide.x > wide.y ? 0 : 1;
        const std::uint32_t middle = first + (end - first) / 2;
        std::nth_element(order_.begin() + first, order_.begin() + middle, order_.begin() + end,
                         [&](std::uint32_t a, std::uint32_t b) {
                             const double of_a = middle_of(a)[k], of_b = middle_of(b)[k];
                             return of_a != of_b ? of_a < of_b : a < b;
                         });
        build(first, middle);
        build(middle, end);
    }
    node.skip = static_cast<std::uint32_t>(nodes_.size());
    nodes_[at] = node;
}

}  // namespace trilens
