#include "render/picture/sample_colour.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "render/picture/rough_light.h"
#include "render/world/world.h"

namespace trilens {

namespace {

/// The sides of what a ray stands for on the plane of the triangle that it sees.
std::array<Vec3, 2> footprint_of(const TriangleScene& scene, const SeenAlong& seen,
                                 const RayDifferential& differential) {
    const IdTriple& corner = scene.triangles[seen.hit->triangle];
    const Vec3& a = scene.points[corner[0]];
    const Vec3 normal = cross(scene.points[corner[1]] - a, scene.points[corner[2]] - a);
    const double along = dot(normal, seen.ray->direction);
    std::array<Vec3, 2> sides;
    for (std::size_t k = 0; k < 2; ++k) {
        const Vec3 moved = differential.origin[k] + seen.hit->t * differential.direction[k];
        sides[k] = moved - dot(normal, moved) / along * seen.ray->direction;
    }
    return sides;
}

/// Rays of several samples, shaded together: what each adds to its sample.
class Contributions {
  public:
    Contributions(const World& world, const SampleViews& views, std::size_t first,
                  std::span<SampleColour> colours, const RayDifferentials* differentials)
        : world_(world),
          views_(views),
          first_(first),
          colours_(colours),
          differentials_(differentials),
          has_rough_(has_rough_optics(world)) {}

    void add_sample(std::size_t index);
    void shade();

  private:
    static constexpr std::size_t kMost = 2 * Segments::kMost;

    std::optional<SampleColour> rough(std::size_t index) const;

    const World& world_;
    const SampleViews& views_;
    std::size_t first_;
    std::span<SampleColour> colours_;
    const RayDifferentials* differentials_;
    bool has_rough_;
    std::size_t count_ = 0;
    std::array<SeenAlong, kMost> seen_;
    std::array<Contribution, kMost> contributions_;
    std::array<RayDifferential, kMost> differential_;   // where textures are averaged
    std::array<std::array<Vec3, 2>, kMost> footprint_;  // where caustics are
    std::array<std::size_t, kMost> sample_;             // of colours_
};

/// The colour of a sample that shows a rough optic; none where it shows none.
std::optional<SampleColour> Contributions::rough(std::size_t index) const {
    const SampleView& view = views_.samples[first_ + index];
    if (!has_rough_ || !meets_rough_optic(world_, views_, view)) return std::nullopt;
    const bool traced = differentials_ && differentials_->are_traced();
    const int side = differentials_ ? differentials_->side() : 1;
    RoughGather gather{.ways = rough_ways(world_.scene.render, traced, side), .is_filtered = !traced};
    if (differentials_) gather.cancel = differentials_->cancel();
    if (differentials_) gather.shift = rough_shift(differentials_->place(first_ + index), side);
    if (differentials_ && side == 1)
        gather.differential = [&](const PathEnd& end) {
            return differentials_->of(views_, first_ + index, {{&end.hit, &end.ray}, Vec3(1), &end});
        };
    return rough_colour(world_, views_, view, gather);
}

void Contributions::add_sample(std::size_t index) {
    const SampleView& view = views_.samples[first_ + index];
    if (const std::optional<SampleColour> gathered = rough(index)) {
        colours_[index] = *gathered;
        return;
    }
    colours_[index] = unlit_colour(world_, views_, view);
    for_each_contribution(world_, views_, view, [&](const Contribution& contribution) {
        if (count_ == kMost) shade();
        seen_[count_] = contribution.seen;
        const Hit& hit = *contribution.seen.hit;
        const bool textured = has_texture(world_.shading, hit), lit = world_.shading.caustic && hit.seen();
        if (differentials_ && lit) {
            seen_[count_].exact_caustics = differentials_->are_traced();
            seen_[count_].cancel = differentials_->cancel();
        }
        if (differentials_ && ((textured && differentials_->side() == 1) || lit))
            if (const auto differential = differentials_->of(views_, first_ + index, contribution)) {
                differential_[count_] = *differential;
                if (textured && differentials_->side() == 1)
                    seen_[count_].differential = &differential_[count_];
                if (lit) {
                    footprint_[count_] = footprint_of(world_.objects, contribution.seen, *differential);
                    for (Vec3& side : footprint_[count_]) side /= differentials_->side();
                    seen_[count_].footprint = &footprint_[count_];
                }
            }
        sample_[count_] = index;
        contributions_[count_++] = contribution;
    });
}

/// Adds what has come together to its samples, in the order in which it came.
void Contributions::shade() {
    std::array<Vec3, kMost> light;
    shade_rays(world_.shading, std::span(seen_).first(count_), std::span(light).first(count_));
    for (std::size_t i = 0; i < count_; ++i)
        add_light(world_, contributions_[i], light[i], colours_[sample_[i]]);
    count_ = 0;
}

}  // namespace

SampleColour unlit_colour(const World& world, const SampleViews& views, const SampleView& view) {
    SampleColour colour;
    if (view.ray.direction == Vec3(0)) return colour;
    colour.coverage = view.hit.seen() || view.optic != kNone ? 1 : 0;
    const SampleVolumes* volumes = views.volumes_of(view);
    if (!volumes) return colour;
    if (view.optic == kNone && !world.scene.render.direct) return colour;
    if (world.scene.render.direct) colour.direct = volumes->first.emission;
    colour.coverage = std::max(colour.coverage, 1 - volumes->first.transmittance);
    if (view.optic == kNone || (volumes->reflect == Vec3(0) && volumes->refract == Vec3(0))) return colour;
    const OpticWeights weights = first_weights(world, views, view);
    colour.reflect = volumes->first.transmittance * weights.reflect * volumes->reflect;
    colour.refract = volumes->first.transmittance * weights.refract * volumes->refract;
    return colour;
}

void add_light(const World& world, const Contribution& from, Vec3 light, SampleColour& colour) {
    const PathEnd* end = from.end;
    if (!end) {
        colour.direct += from.weight * light;
        return;
    }
    if (end->medium != kNone && end->hit.seen())
        light *= volume_transmittance(world.scene.materials[world.optics[end->medium].material],
                                      from.mean_length.value_or(path_length(*end)));
    (end->path == Path::kReflect ? colour.reflect : colour.refract) += from.weight * light;
}

double path_length(const PathEnd& end) {
    return end.hit.t * length(end.ray.direction);
}

void sample_colours(const World& world, const SampleViews& views, std::size_t first,
                    std::span<SampleColour> colours, const RayDifferentials* differentials) {
    Contributions contributions(world, views, first, colours, differentials);
    for (std::size_t i = 0; i < colours.size(); ++i) contributions.add_sample(i);
    contributions.shade();
}

SampleColour sample_colour(const World& world, const SampleViews& views, const SampleView& view,
                           const RayDifferentials* differentials) {
    SampleColour colour;
    sample_colours(world, views, static_cast<std::size_t>(&view - views.samples.data()), {&colour, 1},
                   differentials);
    return colour;
}

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
        const Branches ways = branches(world, at, media, colours);
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

bool RayDifferentials::are_traced() const {
    return !viewer_.has_facets();
}

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
