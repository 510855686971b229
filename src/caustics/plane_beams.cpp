#include "caustics/plane_beams.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <memory>
#include <optional>
#include <span>

#include "base/util/parallel.h"
#include "caustics/beams/quadratic.h"

namespace trilens {
namespace {

/// Light is looked at no closer than this share of what the light's mean over the scene asks.
constexpr double kLeastOnFace = 0.01;

ReceiverPlane plane_of(const ReceiverFace& face, const Vec3& normal) {
    Receiver receiver;
    receiver.point = face.center;
    receiver.normal = normal;
    ReceiverPlane plane(receiver, 0);
    plane.dual_s = face.along, plane.dual_t = cross(normal, face.along);
    return plane;
}

/// The light that beams bring to a face, as the rays at their ends have it.
struct FaceLight {
    double mean = 0;       // irradiance, the sum of its colours; 0: no ray at an end falls there
    double brightest = 0;  // path: the sum of its colours
};

FaceLight light_on(const Beams& beams, std::span<const Id> near, const ReceiverPlane& plane,
                   const Vec2& half) {
    FaceLight light;
    for (const Id beam : near)
        for (const Id e : beams.beams[beam].end) {
            const BeamEnd& end = beams.ends[e];
            const std::optional<Vec2> at = place_on(plane, end);
            if (!at || !(std::fabs(at->x) <= half.x && std::fabs(at->y) <= half.y)) continue;
            const double strength = strength_of(end.light);
            light.mean += beams.beams[beam].measure / 3 * strength;
            light.brightest = std::max(light.brightest, strength);
        }
    light.mean /= 4 * half.x * half.y;
    return light;
}

/// Where little light comes to a face, but no other, that is what is looked at there.
PlaneBeamsParams params_on_face(PlaneBeamsParams params, const FaceLight& light) {
    if (!params.is_alone || light.mean == 0) return params;
    params.brightest = light.brightest;
    params.faint_light =
        std::clamp(kFaintShare * light.mean, kLeastOnFace * params.faint_light, params.faint_light);
    return params;
}

}  // namespace

Way way_to(const BeamEnds& ends, const ReceiverPlane& plane, double same_place) {
    int free = 0, there = 0, stopped = 0;
    for (const BeamEnd* end : ends) {
        const double fall = -dot(end->direction, plane.normal);
        const double t = dot(end->origin - plane.point, plane.normal) / fall;
        if (!(fall > 0)) return Way::kUnknown;
        const double near = same_place / fall;
        if (end->object > 0 && end->object >= t - near && end->optic >= t - near) ++free;
        if (std::fabs(end->object - t) <= near) ++there;
        if (end->optic < t) ++stopped;
    }
    // Where no ray meets what lies in the plane, an object that all go past may hide its own back.
    return free == 3 && there > 0 ? Way::kFree : stopped == 3 ? Way::kStopped : Way::kUnknown;
}

PlaneBeams::PlaneBeams(const Source& source, const ReceiverFace& face, const Vec3& normal,
                       const PlaneBeamsParams& params, const Progress& progress)
    : plane_(plane_of(face, normal)) {
    std::vector<Id> near;
    source.tree.for_each_near(face.center, face.radius + params.reach,
                              [&](Id beam) { near.push_back(beam); });
    const Vec2 half = face.half + params.reach;
    const PlaneBeamsParams own = params_on_face(params, light_on(source.beams, near, plane_, half));
    const Target target{source, plane_, own, half, progress};
    std::vector<Parts> made(near.size());
    LoopProgress done(progress, static_cast<double>(near.size()));
    parallel_for(near.size(), 32, [&](std::size_t from, std::size_t to) {
        for (std::size_t i = from; i < to; ++i) made[i] = parts_of(target, near[i]);
        done.add(static_cast<double>(to - from));
    });
    for (Parts& one : made) {
        std::move(one.ends.begin(), one.ends.end(), std::back_inserter(ends_));
        curved_.insert(curved_.end(), one.curved.begin(), one.curved.end());
        flat_.insert(flat_.end(), one.flat.begin(), one.flat.end());
    }
    std::vector<PlaneBounds> bounds;
    bounds.reserve(curved_.size() + flat_.size());
    for (const Curved& one : curved_) bounds.push_back(PlaneBounds::of(bezier_points(one.curve.at)));
    for (const Flat& one : flat_) bounds.push_back(PlaneBounds::of(one.fallen.at));
    tree_ = PlaneTree(std::move(bounds), {-half, half});
}

std::array<Vec2, 6> PlaneBeams::fallen_on(const Curved& one, const Map& map) {
    std::array<Vec2, 6> at;
    for (std::size_t k = 0; k < 6; ++k) at[k] = map(one.curve.at[k]);
    return at;
}

bool PlaneBeams::is_inside(const std::array<Vec2, 6>& at) {
    PlaneBox box;
    for (const Vec2& point : bezier_points(at)) box.include(point);
    return std::max({-box.low.x, -box.low.y, box.high.x, box.high.y}) <= 0.5;
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
            const double weight = cut.share[p] * one.part_of(p) * cut.weight[k][p];
            const std::array<double, 6>& quadratic = grid.quadratic[grid.piece[p][k]];
            for (std::size_t c = 0; c < 6; ++c) weights[c] += weight * quadratic[c];
        }
    }
    Vec3 light(0);
    for (std::size_t c = 0; c < 6; ++c) light += weights[c] * one.spread[c];
    return measure / static_cast<double>(grid.pieces) * light;
}

PlaneBeams::Map PlaneBeams::map_to(const ReceiverPlane& footprint) const {
    Map map;
    map.origin = footprint.at(plane_.point);
    map.turn = Mat2(Vec2(dot(plane_.dual_s, footprint.dual_s), dot(plane_.dual_s, footprint.dual_t)),
                    Vec2(dot(plane_.dual_t, footprint.dual_s), dot(plane_.dual_t, footprint.dual_t)));
    return map;
}

PlaneParallelogram PlaneBeams::parallelogram_of(const ReceiverPlane& footprint, const Map& map) {
    const Mat2 back = glm::inverse(map.turn);
    return {-(back * map.origin), footprint.has_footprint ? 0.5 * back : Mat2(0)};
}

}  // namespace trilens
