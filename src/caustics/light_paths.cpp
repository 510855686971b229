#include "caustics/light_paths.h"

namespace trilens {
namespace {

/// Less of a ray's light than this is not followed, but on the principal path.
constexpr double kLeastLight = 1.0 / 200;

/// The share of the light that takes the way of this segment at the first optic.
Vec3 share_at_first(const std::vector<Branch>& ways, const PathSegment& segment) {
    for (const Branch& way : ways)
        if (way.step == segment.step && way.colours == segment.colours) return way.weight;
    return Vec3(0);
}

}  // namespace

LightPaths light_paths(const LightSpace& space, const BeamSource& source, const Ray& ray, Id first) {
    LightPaths found;
    const PathWorld& world = *space.optics;
    const Media around = space.around ? space.around(ray) : Media{};
    const std::optional<NextOptic> met = next_optic(world, {ray, kNone, around});
    if (!met || met->meeting.optic != first) return found;
    if (space.objects->occluded(ray, 0, met->distance - met->touch)) return found;

    FollowParams params;
    params.objects = space.objects;
    params.least_weight = kLeastLight;
    FollowedPaths followed = follow_paths(world, {met->meeting, met->distance, around}, params);
    found.cut = followed.cut;
    const std::vector<Branch> ways = branches(world, met->meeting, around, kAllColours);
    const Vec3 arriving = source.strength(ray.direction) *
                          body_transmittance(world, active_medium(world, around), met->distance);
    std::vector<Vec3> share;  // at the first optic, per segment
    for (const PathSegment& segment : followed.segments) {
        LightPath path;
        if (segment.parent != kNone) path.steps = found.paths[segment.parent].steps;
        path.steps.push_back(segment.step);
        share.push_back(segment.parent == kNone ? share_at_first(ways, segment) : share[segment.parent]);
        path.colours = segment.colours;
        path.medium = segment.medium;
        path.ray = segment.ray;
        path.light = arriving * share.back() * segment.weight;
        path.arriving = arriving;
        if (path.colours != kAllColours) {
            path.arriving = Vec3(0);
            path.arriving[path.colours] = arriving[path.colours];
        }
        path.optic = segment.next;
        if (segment.hit.seen()) path.object = segment.hit.t;
        found.paths.push_back(std::move(path));
    }
    return found;
}

}  // namespace trilens
