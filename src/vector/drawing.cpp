#include "vector/drawing.h"

#include <algorithm>

#include "base/facet_scene.h"
#include "base/rasterize.h"
#include "projector/projector.h"
#include "render/facet_engine.h"

namespace trilens {
namespace {

constexpr int kSide = 2;       // samples along a pixel's edge that decide what is hidden
constexpr int kBandRows = 32;  // of pixels that are viewed at once

/// What each sample shows, by index.
struct SampleIds {
    std::vector<Id> camera_facet, visible;  // the camera's facet; the triangle of objects and optics
    std::vector<Id> optic, optic_facet;     // index into World::optics
    std::vector<Id> reflected, refracted;   // triangles of the objects
};

std::vector<Id> camera_facets(const RayMesh& mesh, const SampleGrid& grid) {
    std::vector<Id> facet(grid.size(), kNone);
    const FacetSamples owned = rasterize_facets(mesh, grid);
    for (std::size_t f = 0; f < mesh.facets.size(); ++f)
        for (const Id s : owned.of(f)) facet[s] = static_cast<Id>(f);
    return facet;
}

/// `first_facet`: where each optic's facets begin among the visible triangles.
SampleIds look(const Viewer& viewer, const SampleGrid& grid, const std::vector<Id>& first_facet) {
    SampleIds ids;
    for (std::vector<Id>* list : {&ids.visible, &ids.optic, &ids.optic_facet, &ids.reflected, &ids.refracted})
        list->assign(grid.size(), kNone);
    SampleViews views;
    for (int y = grid.y0; y < grid.y1; y += kBandRows) {
        const SampleGrid band{grid.x0, y, grid.x1, std::min(y + kBandRows, grid.y1), grid.side};
        viewer(band, views);
        const std::size_t first = grid.first_sample(grid.x0, y);
        for (std::size_t s = 0; s < views.samples.size(); ++s) {
            const SampleView& view = views.samples[s];
            const bool optic = view.optic != kNone;
            ids.visible[first + s] = optic ? first_facet[view.optic] + view.facet : view.hit.triangle;
            ids.optic[first + s] = view.optic;
            ids.optic_facet[first + s] = view.facet;
            ids.reflected[first + s] = views.hit(view, Path::kReflect).triangle;
            ids.refracted[first + s] = views.hit(view, Path::kRefract).triangle;
        }
    }
    return ids;
}

/// The facets of the optic's RayMeshes that show it.
std::vector<Id> facets_of(const SampleIds& ids, Id optic, const FramedOptic& framed, const SampleGrid& grid) {
    std::vector<Id> facet(ids.optic.size(), kNone);
    for (std::size_t s = 0; s < facet.size(); ++s)
        if (ids.optic[s] == optic) facet[s] = framed.mesh_facet(ids.optic_facet[s], grid.position(s));
    return facet;
}

}  // namespace

std::unique_ptr<Drawing> make_drawing(const World& world, const FrameParams& params, bool wire,
                                      const Warn& warn) {
    auto drawing = std::make_unique<Drawing>();
    drawing->width = world.scene.film.width, drawing->height = world.scene.film.height, drawing->wire = wire;
    const Frame frame = make_frame(world, params, warn);
    const SampleGrid grid{0, 0, drawing->width, drawing->height, kSide};

    // Everything that the camera may see, and the optics' grids.
    drawing->visible = world.objects;
    std::vector<Id> material = world.shading.material, first_facet;
    for (std::size_t i = 0; i < world.optics.size(); ++i) {
        const Optic& optic = world.optics[i];
        first_facet.push_back(static_cast<Id>(drawing->visible.size()));
        append_facets(frame.optics[i].facets->grid(), optic.mesh, drawing->visible);
        material.resize(drawing->visible.size(), optic.material);
    }
    SampleIds ids = look(make_facet_viewer(world, frame, Engine::kExact), grid, first_facet);
    ids.camera_facet = camera_facets(frame.camera.mesh, grid);

    const auto add = [&](Path path, Id optic, const VectorView& view) {
        auto layer = std::make_unique<DrawingLayer>();
        layer->path = path_name(path), layer->optic = optic, layer->scene = &view.scene;
        layer->curves = edge_curves(view);
        drawing->layers.push_back(std::move(layer));
    };
    if (world.scene.render.direct) {
        const DrawnEdges edges = drawn_edges(drawing->visible, {material, world.objects.size()});
        add(Path::kDirect, kNone,
            {drawing->visible, edges, frame.camera.mesh, grid, ids.camera_facet, ids.visible, wire});
    }
    const DrawnEdges edges = drawn_edges(world.objects, {material, world.objects.size()});
    for (Id i = 0; i < world.optics.size(); ++i) {
        const std::vector<Id> facet = facets_of(ids, i, frame.optics[i], grid);
        for (const PathMesh& path : frame.optics[i].paths) {
            if (path.mesh.facets.empty()) continue;
            const std::vector<Id>& seen = path.path == Path::kReflect ? ids.reflected : ids.refracted;
            add(path.path, world.optics[i].mesh, {world.objects, edges, path.mesh, grid, facet, seen, wire});
        }
    }
    return drawing;
}

}  // namespace trilens
