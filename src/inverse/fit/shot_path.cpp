#include "inverse/fit/fit_problem.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/util/error.h"
#include "paths/trace/path_world.h"
#include "reflect/reflection.h"
#include "refract/refraction.h"

namespace trilens {
namespace {

constexpr std::size_t kMostEvents = 64;

struct OpticMeeting {
    std::size_t optic = 0;
    SurfaceHit hit;
    double t = std::numeric_limits<double>::infinity();
};

/// The first optic on the ray, but for where it starts on optic `from`.
std::optional<OpticMeeting> meet(const FitScene& scene, const Ray& ray, std::size_t from) {
    OpticMeeting first;
    for (std::size_t i = 0; i < scene.optics.size(); ++i) {
        const FitOptic& optic = scene.optics[i];
        const Ray own = unmoved_ray(optic, ray);  // an affine map keeps t
        const std::optional<SurfaceHit> hit =
            optic.tracer->first_hit(own, i == from ? optic.tracer->self_hit_t_min(own) : 0);
        if (hit && hit->t < first.t) first = {i, *hit, hit->t};
    }
    return std::isfinite(first.t) ? std::optional(first) : std::nullopt;
}

OpticEvent event_at(const FitScene& scene, const OpticMeeting& met) {
    OpticEvent event;
    event.optic = met.optic;
    event.face = met.hit.face;
    event.uv = met.hit.uv;
    const FitOptic& optic = scene.optics[met.optic];
    event.as_built = optic.surface->eval(met.hit.face, met.hit.uv);
    if (event.as_built.normal == Vec3(0)) event.as_built.normal = met.hit.point.normal;
    event.point = moved_point(optic, event.as_built);
    return event;
}

}  // namespace

Ray unmoved_ray(const FitOptic& optic, const Ray& ray) {
    if (!optic.is_moved) return ray;
    return {map_point(optic.unmoved, ray.origin), optic.unmoved.linear * ray.direction};
}

void check_path_word(const PathWord& word) {
    if (word == "D") return;
    if (word.find_first_not_of("RT?") != std::string::npos || word.size() > kMostEvents)
        throw UsageError("a path is D, or up to 64 letters R, T and ?, not \"" + word + "\"");
}

double index_of(const FitScene& scene, Id medium) {
    return medium == kNone ? 1 : scene.optics[medium].ior;
}

std::optional<ShotPath> shoot_path(const FitScene& scene, std::size_t camera, const Vec2& pixel,
                                   const PathWord& word) {
    const std::optional<Ray> from = exact_ray(scene.cameras[camera], pixel);
    if (!from) return std::nullopt;
    ShotPath path;
    path.view = {from->origin, normalize(from->direction)};
    Ray ray = path.view;
    Media media = scene.media[camera].of(path.view);
    std::size_t on = scene.optics.size();
    const auto priority = [&](Id optic) { return scene.optics[optic].priority; };
    for (std::size_t meetings = 0; meetings < kMostEvents; ++meetings) {
        path.after.push_back(ray);
        const bool is_done = word == "D" || (!word.empty() && path.events.size() == word.size());
        const std::optional<OpticMeeting> met = meet(scene, ray, on);
        path.reach.push_back(met ? met->t : std::numeric_limits<double>::infinity());
        if (is_done || !met) break;

        OpticEvent event = event_at(scene, *met);
        const FitOptic& optic = scene.optics[event.optic];
        on = event.optic;
        const bool front = dot(ray.direction, event.point.normal) <= 0;
        const Vec3 facing = front ? event.point.normal : -event.point.normal;
        const char letter = word.empty() ? '?' : word[path.events.size()];
        if (optic.mirror) {
            if (letter == 'T') return std::nullopt;
            event.before = event.after = media.active(priority);
            ray = {event.point.position, mirrored(ray.direction, facing)};
        } else {
            const std::optional<MediaSides> sides = sides_of(media, static_cast<Id>(event.optic), front);
            if (!sides) return std::nullopt;
            event.before = sides->before.active(priority), event.after = sides->after.active(priority);
            if (event.before == event.after) {  // no interface: straight on
                media = sides->after;
                ray.origin = event.point.position;
                path.after.pop_back(), path.reach.pop_back();
                continue;
            }
            const std::optional<Vec3> through =
                letter == 'R' ? std::nullopt
                              : refracted(ray.direction, facing,
                                          index_of(scene, event.before) / index_of(scene, event.after));
            if (!through && letter == 'T') return std::nullopt;
            event.reflects = !through.has_value();
            if (event.reflects) event.after = event.before;
            media = event.reflects ? sides->before : sides->after;
            ray = {event.point.position, through ? normalize(*through) : mirrored(ray.direction, facing)};
        }
        path.events.push_back(std::move(event));
    }
    if (!word.empty() && word != "D" && path.events.size() < word.size()) return std::nullopt;
    if (path.after.size() <= path.events.size()) return std::nullopt;  // endless
    path.last = path.after.back();
    return path;
}

void cut_path(ShotPath& path, std::size_t count) {
    path.events.resize(count);
    path.after.resize(count + 1), path.reach.resize(count + 1);
    path.last = path.after.back();
}

Vec3 nearest_on_last(const ShotPath& path, const Vec3& point) {
    const double along = dot(point - path.last.origin, path.last.direction);
    const double least = 1e-6 * length(point - path.last.origin);
    return path.last.origin + std::max(along, least) * path.last.direction;
}

std::size_t events_towards(const ShotPath& path, const Vec3& point) {
    std::size_t best = path.events.size();
    double nearest = std::numeric_limits<double>::infinity();
    for (std::size_t k = 1; k <= path.events.size(); ++k) {
        const Id within = path.events[k - 1].after;
        if (k < path.events.size() && within != kNone && within != path.events[0].before) continue;
        const Ray& ray = path.after[k];
        const Vec3 towards = point - ray.origin;
        const double along = dot(towards, ray.direction);
        if (!(along > 0) || along > path.reach[k] * (1 + 1e-3)) continue;
        const double off = length(towards - along * ray.direction) / length(towards);
        if (off < nearest) nearest = off, best = k;
    }
    return best;
}

}  // namespace trilens
