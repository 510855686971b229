#include "render/picture/ray_differentials.h"

#include <algorithm>
#include <cmath>

#include "render/world/geometry.h"

namespace trilens {
namespace {

constexpr double kBeside = 1.0 / 32;  // pixels: how far rays beside a traced one stand

/// The ray that leaves the last optic when one of the camera's has this history; unit. None where it has
/// another.
std::optional<Ray> ray_after(const PathWorld& world, const Ray& from, const Media& around,
                             std::span<const Step> steps, Colours end_colours) {
    const auto first = world.optics[steps[0].optic].tracer->first_hit(from);
    if (!first) return std::nullopt;
    Meeting at{steps[0].optic, normalize_or_zero(from.direction), first->point.position, first->point.normal};
    at.front = dot(at.incoming, at.normal) <= 0;
    Media media = around;
    Colours colours = kAllColours;
    Ray leaving;
    for (std::size_t k = 0; k < steps.size(); ++k) {
        const std::vector<Branch> ways = branches(world, at, media, colours);
        const auto way_on = std::find_if(ways.begin(), ways.end(), [&](const Branch& one) {
            return one.step == steps[k] && (one.colours == kAllColours || one.colours == end_colours);
        });
        if (way_on == ways.end()) return std::nullopt;
        leaving = {at.point, way_on->direction};
        media = way_on->media;
        colours = way_on->colours;
        if (k + 1 == steps.size()) break;
        const std::optional<NextOptic> next = next_optic(world, {leaving, steps[k].optic, media});
        if (!next) return std::nullopt;
        at = next->meeting;
    }
    return leaving;
}

}  // namespace

RayDifferential FacetMap::differential(const Vec2& place) const {
    const IdTriple& corner = mesh->facets[facet];
    const Vec3 e = weights.unnormalised(place.x, place.y);
    const double sum = e.x + e.y + e.z;
    RayDifferential differential;
    for (int k = 0; k < 2; ++k) {
        const Vec3 along = weights.weights_from_screen[k];  // a column: how e moves along x or y
        const Vec3 share = (along - (along.x + along.y + along.z) / sum * e) / sum;
        for (int c = 0; c < 3; ++c) {
            const Ray& at_corner = mesh->rays[corner[static_cast<std::size_t>(c)]];
            differential.origin[static_cast<std::size_t>(k)] += share[c] * at_corner.origin;
            differential.direction[static_cast<std::size_t>(k)] += share[c] * at_corner.direction;
        }
    }
    return differential;
}

FacetMap facet_map(const Viewer& viewer, const SampleView& view, const PathEnd* end) {
    FacetMap map;
    if (!end) {
        map.mesh = viewer.camera_mesh();
        map.facet = view.camera_facet;
    } else if (end->node != kNone) {
        const PathNode& node = viewer.paths(view.optic).nodes[end->node];
        map.mesh = &node.mesh;
        map.facet = node.facet_of(view.leaf);
    }
    if (!map.mesh || map.facet == kNone) return {};
    map.weights = facet_weights(*map.mesh, map.facet);
    return map.weights.edge_on ? FacetMap() : map;
}

std::optional<Ray> RayDifferentials::camera_ray(const SampleView& view, const Vec2& place) const {
    if (const CameraModel* exact = viewer_.exact_camera()) return exact->ray(place);
    const FacetMap map = facet_map(viewer_, view, nullptr);
    if (!map.mesh) return std::nullopt;
    return map.at(place);
}

std::optional<Ray> RayDifferentials::ray_beside(const SampleViews& views, const SampleView& view,
                                                const PathEnd* end, const Vec2& place) const {
    std::optional<Ray> ray = camera_ray(view, place);
    if (ray && end)
        ray = ray_after(path_world(world_), *ray, views.around_of(view), views.steps_of(*end), end->colours);
    return ray;
}

std::optional<RayDifferential> RayDifferentials::of(const SampleViews& views, std::size_t sample,
                                                    const Contribution& contribution) const {
    const SampleView& view = views.samples[sample];
    const Vec2 place = grid_.position(sample);
    if (const FacetMap map = facet_map(viewer_, view, contribution.end); map.mesh)
        return map.differential(place);
    if (contribution.end && contribution.end->step_count == 0) return std::nullopt;
    const Ray& ray = *contribution.seen.ray;
    const double size = length(ray.direction);
    RayDifferential differential;
    for (int k = 0; k < 2; ++k) {
        std::optional<Ray> beside;
        double off = kBeside;
        for (const double step : {kBeside, -kBeside}) {
            Vec2 there = place;
            there[k] += off = step;
            if ((beside = ray_beside(views, view, contribution.end, there))) break;
        }
        if (!beside) return std::nullopt;
        const std::size_t along = static_cast<std::size_t>(k);
        differential.origin[along] = (beside->origin - ray.origin) / off;
        differential.direction[along] = (size * normalize_or_zero(beside->direction) - ray.direction) / off;
    }
    return differential;
}

}  // namespace trilens
