#include "inverse/maps/film_targets.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "base/util/parallel.h"
#include "render/world/world.h"

namespace trilens {
namespace {

constexpr double kStep = 0.01;  // film pixels to each side
constexpr std::size_t kFewestPixels = 1024,
                      kMostPixelsAtOnce = 1 << 18;  // shot between two looks at whether to stop

std::uint64_t history_of(const ShotRays& shots, const ShotRay& shot) {
    std::uint64_t hash = (14695981039346656037ull ^ shot.object) * 1099511628211ull;  // FNV-1a
    for (const PathEvent& event : shots.events_of(shot))
        hash = (hash ^ (std::uint64_t{event.optic} << 2 | static_cast<std::uint64_t>(event.event))) *
               1099511628211ull;
    return std::max<std::uint64_t>(hash, 1);
}

/// Of two places of a picture that wraps around, the second nearer to the first.
Vec2 unwrapped(const Vec2& from, Vec2 to, double period) {
    if (period > 0) to.x -= period * std::round((to.x - from.x) / period);
    return to;
}

}  // namespace

std::optional<Vec2> target_of(const ShotRay& shot, const Target& target, const Proxy& proxy) {
    const Ray last{shot.origin, shot.direction};
    if (target.has_directions()) return target.pixel_of_direction(proxy.direction_met(last));
    if (target.description().kind == TargetKind::kObject) {
        if (shot.state != ShotState::kSeen || shot.object != target.description().object) return std::nullopt;
        return target.pixel_of_point(shot.position, shot.primitive);
    }
    const FlatRectangle& plane = *target.rectangle();
    const double t = dot(plane.origin - last.origin, plane.normal()) / dot(last.direction, plane.normal());
    if (!(t > 0) || !std::isfinite(t)) return std::nullopt;
    if (shot.state == ShotState::kSeen && shot.t < t * (1 - 1e-9)) return std::nullopt;  // something hides it
    return target.pixel_of_point(last.origin + t * last.direction, kNone);
}

namespace {

/// The same where the ray came over the optics that are asked for, and to its end.
std::optional<Vec2> asked_target_of(const ShotRays& shots, const ShotRay& shot,
                                    const FilmTargetsParams& params, const Target& target,
                                    const Proxy& proxy) {
    if (!shot.followed() || (params.over_optics && shot.event_count == 0)) return std::nullopt;
    if (params.optic && shot.event_count > 0 && shots.events_of(shot)[0].optic != *params.optic)
        return std::nullopt;
    return target_of(shot, target, proxy);
}

}  // namespace

void find_film_targets(const World& world, const FilmTargetsParams& params, const Target& target,
                       const Proxy& proxy, std::span<const Vec2> places, std::span<MapImages> images) {
    // Each place, and the four around it.
    constexpr std::array<Vec2, 5> kAround{{{0, 0}, {-kStep, 0}, {kStep, 0}, {0, -kStep}, {0, kStep}}};
    const std::size_t each = params.with_jacobians ? kAround.size() : 1;
    std::vector<Vec2> asked;
    asked.reserve(each * places.size());
    for (const Vec2& place : places)
        for (std::size_t k = 0; k < each; ++k) asked.push_back(place + kAround[k]);
    const ShotRays shots = shoot_places(world, params.shoot, asked);
    const double period = target.description().kind == TargetKind::kEquirect ? target.description().width : 0;

    parallel_for(places.size(), 256, [&](std::size_t first, std::size_t last) {
        for (std::size_t p = first; p < last; ++p) {
            std::array<std::optional<Vec2>, 5> found;
            for (std::size_t k = 0; k < each; ++k)
                found[k] = asked_target_of(shots, shots.rays[each * p + k], params, target, proxy);
            if (!found[0]) continue;
            const ShotRay& shot = shots.rays[each * p];
            MapImage image{*found[0], Mat2(0), shot.weight, history_of(shots, shot)};
            for (int axis = 0; axis < 2; ++axis) {
                const auto before = static_cast<std::size_t>(1 + 2 * axis);
                if (!found[before] || !found[before + 1]) continue;
                image.jacobian[axis] = (unwrapped(*found[0], *found[before + 1], period) -
                                        unwrapped(*found[0], *found[before], period)) /
                                       (2 * kStep);
            }
            images[p].push_back(image);
        }
    });
}

void shoot_film(const World& world, const ShootRequest& request, const Progress& progress,
                const std::function<void(std::size_t first, const ShotRays& shots)>& use) {
    const auto width = static_cast<std::size_t>(world.scene.film.width);
    const std::size_t pixels = width * static_cast<std::size_t>(world.scene.film.height);
    Portions portions(kFewestPixels, kMostPixelsAtOnce);
    std::vector<Vec2> middles;
    for (std::size_t first = 0; first < pixels; first += middles.size()) {
        progress.stop_if_cancelled();
        middles.resize(portions.next(pixels - first));
        for (std::size_t p = 0; p < middles.size(); ++p)
            middles[p] = {double((first + p) % width) + 0.5, double((first + p) / width) + 0.5};
        use(first, shoot_places(world, request, middles));
        progress(double(first + middles.size()) / double(pixels));
    }
}

ShownPixels find_shown_pixels(const World& world, const FilmTargetsParams& params, const Target& target,
                              const Proxy& proxy, const Progress& progress) {
    const std::size_t pixels =
        static_cast<std::size_t>(world.scene.film.width) * static_cast<std::size_t>(world.scene.film.height);
    ShownPixels shown{std::vector<float>(pixels, -1), std::vector<float>(pixels, -1),
                      std::vector<std::uint64_t>(pixels, 0)};
    shoot_film(world, params.shoot, progress, [&](std::size_t from, const ShotRays& shots) {
        parallel_for(shots.rays.size(), 1024, [&](std::size_t first, std::size_t last) {
            for (std::size_t p = first; p < last; ++p) {
                const ShotRay& shot = shots.rays[p];
                const std::optional<Vec2> place = asked_target_of(shots, shot, params, target, proxy);
                if (!place) continue;
                shown.x[from + p] = static_cast<float>(place->x);
                shown.y[from + p] = static_cast<float>(place->y);
                shown.history[from + p] = history_of(shots, shot);
            }
        });
    });
    return shown;
}

}  // namespace trilens
