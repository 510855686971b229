#include "render/engines/rim_samples.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/util/parallel.h"
#include "render/engines/path_ends.h"
#include "render/world/world.h"

namespace trilens {
namespace {

constexpr std::size_t kRimSamplesPerTask = 256;

/// The grid's facet that holds a place of the surface.
Id facet_holding(const FacetLookup& facets, Id face, const Vec2& uv) {
    const Id facet = facets.at(face, uv);
    if (facet != kNone) return facet;
    // Rounding left it in none: a hair towards a place inside of squares and triangles.
    constexpr double kHair = 1e-7;
    return facets.at(face, glm::mix(uv, Vec2(1.0 / 3), kHair));
}

/// A sample's exact ray and what it meets first.
struct ExactView {
    Ray ray;
    FirstSurface first;
};

/// None where the camera has no ray.
std::optional<ExactView> exact_view(const RimParams& params, const Vec2& at, const SampleView& view) {
    std::optional<Ray> ray = view.ray;
    if (!params.frame.camera.linear) ray = exact_ray(params.frame.camera, at);
    if (!ray || ray->direction == Vec3(0)) return std::nullopt;
    return ExactView{
        *ray, first_surface(path_world(params.world), object_tracer(params.world), *ray, params.reach)};
}

void show_optic(const RimParams& params, const ExactView& exact, SampleView& view, OpticView& on_optic) {
    const FirstSurface& first = exact.first;
    view.ray = exact.ray;
    view.hit = {};
    view.optic = first.optic;
    view.depth = first.at.t;
    view.traced = true;
    view.leaf = kNone;
    view.facet = facet_holding(*params.rims.facets[first.optic], first.at.face, first.at.uv);
    on_optic = {};
    on_optic.uv = first.at.uv;
}

void decide(const RimParams& params, const Vec2& at, SampleView& view, OpticView& on_optic) {
    const std::optional<ExactView> exact = exact_view(params, at, view);
    if (!exact || (exact->first.optic == kNone && view.optic == kNone)) return;
    if (exact->first.optic != kNone) return show_optic(params, *exact, view, on_optic);
    view.ray = exact->ray;
    view.optic = view.facet = kNone;
    view.hit = exact->first.object;
    view.depth = view.hit.seen() ? view.hit.t : SampleView().depth;
}

/// How far along the ray the surface may lie from where the ray meets the facet.
double room_along(const RimParams& params, const Ray& ray, const MetSurface& met) {
    if (met.optic == kNone) return 0;
    constexpr double kGrazing = 0.05;  // a cosine: below it the outline is near
    const SurfaceGrid& grid = params.frame.optics[met.optic].facets->grid();
    std::array<Vec3, 3> corner;
    for (std::size_t k = 0; k < 3; ++k) corner[k] = grid.points[grid.corner_point[grid.facets[met.facet][k]]];
    const Vec3 normal = normalize_or_zero(cross(corner[1] - corner[0], corner[2] - corner[0]));
    const double speed = length(ray.direction);
    const double cosine = std::max(std::fabs(dot(normal, ray.direction)) / speed, kGrazing);
    return surface_stray(*params.world.optics[met.optic].surface, grid, met.facet) / (cosine * speed);
}

/// No less than room_along, without asking the surface: a facet is as long as the surface strays, at most.
double longest_room(const RimParams& params, const Ray& ray, const MetSurface& met) {
    if (met.optic == kNone) return 0;
    constexpr double kSteepest = 20;
    const SurfaceGrid& grid = params.frame.optics[met.optic].facets->grid();
    double longest = 0;
    for (std::size_t k = 0; k < 3; ++k)
        longest =
            std::max(longest, length(grid.points[grid.corner_point[grid.facets[met.facet][k]]] -
                                     grid.points[grid.corner_point[grid.facets[met.facet][(k + 1) % 3]]]));
    return kSteepest * longest / length(ray.direction);
}

}  // namespace

bool may_change_order(const RimParams& params, const Ray& ray, const MetSurface& one,
                      const MetSurface& other) {
    const double apart = std::fabs(one.t - other.t);
    if (apart > longest_room(params, ray, one) + longest_room(params, ray, other)) return false;
    return apart <= room_along(params, ray, one) + room_along(params, ray, other);
}

OpticRims make_rims(const World& world, const Frame& frame, double limit) {
    OpticRims rims;
    rims.limit = limit;
    bool any = false;
    for (std::size_t i = 0; i < frame.optics.size(); ++i) {
        frame.stop_if_cancelled();
        rims.edges.push_back(optic_outline(world, frame, i));
        for (const OutlineEdge& edge : rims.edges[i])
            if (is_off(edge, limit))
                any = true;
            else
                rims.error = std::max(rims.error, edge.off);
    }
    // A sample near one optic's outline, or where two cross, may see another optic.
    any = any || limit != kAnyError || frame.optics.size() > 1;
    rims.facets.resize(frame.optics.size());
    parallel_for(any ? frame.optics.size() : 0, 1, [&](std::size_t from, std::size_t to) {
        for (std::size_t i = from; i < to; ++i) {
            frame.stop_if_cancelled();
            rims.facets[i] = std::make_unique<FacetLookup>(frame.optics[i].facets->grid(),
                                                           world.optics[i].surface->face_count());
        }
    });
    return rims;
}

SampleGrid window_with_rim(const OpticRims& rims, std::size_t optic, const SampleGrid& window,
                           const FilmSize& film) {
    double room = 0;
    for (const OutlineEdge& edge : rims.edges[optic])
        if (is_off(edge, rims.limit)) room = std::max(room, outline_room(edge));
    if (room == 0) return window;
    const int wider = static_cast<int>(std::ceil(std::min(room, 1.0 * std::max(film.width, film.height))));
    return {std::max(window.x0 - wider, 0), std::max(window.y0 - wider, 0),
            std::min(window.x1 + wider, static_cast<int>(film.width)),
            std::min(window.y1 + wider, static_cast<int>(film.height)), window.side};
}

std::vector<std::optional<SurfaceHit>> decide_traced(const RimParams& params, const SampleGrid& grid,
                                                     std::span<const Id> samples, SampleViews& views) {
    std::vector<std::optional<SurfaceHit>> met(samples.size());
    if (params.frame.optics.size() < 2) return met;
    parallel_for(samples.size(), kRimSamplesPerTask, [&](std::size_t from, std::size_t to) {
        for (std::size_t i = from; i < to; ++i) {
            SampleView& view = views.samples[samples[i]];
            const std::optional<ExactView> exact = exact_view(params, grid.position(samples[i]), view);
            if (!exact || exact->first.optic == kNone) continue;
            if (params.frame.camera.linear) met[i] = exact->first.at;
            if (exact->first.optic != view.optic)
                show_optic(params, *exact, view, views.of_optics[samples[i]]);
        }
    });
    return met;
}

void decide_rims(const RimParams& params, const SampleGrid& grid, SampleViews& views) {
    std::vector<char> asked(grid.size(), 0), near(grid.size());
    for (std::size_t i = 0; i < params.rims.edges.size(); ++i) {
        std::fill(near.begin(), near.end(), 0);
        mark_near_outline(params.rims.edges[i], params.rims.limit, grid, near);
        // A convex body's facets lie within its outline.
        const bool is_convex = path_world(params.world).optics[i].convex;
        for (std::size_t s = 0; s < near.size(); ++s)
            if (near[s] && !(is_convex && views.samples[s].optic == i)) asked[s] = 1;
    }
    parallel_for(grid.size(), kRimSamplesPerTask, [&](std::size_t from, std::size_t to) {
        for (std::size_t s = from; s < to; ++s)
            if (asked[s] || views.samples[s].unsure)
                decide(params, grid.position(s), views.samples[s], views.of_optics[s]);
    });
}

}  // namespace trilens
