#include "render/picture/explain.h"

#include "base/raymesh/rasterize.h"
#include "base/util/error.h"
#include "base/util/format.h"
#include "camera/facet_kinds.h"
#include "render/engines/engine.h"
#include "render/picture/ray_differentials.h"

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

void name_end_facets(const FacetViews& views, PixelExplanation& explained) {
    const SampleView& view = explained.view();
    for (const PathEnd& end : explained.views.ends) {
        explained.end_kinds.emplace_back();
        if (end.node == kNone || view.leaf == kNone || !views.paths) continue;
        const PathNode& node = views.paths(view.optic).nodes()[end.node];
        explained.end_kinds.back() = facet_kind(node.mesh, node.facet_of(view.leaf));
    }
}

}  // namespace

PixelExplanation explain_pixel(const World& world, const PictureRequest& request, int x, int y) {
    const Film& film = world.scene.film;
    if (x < 0 || y < 0 || x >= film.width || y >= film.height)
        throw UsageError(
            fmt::format("the pixel {},{} is outside the {} x {} film", x, y, film.width, film.height));
    PixelExplanation explained;
    explained.x = x;
    explained.y = y;
    const SampleGrid grid{x, y, x + 1, y + 1, 1};
    const FacetViews views = make_views(world, request.frame, request.engine, {});
    views.viewer(grid, explained.views);
    name_end_facets(views, explained);
    if (views.paths) name_camera_facet(world, request.frame.camera, grid, explained);
    const RayDifferentials differentials(world, views, grid);
    explained.colour = sample_colour(world, explained.views, explained.view(), &differentials);
    return explained;
}

}  // namespace trilens
