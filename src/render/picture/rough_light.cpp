#include "render/picture/rough_light.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <variant>
#include <vector>

#include "render/volumes/volume_rays.h"
#include "shade/lights/light_sample.h"

namespace trilens {
namespace {

/// Ways of light are averaged over at most this angle, radians: few lie so far out of the lobe's middle.
constexpr double kWidest = 0.5;

/// Two vectors in the plane at right angles to a ray, as sides of a parallelogram about it, and a square: the
/// sides of that which has the sum of both's second moments.
std::array<Vec3, 2> joined_sides(const Ray& ray, const std::array<Vec3, 2>& sides, double square) {
    const auto [u, v] = tangent_basis(ray.direction);
    double xx = square * square, xy = 0, yy = xx;
    for (const Vec3& side : sides) {
        const double x = dot(side, u), y = dot(side, v);
        xx += x * x, xy += x * y, yy += y * y;
    }
    const double area = std::sqrt(std::max(xx * yy - xy * xy, 0.0)), scale = std::sqrt(xx + yy + 2 * area);
    if (!(scale > 0)) return {Vec3(0), Vec3(0)};
    return {((xx + area) * u + xy * v) / scale, (xy * u + (yy + area) * v) / scale};
}

/// The differential of a ray as one of unit direction has it.
RayDifferential of_unit_direction(const RayDifferential& from, const Vec3& direction) {
    const double size = length(direction);
    const Vec3 unit = direction / size;
    RayDifferential result = from;
    for (Vec3& step : result.direction) step = (step - dot(unit, step) * unit) / size;
    return result;
}

class Gathering {
  public:
    Gathering(const World& world, const SampleViews& views, const SampleView& view, const RoughGather& gather)
        : world_(world), views_(views), view_(view), gather_(gather) {}

    void follow(const FollowedPaths& followed);
    void shade(SampleColour& colour);

  private:
    /// What one ray shows.
    struct Seen {
        Ray ray;
        Hit hit;
        RayDifferential differential;
        Vec3 weight{0};
        Path path = Path::kReflect;
        bool is_spread = false;
    };
    void add_end(const FollowedPaths& followed, std::size_t index, const Vec3& weight);
    const PathEnd* smooth_end(const FollowedPaths& followed, std::size_t index) const;

