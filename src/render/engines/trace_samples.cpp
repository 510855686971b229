#include "render/engines/path_ends.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "base/util/parallel.h"
#include "render/world/world.h"

namespace trilens {

FirstSurface first_surface(const PathWorld& world, const Tracer& objects, const Ray& ray, double reach) {
    FirstSurface first;
    first.object = objects.first_hit(ray);
    if (first.object.seen() && first.object.t > reach) first.object = {};
    const auto turn = [&](std::size_t optic, const SurfaceHit& hit) {
        return coincident_order(world.optics[optic], dot(hit.point.normal, ray.direction) <= 0);
    };
    const auto comes_first = [&](std::size_t optic, const SurfaceHit& hit) {
        if (first.optic == kNone) return true;
        const double touch = world.optics[optic].tracer->self_hit_t_min(ray);
        if (std::fabs(hit.t - first.at.t) > touch) return hit.t < first.at.t;
        return turn(optic, hit) < turn(first.optic, first.at);
    };
    for (std::size_t i = 0; i < world.optics.size(); ++i) {
        const PathOptic& optic = world.optics[i];
        const std::optional<SurfaceHit> hit = optic.tracer->first_hit(ray);
        if (!hit || hit->t > reach || (first.object.seen() && hit->t >= first.object.t)) continue;
        const bool leaves = !optic.mirror && dot(hit->point.normal, ray.direction) > 0;
        const bool rests =
            first.object.seen() && first.object.t <= hit->t + optic.tracer->self_hit_t_min(ray);
        if ((leaves && rests) || !comes_first(i, *hit)) continue;
        first.optic = static_cast<Id>(i);
        first.at = *hit;
    }
    if (first.optic != kNone) first.object = {};
    return first;
}

namespace {

constexpr std::size_t kTracedPerTask = 256;

/// Where the camera's ray passes the exact surface by, at the rim of a facet: no optic, and what is behind.
void see_past(const TraceSamplesParams& params, SampleView& view) {
    view.optic = view.facet = kNone;
    view.traced = false;
    view.hit = object_tracer(params.world).first_hit(view.ray);
    if (view.hit.seen() && view.hit.t > params.reach) view.hit = {};
    view.depth = view.hit.seen() ? view.hit.t : SampleView().depth;
}

/// The ray of a sample that is traced: of a camera that is not linear its exact one, not its facets'.
Ray traced_ray(const PathCamera& camera, const Vec2& pixel, const Ray& of_facets) {
    if (!camera.affine) return of_facets;
    const Ray exact = camera.ray({pixel, 1}, of_facets.origin + of_facets.direction);
    return exact.direction == Vec3(0) ? of_facets : exact;
}

}  // namespace

void trace_samples(const TraceSamplesParams& params, std::span<const TracedSample> samples,
                   SampleViews& views, PathEnds& out) {
    const PathWorld& world = path_world(params.world);
    std::vector<PathEnds> found((samples.size() + kTracedPerTask - 1) / kTracedPerTask);
    parallel_for(found.size(), 1, [&](std::size_t from, std::size_t to) {
        FollowedPaths followed;
        for (std::size_t task = from; task < to; ++task) {
            PathEnds& own = found[task];
            const std::size_t last = std::min(samples.size(), (task + 1) * kTracedPerTask);
            for (std::size_t i = task * kTracedPerTask; i < last; ++i) {
                const Id sample = samples[i].sample;
                SampleView& view = views.samples[sample];
                OpticView& on_optic = views.on_optic(view);
                view.traced = true;
                const Ray of_facets = view.ray;
                view.ray = traced_ray(params.camera, params.grid.position(sample), of_facets);
                const auto hit =
                    samples[i].met ? samples[i].met : world.optics[params.optic].tracer->first_hit(view.ray);
                if (!hit) {
                    see_past(params, view);
                    continue;
                }
                follow_sample(
                    params.world, {*hit, views.around_of(view)}, view,
                    {on_optic, own.ends, own.steps, followed,
                     params.volumes ? &views.volumes[sample] : nullptr});
                view.ray = of_facets;
                view.depth = hit->t;
                own.sample.resize(own.ends.size(), sample);
            }
        }
    });
    for (PathEnds& own : found) {
        for (PathEnd& end : own.ends) end.first_step += out.steps.size();
        out.ends.insert(out.ends.end(), own.ends.begin(), own.ends.end());
        out.sample.insert(out.sample.end(), own.sample.begin(), own.sample.end());
        out.steps.insert(out.steps.end(), own.steps.begin(), own.steps.end());
    }
}

namespace {

/// The steps from the first optic to this segment.
void append_steps(const std::vector<PathSegment>& segments, Id last, std::vector<Step>& steps) {
    const std::size_t first = steps.size();
    for (Id s = last; s != kNone; s = segments[s].parent) steps.push_back(segments[s].step);
    std::reverse(steps.begin() + static_cast<std::ptrdiff_t>(first), steps.end());
}

}  // namespace

namespace {

/// Adds the emission along each segment; the transmittance up to the end of each.
std::vector<double> add_volumes(const World& world, const std::vector<PathSegment>& segments,
                                SampleVolumes& found) {
    std::vector<double> through(segments.size(), 1.0);
    for (std::size_t i = 0; i < segments.size(); ++i) {
        const PathSegment& segment = segments[i];
        if (segment.parent != kNone) through[i] = through[segment.parent];
        const VolumeLight light = trace_layers(world, segment);
        (segment.path == Path::kReflect ? found.reflect : found.refract) +=
            through[i] * segment.weight * light.emission;
        through[i] *= light.transmittance;
    }
    return through;
}

}  // namespace

void follow_sample(const World& world, const FirstOpticHit& first, const SampleView& view,
                   const SamplePaths& found) {
    auto& [on_optic, ends, steps, followed, volumes] = found;
    const SurfaceHit& hit = first.at;
    const PathWorld& paths = path_world(world);
    const double cosine = dot(normalize_or_zero(view.ray.direction), hit.point.normal);
    on_optic.incidence = {std::min(1.0, std::fabs(cosine)), cosine <= 0};
    const double eye = hit.t * length(view.ray.direction);
    on_optic.way = eye;
    const Meeting meeting{view.optic, normalize_or_zero(view.ray.direction), hit.point.position,
                          hit.point.normal, on_optic.incidence.front};
    follow_paths(paths, {meeting, eye, first.around}, {.objects = &object_tracer(world)}, followed);
    std::vector<double> through;
    if (volumes) through = add_volumes(world, followed.segments, *volumes);
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
        end.weight = volumes ? through[i] * segment.weight : segment.weight;
        end.ray = {segment.ray.origin, eye * segment.ray.direction};
        end.hit = segment.hit;
        end.hit.t /= eye;
        ends.push_back(end);
    }
    on_optic.cut = followed.cut;
    on_optic.deep = followed.cut.too_deep;
}

}  // namespace trilens
