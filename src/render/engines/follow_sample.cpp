#include "render/engines/follow_sample.h"

#include <algorithm>
#include <cmath>

#include "render/world/geometry.h"

namespace trilens {
namespace {

/// The steps from the first optic to this segment.
void append_steps(const std::vector<PathSegment>& segments, Id last, std::vector<Step>& steps) {
    const std::size_t first = steps.size();
    for (Id s = last; s != kNone; s = segments[s].parent) steps.push_back(segments[s].step);
    std::reverse(steps.begin() + static_cast<std::ptrdiff_t>(first), steps.end());
}

}  // namespace

void follow_sample(const World& world, const FirstHit& first, const SampleView& view,
                   const SamplePaths& found) {
    auto& [on_optic, ends, steps] = found;
    const SurfaceHit& hit = first.at;
    const PathWorld& paths = path_world(world);
    const double cosine = dot(normalize_or_zero(view.ray.direction), hit.point.normal);
    on_optic.incidence = {std::min(1.0, std::fabs(cosine)), cosine <= 0};
    const double eye = hit.t * length(view.ray.direction);
    on_optic.way = eye;
    const Meeting meeting{view.optic, normalize_or_zero(view.ray.direction), hit.point.position,
                          hit.point.normal, on_optic.incidence.front};
    const FollowedPaths followed =
        follow_paths(paths, {meeting, eye, first.around}, {.objects = &object_tracer(world)});
    for (std::size_t i = 0; i < followed.segments.size(); ++i) {
        const PathSegment& segment = followed.segments[i];
        if (!segment.ends) continue;
        PathEnd end;
        end.path = segment.path;
        end.principal = segment.principal;
        end.colours = segment.colours;
        end.first_step = steps.size();
        append_steps(followed.segments, static_cast<Id>(i), steps);
        end.step_count = static_cast<std::uint16_t>(steps.size() - end.first_step);
        end.medium = segment.medium;
        end.weight = segment.weight;
        end.ray = {segment.ray.origin, eye * segment.ray.direction};
        end.hit = segment.hit;
        end.hit.t /= eye;
        ends.push_back(end);
    }
    on_optic.cut = followed.cut;
}

}  // namespace trilens
