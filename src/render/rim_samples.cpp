#include "render/rim_samples.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "render/first_surface.h"
#include "render/geometry.h"

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

void show_optic(const RimParams& params, const FirstSurface& first, SampleView& view, OpticView& on_optic) {
    view.hit = {};
    view.optic = first.optic;
    view.depth = first.at.t;
    view.traced = true;
    view.facet = facet_holding(*params.rims.facets[first.optic], first.at.face, first.at.uv);
    on_optic = {};
    on_optic.uv = first.at.uv;
}

void decide(const RimParams& params, const Vec2& at, SampleView& view, OpticView& on_optic) {
    std::optional<Ray> ray = view.ray;
    if (!params.frame.camera.linear) ray = exact_ray(params.frame.camera, at);
    if (!ray || ray->direction == Vec3(0)) return;
    const FirstSurface first =
        first_surface(path_world(params.world), object_tracer(params.world), *ray, params.reach);
    if (first.optic == kNone && view.optic == kNone) return;
    view.ray = *ray;
    if (first.optic != kNone) return show_optic(params, first, view, on_optic);
    view.optic = view.facet = kNone;
    view.hit = first.object;
    view.depth = first.object.seen() ? first.object.t : SampleView().depth;
}

}  // namespace

OpticRims make_rims(const World& world, const Frame& frame, double limit) {
    OpticRims rims;
    rims.limit = limit;
    bool any = false;
    for (std::size_t i = 0; i < frame.optics.size(); ++i) {
        rims.edges.push_back(optic_outline(world, frame, i));
        for (const OutlineEdge& edge : rims.edges[i])
            if (is_off(edge, limit))
                any = true;
            else
                rims.error = std::max(rims.error, edge.off);
    }
    // A sample near one optic's outline may see another optic.
    rims.facets.resize(frame.optics.size());
    for (std::size_t i = 0; any && i < frame.optics.size(); ++i)
        rims.facets[i] = std::make_unique<FacetLookup>(frame.optics[i].facets->grid(),
                                                       world.optics[i].surface->face_count());
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
            if (asked[s]) decide(params, grid.position(s), views.samples[s], views.of_optics[s]);
    });
}

}  // namespace trilens
