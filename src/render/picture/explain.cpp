#include "render/picture/explain.h"

#include <algorithm>
#include <limits>
#include <span>

#include "base/raymesh/rasterize.h"
#include "base/util/error.h"
#include "base/util/format.h"
#include "camera/camera.h"
#include "render/engines/engine.h"
#include "render/picture/sample_colour.h"

namespace trilens {
namespace {

void name_camera_facet(const World& world, std::size_t index, const SampleGrid& grid,
                       PixelExplanation& explained) {
    const CameraRays camera = make_camera_rays(world.scene, index);
    const FacetSamples owned = rasterize_facets(camera.mesh, grid);
    for (std::size_t f = 0; f < camera.mesh.facets.size(); ++f) {
        if (owned.of(f).empty()) continue;
        explained.camera_facet = static_cast<Id>(f);
        explained.camera_kind = facet_kind(camera.mesh, f, camera.axis);
    }
}

/// Of the optic that the sample shows first, and of the ends of the paths over it.
void describe_optic(const World& world, const Viewer& viewer, const SampleViews& shown,
                    PixelExplanation& explained) {
    const SampleView& view = shown.samples.front();
    const OpticWeights first = first_weights(world, shown, view);
    explained.optic = view.optic;
    explained.facet = view.facet;
    explained.traced = view.traced || !viewer.has_facets();
    explained.level = view.level;
    const OpticView& on_optic = shown.on_optic(view);
    explained.uv = on_optic.uv;
    explained.cos_incident = on_optic.incidence.cosine;
    explained.front = on_optic.incidence.front;
    for (const PathEnd& end : shown.ends_of(view)) {
        const std::span<const Step> steps = shown.steps_of(end);
        explained.ends.push_back({end, {steps.begin(), steps.end()}, std::nullopt});
        Vec3& weight = explained.ends.back().weight;
        weight *= through_volumes(shown, view) * (end.path == Path::kReflect ? first.reflect : first.refract);
        if (end.hit.seen()) weight *= body_transmittance(path_world(world), end.medium, path_length(end));
        if (end.node == kNone || view.leaf == kNone || !viewer.has_facets()) continue;
        const PathNode& node = viewer.paths(view.optic).nodes[end.node];
        explained.ends.back().facet_kind = facet_kind(node.mesh, node.facet_of(view.leaf));
    }
}

/// Which paths the bound of their depth has ended, by the exact ones of the pixel's ray.
void mark_cut(const World& world, Engine engine, const SampleViews& shown, PixelExplanation& explained) {
    const SampleView& view = shown.samples.front();
    const std::optional<SurfaceHit> hit = limit_tracer(world, view.optic).first_hit(view.ray);
    if (!hit) return;
    PathWorld paths = path_world(world);
    if (!follows_paths(engine)) paths.max_depth = 0;
    const Vec3 incoming = normalize_or_zero(view.ray.direction);
    const Meeting first{view.optic, incoming, hit->point.position, hit->point.normal,
                        dot(incoming, hit->point.normal) <= 0};
    const std::vector<PathSegment> segments =
        follow_paths(paths, {first, hit->t * length(view.ray.direction), shown.around_of(view)},
                     {.objects = &object_tracer(world)})
            .segments;
    for (const PathSegment& last : segments) {
        if (!last.ends) continue;
        double cut = last.cut;
        if (paths.max_depth == 0)  // paths that end at once do not ask what would come next
            if (const auto next = next_optic(paths, {last.ray, last.step.optic, Media()}))
                cut = next->distance;
        if (!(cut < (last.hit.seen() ? last.hit.t : std::numeric_limits<double>::infinity()))) continue;
        std::vector<Step> steps{last.step};
        for (Id s = last.parent; s != kNone; s = segments[s].parent) steps.push_back(segments[s].step);
        std::reverse(steps.begin(), steps.end());
        for (PixelEnd& end : explained.ends)
            end.cut = end.cut || (end.steps == steps && end.colours == last.colours);
    }
}

}  // namespace

const PixelEnd* PixelExplanation::find(Path path) const {
    for (const PixelEnd& end : ends)
        if (end.path == path && end.principal) return &end;
    return nullptr;
}

PixelExplanation explain_pixel(const World& world, const PictureRequest& request, int x, int y) {
    const Film& film = world.scene.film;
    if (x < 0 || y < 0 || x >= film.width || y >= film.height)
        throw UsageError(
            fmt::format("the pixel {},{} is outside the {} x {} film", x, y, film.width, film.height));
    PixelExplanation explained;
    explained.x = x;
    explained.y = y;
    const SampleGrid grid{x, y, x + 1, y + 1, 1};
    const std::unique_ptr<Viewer> viewer = make_viewer(world, request.frame, request.engine, Warn());
    SampleViews shown;
    viewer->view(grid, shown);
    const SampleView& view = shown.samples.front();
    explained.ray = view.ray;
    explained.hit = view.hit;
    explained.depth = view.depth;
    if (view.optic != kNone) {
        describe_optic(world, *viewer, shown, explained);
        mark_cut(world, request.engine.engine, shown, explained);
    }
    if (viewer->has_facets()) name_camera_facet(world, request.frame.camera, grid, explained);
    const RayDifferentials differentials(world, *viewer, grid);
    const SampleColour colour = sample_colour(world, shown, view, &differentials);
    explained.direct = colour.direct;
    explained.reflect = colour.reflect;
    explained.refract = colour.refract;
    return explained;
}

}  // namespace trilens
