#include "caustics/beams/light_paths.h"

#include <algorithm>
#include <cmath>

namespace trilens {
namespace {

/// Less of a ray's light than this is not followed, but on the principal path.
constexpr double kLeastLight = 1.0 / 200;

/// A part of a path in one medium.
struct Stretch {
    const Ray& ray;
    double length = 0;
    bool has_start = true, has_end = true;  // what lies where it starts is on it, and where it ends
};

/// Takes from light what blended surfaces on a stretch keep, and adds them to `veils`.
void come_through(const LightSpace& space, const Stretch& stretch, Vec3& light,
                  std::vector<VeilSurface>& veils) {
    if (!space.veil) return;
    const auto& [origin, direction] = stretch.ray;
    const Vec3 end = origin + stretch.length * direction;
    // A segment takes in what is at its ends.
    const double after = stretch.has_start ? 0 : 2 * same_place(origin),
                 before = stretch.has_end ? 0 : 2 * same_place(end);
    if (after + before > stretch.length) return;
    const Veil veil = space.veil({end - before * direction, -(stretch.length - before - after) * direction});
    light *= veil.through;
    veils.insert(veils.end(), veil.surfaces.begin(), veil.surfaces.end());
}

/// The path that goes on by a segment; its light is not known yet.
LightPath continued(LightHistory so_far, const PathSegment& segment, const Vec3& arriving) {
    LightPath path;
    static_cast<LightHistory&>(path) = std::move(so_far);
    path.steps.push_back(segment.step);
    path.colours = segment.colours;
    path.medium = segment.medium;
    path.has_start = segment.has_start;
    path.ray = segment.ray;
    path.arriving = arriving;
    if (path.colours != kAllColours) {
        path.arriving = Vec3(0);
        path.arriving[path.colours] = arriving[path.colours];
    }
    // Light that comes to an optic after the last that is followed stops there.
    path.optic = std::min(segment.next, segment.cut);
    if (segment.hit.seen() && !std::isfinite(segment.cut)) path.object = segment.hit.t;
    return path;
}

}  // namespace

LightPaths light_paths(const LightSpace& space, const BeamSource& source, const Ray& ray, Id first,
                       std::span<const std::vector<Step>* const> only) {
    LightPaths found;
    const PathWorld& world = *space.optics;
    const Media around = space.around ? space.around(ray) : Media{};
    const std::optional<NextOptic> met = next_optic(world, {ray, kNone, around});
    if (!met || met->meeting.optic != first) return found;
    if (space.objects->occluded(ray, 0, met->distance - met->touch)) return found;

    FollowParams params;
    params.objects = space.objects;
    params.least_weight = kLeastLight;
    params.only = only;
    FollowedPaths followed = follow_paths(world, {met->meeting, met->distance, around}, params);
    found.cut = followed.cut;
    const Id medium = active_medium(world, around);
    Vec3 arriving = source.strength(ray.direction) * body_transmittance(world, medium, met->distance);
    std::vector<VeilSurface> first_veils;
    const bool in_air = medium == kNone;
    come_through(space, {ray, met->distance, in_air, in_air || world.optics[first].mirror}, arriving,
                 first_veils);
    std::vector<Vec3> carried;  // per segment: its share at the first optic, less what veils behind it keep
    for (const PathSegment& segment : followed.segments) {
        LightHistory so_far;
        if (segment.parent == kNone) {
            so_far.veils = first_veils;
            carried.push_back(segment.first_weight);
        } else {
            const PathSegment& before = followed.segments[segment.parent];
            so_far = found.paths[segment.parent];
            carried.push_back(carried[segment.parent]);
            const bool has_end = before.medium == kNone || before.to_mirror;
            come_through(space, {before.ray, before.next, before.has_start, has_end}, carried.back(),
                         so_far.veils);
        }
        found.paths.push_back(continued(std::move(so_far), segment, arriving));
        found.paths.back().light = arriving * carried.back() * segment.weight;
    }
    return found;
}

namespace {

/// The way of a step that this colour takes; null: there is none.
const Branch* branch_of(const Branches& ways, const Step& step, Colours colours) {
    for (const Branch& way : ways)
        if (way.step == step && (way.colours == kAllColours || way.colours == colours)) return &way;
    return nullptr;
}

}  // namespace

std::optional<SinglePath> follow_history(const LightSpace& space, const BeamSource& source, const Ray& ray,
                                         const LightHistory& like) {
    const PathWorld& world = *space.optics;
    LeavingRay leaving{ray, kNone, space.around ? space.around(ray) : Media{}};
    SinglePath single;
    LightPath& path = single.path;
    path.light = source.strength(ray.direction);
    path.medium = active_medium(world, leaving.media);
    path.has_start = path.medium == kNone;
    for (const Step& step : like.steps) {
        const std::optional<NextOptic> met = next_optic(world, leaving);
        if (!met || met->meeting.optic != step.optic) return std::nullopt;
        path.light *= body_transmittance(world, path.medium, met->distance);
        const bool has_end = path.medium == kNone || world.optics[step.optic].mirror;
        come_through(space, {leaving.ray, met->distance, path.has_start, has_end}, path.light, path.veils);
        if (path.steps.empty()) path.arriving = path.light;
        const Branches ways = branches(world, met->meeting, leaving.media, path.colours);
        const Branch* way = branch_of(ways, step, like.colours);
        if (!way) return std::nullopt;
        path.steps.push_back(step);
        path.colours = way->colours;
        path.light *= way->weight;
        single.corners.push_back(met->meeting.point);
        leaving = {{met->meeting.point, way->direction}, step.optic, way->media};
        const LegBefore before{path.medium, met->distance, met->meeting.point, path.has_start};
        path.medium = active_medium(world, leaving.media);
        path.has_start = has_start(world, step, path.medium, before);
    }
    path.ray = leaving.ray;
    single.media = leaving.media;
    if (path.history() != like) return std::nullopt;
    return single;
}

bool is_free(const LightSpace& space, const Ray& ray, const SinglePath& single) {
    Vec3 from = ray.origin;
    Segments ways;
    for (const Vec3& to : single.corners) {
        ways.add(to, (1 - kSamePlace) * (from - to));
        if (ways.count == Segments::kMost) {
            if (space.objects->occluded(ways)) return false;
            ways.count = 0;
        }
        from = to;
    }
    return ways.count == 0 || !space.objects->occluded(ways);
}

}  // namespace trilens
