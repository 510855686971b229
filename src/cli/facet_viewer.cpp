#include "cli/facet_viewer.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/facet_scene.h"
#include "base/parallel.h"
#include "cli/optic_meshes.h"
#include "projector/projector.h"
#include "truth/tracer.h"

namespace trilens {
namespace {

/// One optic, and where its facets begin in the visible scene.
struct SeenOptic {
    OpticMeshes meshes;
    Id first_triangle = 0;
};

/// The engine's work on one RayMesh: nearest triangles of the objects, or of all that the camera can see.
using DrawMesh = std::function<void(const RayMesh&, const FacetSamples&, const SampleGrid&, std::span<Hit>)>;

/// All facet engines: the projectors and Embree on the same rays.
struct FacetViewer {
    const World* world = nullptr;
    CameraRays camera;
    std::vector<SeenOptic> optics;
    DrawMesh draw_visible, draw_objects;
    bool redraw_direct = false;  // the camera's own view of the objects is draw_objects', not draw_visible's

    void operator()(const SampleGrid& grid, std::span<SampleView> views) const;

  private:
    void draw_direct(const FacetSamples& owned, const SampleGrid& grid, std::span<Hit> first) const;
    void view_optic(std::size_t index, const SampleGrid& grid, std::span<const Hit> first,
                    std::span<SampleView> views) const;
    void view_path(const RayMesh& mesh, const SampleGrid& grid, std::span<const Id> owner,
                   std::span<SampleView> views, SecondaryView SampleView::*path) const;
    void describe_optic(std::size_t index, const Hit& hit, SampleView& view) const;
};

Vec3 corner_weights(const Hit& hit) {
    return {1 - hit.barycentric.x - hit.barycentric.y, hit.barycentric.x, hit.barycentric.y};
}

void FacetViewer::describe_optic(std::size_t index, const Hit& hit, SampleView& view) const {
    const SurfaceGrid& grid = optics[index].meshes.grid;
    view.optic = static_cast<Id>(index);
    view.facet = hit.triangle - optics[index].first_triangle;
    const Vec3 weights = corner_weights(hit);
    const IdTriple& corner = grid.facets[view.facet];
    Vec3 normal(0);
    for (int k = 0; k < 3; ++k) {
        const std::size_t c = static_cast<std::size_t>(k);
        normal += weights[k] * grid.corner_normal[corner[c]];
        view.uv += weights[k] * grid.facet_uv[view.facet][c];
    }

    // The side is the facet's own; the angle that of the interpolated normal, grazing where it turned away.
    const auto point = [&](std::size_t c) { return grid.points[grid.corner_point[corner[c]]]; };
    const Vec3 chord = cross(point(1) - point(0), point(2) - point(0));
    view.front = dot(chord, view.ray.direction) <= 0;
    const Vec3 unit = normalize_or_zero(normal) * (view.front ? 1.0 : -1.0);
    view.cos_incident = std::clamp(-dot(normalize_or_zero(view.ray.direction), unit), 0.0, 1.0);
}

void FacetViewer::view_path(const RayMesh& mesh, const SampleGrid& grid, std::span<const Id> owner,
                            std::span<SampleView> views, SecondaryView SampleView::*path) const {
    if (mesh.facets.empty()) return;
    const FacetSamples owned = group_by_facet(owner, mesh.facets.size());
    std::vector<Hit> hits(grid.size());
    draw_objects(mesh, owned, grid, hits);
    parallel_for(mesh.facets.size(), 64, [&](std::size_t from, std::size_t to) {
        for (std::size_t f = from; f < to; ++f) {
            if (!mesh.has_rays(f) || owned.of(f).empty()) continue;
            const FacetWeights weights = facet_weights(mesh, f);
            if (weights.edge_on) continue;
            for (const Id s : owned.of(f)) {
                const Vec2 at = grid.position(s);
                const Vec3 e = weights.unnormalised(at.x, at.y);
                SecondaryView& secondary = views[s].*path;
                secondary.has_ray = true;
                secondary.ray = interpolated_ray(mesh, f, e / (e.x + e.y + e.z));
                secondary.hit = hits[s];
            }
        }
    });
}

void FacetViewer::view_optic(std::size_t index, const SampleGrid& grid, std::span<const Hit> first,
                             std::span<SampleView> views) const {
    const OpticMeshes& meshes = optics[index].meshes;
    const Id begin = optics[index].first_triangle, end = begin + static_cast<Id>(meshes.grid.facets.size());
    std::vector<Id> owner(grid.size(), kNone);
    bool any = false;
    for (std::size_t s = 0; s < grid.size(); ++s) {
        const Id triangle = first[s].triangle;
        if (triangle == kNone || triangle < begin || triangle >= end) continue;
        owner[s] = triangle - begin;
        views[s].hit = {};
        describe_optic(index, first[s], views[s]);
        any = true;
    }
    if (!any) return;
    view_path(meshes.reflect, grid, owner, views, &SampleView::reflect);
    view_path(meshes.refract, grid, owner, views, &SampleView::refract);
}

/// Where no optic is first, what the objects alone show.
void FacetViewer::draw_direct(const FacetSamples& owned, const SampleGrid& grid, std::span<Hit> first) const {
    std::vector<Hit> objects(grid.size());
    draw_objects(camera.mesh, owned, grid, objects);
    for (std::size_t s = 0; s < first.size(); ++s)
        if (!first[s].seen() || first[s].triangle < world->objects.size()) first[s] = objects[s];
}

void FacetViewer::operator()(const SampleGrid& grid, std::span<SampleView> views) const {
    const FacetSamples owned = rasterize_facets(camera.mesh, grid);
    std::vector<Hit> first(grid.size());
    draw_visible(camera.mesh, owned, grid, first);
    if (redraw_direct) draw_direct(owned, grid, first);
    set_camera_rays(camera.mesh, owned, grid, views);
    for (std::size_t s = 0; s < grid.size(); ++s) {
        views[s].hit = first[s];
        if (first[s].seen()) views[s].depth = first[s].t;
    }
    for (std::size_t i = 0; i < optics.size(); ++i) view_optic(i, grid, first, views);
}

}  // namespace

Viewer make_facet_viewer(const World& world, CameraRays camera, const EngineChoice& engine,
                         const Warn& warn) {
    check_facet_count(world);
    FacetViewer viewer;
    viewer.world = &world;
    TriangleScene visible = world.objects;
    for (const Optic& optic : world.optics) {
        OpticMeshes meshes = make_optic_meshes(world, optic, *camera.linear);
        const Id first_triangle = static_cast<Id>(visible.size());
        append_facets(meshes.grid, optic.mesh, visible);
        const auto bad =
            std::count(meshes.grid.corner_normal.begin(), meshes.grid.corner_normal.end(), Vec3(0));
        if (bad > 0)
            warn(world.names[optic.mesh] + ": " + std::to_string(bad) +
                 " grid corners have no normal; the facets there show nothing");
        viewer.optics.push_back({std::move(meshes), first_triangle});
    }
    viewer.camera = std::move(camera);
    if (engine.engine != Engine::kFacetsTruth) {
        auto all = std::make_shared<PreparedScene>(visible),
             objects = std::make_shared<PreparedScene>(world.objects);
        viewer.draw_visible = [all](const RayMesh& mesh, const FacetSamples& owned, const SampleGrid& grid,
                                    std::span<Hit> hits) { draw(*all, mesh, owned, grid, hits); };
        viewer.draw_objects = [objects](const RayMesh& mesh, const FacetSamples& owned,
                                        const SampleGrid& grid,
                                        std::span<Hit> hits) { draw(*objects, mesh, owned, grid, hits); };
        if (engine.engine == Engine::kClassic) {
            viewer.redraw_direct = true;
            viewer.draw_objects = [objects, params = engine.classic](
                                      const RayMesh& mesh, const FacetSamples& owned, const SampleGrid& grid,
                                      std::span<Hit> hits) {
                draw_classic(*objects, mesh, owned, grid, hits, params);
            };
        }
    } else {
        auto all = std::make_shared<Tracer>(visible), objects = std::make_shared<Tracer>(world.objects);
        viewer.draw_visible = [all](const RayMesh& mesh, const FacetSamples& owned, const SampleGrid& grid,
                                    std::span<Hit> hits) { trace_facets(*all, mesh, owned, grid, hits); };
        viewer.draw_objects = [objects](const RayMesh& mesh, const FacetSamples& owned,
                                        const SampleGrid& grid, std::span<Hit> hits) {
            trace_facets(*objects, mesh, owned, grid, hits);
        };
    }
    return [shared = std::make_shared<FacetViewer>(std::move(viewer))](
               const SampleGrid& grid, std::span<SampleView> views) { (*shared)(grid, views); };
}

}  // namespace trilens