    const World& world_;
    const SampleViews& views_;
    const SampleView& view_;
    const RoughGather& gather_;
    std::vector<Seen> seen_;
    Vec3 emitted_reflect_{0}, emitted_refract_{0};  // by volumes on the way
};

/// The end that smooth optics show over the same history; null where they show none.
const PathEnd* Gathering::smooth_end(const FollowedPaths& followed, std::size_t index) const {
    std::vector<Step> steps;
    for (Id s = static_cast<Id>(index); s != kNone; s = followed.segments[s].parent)
        steps.push_back(followed.segments[s].step);
    for (const PathEnd& end : views_.ends_of(view_)) {
        const std::span<const Step> own = views_.steps_of(end);
        if (end.colours == followed.segments[index].colours &&
            std::equal(own.rbegin(), own.rend(), steps.begin(), steps.end()))
            return &end;
    }
    return nullptr;
}

void Gathering::add_end(const FollowedPaths& followed, std::size_t index, const Vec3& weight) {
    const PathSegment& segment = followed.segments[index];
    Seen seen{segment.ray, segment.hit, {}, weight, segment.path};
    std::array<Vec3, 2> sides{Vec3(0), Vec3(0)};
    const double way = segment.hit.seen() ? segment.hit.t : 1;
    if (gather_.differential) {
        const PathEnd* end = smooth_end(followed, index);
        if (const auto smooth = end ? gather_.differential(*end) : std::nullopt) {
            const RayDifferential unit = of_unit_direction(*smooth, end->ray.direction);
            for (std::size_t k = 0; k < 2; ++k)
                sides[k] = way * unit.direction[k] + (segment.hit.seen() ? unit.origin[k] : Vec3(0));
            seen.is_spread = true;
        }
    }
    double angle = 0;
    if (gather_.is_filtered && segment.lobe > 0) {
        angle = std::min(std::sqrt(segment.lobe / static_cast<double>(gather_.ways)), kWidest);
        seen.is_spread = true;
    }
    if (seen.is_spread) {
        sides = joined_sides(segment.ray, sides, way * angle);
        for (std::size_t k = 0; k < 2; ++k) seen.differential.direction[k] = sides[k] / way;
    }
    if (segment.medium != kNone && segment.hit.seen())
        seen.weight *= volume_transmittance(world_.scene.materials[world_.optics[segment.medium].material],
                                            segment.hit.t);
    seen_.push_back(seen);
}

void Gathering::follow(const FollowedPaths& followed) {
    const double share = 1 / static_cast<double>(gather_.ways);
    std::vector<double> through(followed.segments.size(), 1.0);
    for (std::size_t i = 0; i < followed.segments.size(); ++i) {
        const PathSegment& segment = followed.segments[i];
        Vec3 weight = share * segment.first_weight * segment.weight;
        if (has_layers(world_)) {
            if (segment.parent != kNone) through[i] = through[segment.parent];
            const VolumeLight light = trace_layers(world_, segment);
            (segment.path == Path::kReflect ? emitted_reflect_ : emitted_refract_) +=
                through[i] * weight * light.emission;
            through[i] *= light.transmittance;
            weight *= through[i];
        }
        if (segment.ends && weight != Vec3(0)) add_end(followed, i, weight);
    }
}

void Gathering::shade(SampleColour& colour) {
    std::vector<SeenAlong> along;
    for (const Seen& one : seen_) {
        along.push_back({&one.hit, &one.ray});
        if (one.is_spread) along.back().differential = &one.differential;
        along.back().exact_caustics = !gather_.is_filtered;
        along.back().cancel = gather_.cancel;
    }
    std::vector<Vec3> light(along.size());
    shade_rays(world_.shading, along, light);
    // What comes to the eye of all that leaves the first optic.
    const Vec3 passed = through_volumes(views_, view_) * light_of_view(world_, views_, view_);
    colour.reflect = passed * emitted_reflect_;
    colour.refract = passed * emitted_refract_;
    for (std::size_t i = 0; i < seen_.size(); ++i)
        (seen_[i].path == Path::kReflect ? colour.reflect : colour.refract) +=
            passed * seen_[i].weight * light[i];
}

}  // namespace

bool meets_rough_optic(const World& world, const SampleViews& views, const SampleView& view) {
    if (view.optic == kNone || view.ray.direction == Vec3(0)) return false;
    if (is_rough(world, view.optic)) return true;
    for (const PathEnd& end : views.ends_of(view))
        for (const Step& step : views.steps_of(end))
            if (step.event != Event::kPass && is_rough(world, step.optic)) return true;
    return false;
}

std::size_t rough_shift(const Vec2& place, int side) {
    const auto x = static_cast<std::size_t>(std::max(std::floor(place.x), 0.0)),
               y = static_cast<std::size_t>(std::max(std::floor(place.y), 0.0));
    const auto inside = [&](double coordinate) {
        return static_cast<std::size_t>((coordinate - std::floor(coordinate)) * side);
    };
    const std::size_t sample = inside(place.y) * static_cast<std::size_t>(side) + inside(place.x);
    return 16 * sample + 4 * (y % 4) + x % 4;
}

std::size_t rough_ways(const RenderSettings& settings, bool traced, int side) {
    if (!traced) return static_cast<std::size_t>(settings.rough_samples);
    const int per_pixel = side * side;
    return static_cast<std::size_t>((settings.rough_truth_samples + per_pixel - 1) / per_pixel);
}

std::optional<SampleColour> rough_colour(const World& world, const SampleViews& views, const SampleView& view,
                                         const RoughGather& gather) {
    const PathWorld& paths = path_world(world);
    const std::optional<SurfaceHit> hit = paths.optics[view.optic].tracer->first_hit(view.ray);
    if (!hit) return std::nullopt;
    SampleColour colour = unlit_colour(world, views, view);
    Meeting meeting{view.optic, normalize_or_zero(view.ray.direction), hit->point.position,
                    hit->point.normal};
    meeting.front = dot(meeting.incoming, meeting.normal) <= 0;
    const PathStart start{meeting, hit->t * length(view.ray.direction), views.around_of(view)};
    Gathering gathering(world, views, view, gather);
    for (std::size_t k = 0; k < gather.ways; ++k) {
        const RoughWay way{k, gather.ways, gather.shift};
        gathering.follow(follow_paths(paths, start, {.objects = &object_tracer(world), .rough = &way}));
    }
    gathering.shade(colour);
    return colour;
}

bool shade_rough(const FragmentShading& shading, const ShownFragment& fragment, SampleColour& colour) {
    const SampleView& view = *fragment.view;
    if (!meets_rough_optic(shading.world, shading.views, view)) return false;
    const double samples = shading.side * shading.side;
    const double share =
        fragment.members.empty() ? 1 : std::sqrt(static_cast<double>(fragment.members.size()) / samples);
    RoughGather gather{.ways = rough_ways(shading.world.scene.render, false, shading.side),
                       .shift = rough_shift(fragment.pixel, 1)};
    gather.differential = [&](const PathEnd& end) -> std::optional<RayDifferential> {
        const FacetMap map = facet_map(shading.viewer, view, &end);
        if (!map.mesh) return std::nullopt;
        RayDifferential differential = map.differential(fragment.pixel + Vec2(0.5));
        for (std::size_t k = 0; k < 2; ++k)
            differential.origin[k] *= share, differential.direction[k] *= share;
        return differential;
    };
    gather.cancel = shading.cancel;
    const std::optional<SampleColour> gathered = rough_colour(shading.world, shading.views, view, gather);
    if (gathered) colour = *gathered;
    return gathered.has_value();
}

void warn_of_roughness(const World& world, const FrameParams& frame, const EngineChoice& engine,
                       const Warn& warn) {
    if (!warn || !has_rough_optics(world)) return;
    if (frame.certify || world.scene.render.certify)
        warn("what is proven (certify) of rough mirrors is where the ray of a smooth one shows things");
    if (has_caustics(world)) warn("light with caustics is followed over rough optics as over smooth ones");
    if (projects(engine.engine) && engine.engine != Engine::kExact)
        warn("what rough optics show is gathered along rays, not drawn by engine " +
             engine_name(engine.engine));
    const auto is_point = [](const Light& light) {
        const auto* sun = std::get_if<DirectionalLight>(&light.kind);
        return (sun && sun->angle == 0) || std::holds_alternative<PointLight>(light.kind) ||
               std::holds_alternative<SpotLight>(light.kind);
    };
    if (std::any_of(world.scene.lights.begin(), world.scene.lights.end(), is_point))
        warn(
            "point, spot and directional lights make no highlights on rough optics, which show what has a "
            "size");
}

}  // namespace trilens
