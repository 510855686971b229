#include "vector/drawing.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdio>
#include <set>

#include "base/math/box.h"
#include "base/raymesh/rasterize.h"
#include "base/raymesh/surface.h"
#include "base/util/format.h"
#include "projector/projector.h"
#include "render/engines/engine.h"
#include "render/world/blended_surfaces.h"
#include "render/world/world.h"

namespace trilens {
namespace {

constexpr int kSide = 2;       // samples along a pixel's edge that decide what is hidden
constexpr int kBandRows = 32;  // of pixels that are viewed at once

/// What each sample shows, by index.
struct SampleIds {
    std::vector<Id> camera_facet, visible;      // the camera's facet; the triangle of objects and optics
    std::vector<Id> optic, leaf;                // index into World::optics; of its OpticPaths
    std::array<std::vector<Id>, 2> node, seen;  // of the reflected and the refracted path: where it ends, and
                                                // the triangle of the objects there
    std::size_t traced = 0;                     // samples that no facet speaks for
};

constexpr std::array kOpticPaths{Path::kReflect, Path::kRefract};

std::vector<Id> camera_facets(const RayMesh& mesh, const SampleGrid& grid) {
    std::vector<Id> facet(grid.size(), kNone);
    const FacetSamples owned = rasterize_facets(mesh, grid);
    for (std::size_t f = 0; f < mesh.facets.size(); ++f)
        for (const Id s : owned.of(f)) facet[s] = static_cast<Id>(f);
    return facet;
}

/// `first_facet`: where each optic's facets begin among the visible triangles.
SampleIds look(Viewer& viewer, const SampleGrid& grid, const std::vector<Id>& first_facet) {
    SampleIds ids;
    for (std::vector<Id>* list :
         {&ids.visible, &ids.optic, &ids.leaf, &ids.node[0], &ids.node[1], &ids.seen[0], &ids.seen[1]})
        list->assign(grid.size(), kNone);
    SampleViews views;
    for (int y = grid.y0; y < grid.y1; y += kBandRows) {
        const SampleGrid band{grid.x0, y, grid.x1, std::min(y + kBandRows, grid.y1), grid.side};
        viewer.view(band, views);
        const std::size_t first = grid.first_sample(grid.x0, y);
        for (std::size_t s = 0; s < views.samples.size(); ++s) {
            const SampleView& view = views.samples[s];
            const bool optic = view.optic != kNone;
            ids.visible[first + s] = optic ? first_facet[view.optic] + view.facet : view.hit.triangle;
            ids.optic[first + s] = view.optic;
            ids.leaf[first + s] = view.leaf;
            ids.traced += view.traced;
            for (std::size_t p = 0; p < kOpticPaths.size(); ++p) {
                const PathEnd* end = views.find(view, kOpticPaths[p]);
                if (!end || end->node == kNone) continue;
                ids.node[p][first + s] = end->node;
                ids.seen[p][first + s] = end->hit.triangle;
            }
        }
    }
    return ids;
}

/// Which facets have samples.
std::vector<char> seen_facets(const RayMesh& mesh, const std::vector<Id>& facet_of_sample) {
    std::vector<char> seen(mesh.facets.size(), 0);
    for (const Id f : facet_of_sample)
        if (f != kNone && f < seen.size()) seen[f] = 1;
    return seen;
}

/// Diagonal of the box around all that there is to see.
double scene_size(const TriangleScene& visible) {
    Box box;
    for (const Vec3& point : visible.points) box.include(point);
    return box.empty() ? 1 : std::max(length(box.size()), 1e-300);
}

/// The edges of the optic's facets that have samples, those in front of the camera.
void append_facet_edges(const RayMesh& outline, const std::vector<char>& seen, Id optic,
                        std::vector<FacetEdge>& edges) {
    std::vector<std::array<Id, 2>> corners;
    for (std::size_t f = 0; f < seen.size(); ++f)
        for (std::size_t k = 0; seen[f] && k < 3; ++k) {
            const Id a = outline.facets[f][k], b = outline.facets[f][(k + 1) % 3];
            corners.push_back({std::min(a, b), std::max(a, b)});
        }
    std::sort(corners.begin(), corners.end());
    corners.erase(std::unique(corners.begin(), corners.end()), corners.end());
    for (const auto& [a, b] : corners) {
        const Vec3 from = outline.screen[a], to = outline.screen[b];
        if (from.z > 0 && to.z > 0)
            edges.push_back({optic, {from.x / from.z, from.y / from.z}, {to.x / to.z, to.y / to.z}});
    }
}

/// The node's facets of the samples whose path over this optic ends there.
std::vector<Id> facets_at(const SampleIds& ids, Id optic, std::size_t path, Id index, const PathNode& node) {
    std::vector<Id> facet(ids.optic.size(), kNone);
    for (std::size_t s = 0; s < facet.size(); ++s)
        if (ids.optic[s] == optic && ids.node[path][s] == index) facet[s] = node.facet_of(ids.leaf[s]);
    return facet;
}

/// The camera's facets of the samples that see no optic.
std::vector<Id> without_optics(const SampleIds& ids) {
    std::vector<Id> facet = ids.camera_facet;
    for (std::size_t s = 0; s < facet.size(); ++s)
        if (ids.optic[s] != kNone) facet[s] = kNone;
    return facet;
}

/// The nodes at which the samples' paths over this optic end, ascending.
std::vector<Id> nodes_seen(const SampleIds& ids, Id optic, std::size_t path) {
    std::vector<Id> nodes;
    for (std::size_t s = 0; s < ids.optic.size(); ++s)
        if (ids.optic[s] == optic && ids.node[path][s] != kNone) nodes.push_back(ids.node[path][s]);
    std::sort(nodes.begin(), nodes.end());
    nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
    return nodes;
}

/// Lines are of the triangles that end rays.
void warn_of_what_has_no_lines(const World& world, const Warn& warn) {
    std::string names;
    const auto add = [&](const std::string& name) { names += (names.empty() ? "" : ", ") + name; };
    if (world.blended) {
        const std::vector<Id>& objects = world.blended->triangles().object;
        for (const Id object : std::set<Id>(objects.begin(), objects.end()))
            add(world.scene.meshes[object].name);
    }
    for (const Volume& volume : world.scene.volumes) add(volume.name);
    if (!names.empty()) warn("surfaces that blend and volumes have no lines: " + names);
}

}  // namespace

std::unique_ptr<Drawing> make_drawing(const World& world, const FrameParams& params, const LineChoice& lines,
                                      const Warn& warn) {
    auto drawing = std::make_unique<Drawing>();
    drawing->width = world.scene.film.width, drawing->height = world.scene.film.height,
    drawing->lines = lines;
    // Lines are made of the optic's own facets alone, undivided.
    FrameParams plain = params;
    plain.max_error = kAnyError;
    plain.layered = false;
    plain.facets = FacetUse::kAll;
    // Caustics are where neighbouring rays meet: of rays that are exact at the corners. A fit is nearer in
    // between, but its slopes are not: rays that stay parallel would meet far away.
    if (lines.caustics) plain.rays = CornerRays::kInterpolated;
    Frame frame = make_frame(world, plain, warn);
    frame.fit_all = true;
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
    const std::unique_ptr<Viewer> viewer = make_facet_viewer(world, frame, Engine::kExact);
    SampleIds ids = look(*viewer, grid, first_facet);
    if (ids.traced > 0 && warn)
        warn(fmt::format("no lines where paths are traced, not projected: {:.2f} % of the film",
                         100.0 * static_cast<double>(ids.traced) / static_cast<double>(grid.size())));
    if (warn && !lines.caustics) warn_of_what_has_no_lines(world, warn);
    ids.camera_facet = camera_facets(frame.camera.mesh, grid);

    const double size = lines.caustics ? scene_size(drawing->visible) : 0;
    const auto object_of = [&](Id triangle) { return world.objects.object[triangle]; };
    const auto first_hit = [&](const Ray& ray) { return object_tracer(world).first_hit(ray); };
    const auto add_folds = [&](const RayMesh& mesh, const std::vector<Id>& facets) {
        DrawingLayer& layer = *drawing->layers.back();
        if (lines.folds) layer.folds = fold_curves({mesh, grid, facets, first_hit, object_of});
        if (lines.caustics) layer.caustic = caustic_sheets({mesh, seen_facets(mesh, facets), size});
    };
    const auto add = [&](Path path, Id optic, const VectorView& view) {
        auto layer = std::make_unique<DrawingLayer>();
        layer->path = path_name(path), layer->optic = optic, layer->scene = &view.scene;
        layer->curves = edge_curves(view);
        drawing->layers.push_back(std::move(layer));
    };
    if (world.scene.render.direct) {
        const DrawnEdges edges = drawn_edges(drawing->visible, {material, world.objects.size()});
        add(Path::kDirect, kNone,
            {drawing->visible, edges, frame.camera.mesh, grid, ids.camera_facet, ids.visible, lines.wire});
        // Rays through one eye, or all alike, have no folds and no caustic but the eye.
        const auto& model = frame.camera.model;
        if (!frame.camera.linear && !(model && model->eye()))
            add_folds(frame.camera.mesh, without_optics(ids));
    }
    for (Id i = 0; lines.facets && i < world.optics.size(); ++i) {
        const RayMesh& outline = viewer->paths(i).outline;
        std::vector<char> seen(outline.facets.size(), 0);
        for (std::size_t s = 0; s < ids.visible.size(); ++s)
            if (ids.optic[s] == i && ids.visible[s] - first_facet[i] < seen.size())
                seen[ids.visible[s] - first_facet[i]] = 1;
        append_facet_edges(outline, seen, world.optics[i].mesh, drawing->facet_edges);
    }
    const DrawnEdges edges = drawn_edges(world.objects, {material, world.objects.size()});
    for (Id i = 0; i < world.optics.size(); ++i)
        for (std::size_t p = 0; p < kOpticPaths.size(); ++p)
            for (const Id index : nodes_seen(ids, i, p)) {
                const OpticPaths& paths = viewer->paths(i);
                const PathNode& node = paths.nodes[index];
                const std::vector<Id> facets = facets_at(ids, i, p, index, node);
                add(kOpticPaths[p], world.optics[i].mesh,
                    {world.objects, edges, node.mesh, grid, facets, ids.seen[p], lines.wire});
                add_folds(node.mesh, facets);
                for (EdgeCurve& curve : drawing->layers.back()->curves) {
                    const Id facet = paths.leaves[node.leaves[curve.facet]].facet;
                    curve.facet = paths.is_on_film() ? facet : frame.optics[i].grid_facet(facet);
                }
            }
    drawing->marks = place_marks(world, params);
    if (warn) tell_marks(world, drawing->marks, warn);
    return drawing;
}

// Caustics and fold curves of a drawing in the world, as a Wavefront OBJ.

namespace {

/// A name without blanks, as OBJ's readers want it.
std::string word(const std::string& name) {
    std::string out;
    for (const char c : name) out += std::isgraph(static_cast<unsigned char>(c)) || (c & 0x80) ? c : '_';
    return out;
}

void append_points(const std::vector<Vec3>& points, std::string& obj) {
    char line[100];
    for (const Vec3& p : points) {
        std::snprintf(line, sizeof line, "v %.9g %.9g %.9g\n", p.x, p.y, p.z);
        obj += line;
    }
}

std::string layer_name(const DrawingLayer& layer, const World& world) {
    return layer.optic == kNone ? "camera" : word(world.names[layer.optic]) + "-" + layer.path;
}

}  // namespace

std::string drawing_obj(const Drawing& drawing, const World& world) {
    std::string obj =
        "# Caustics: where neighbouring rays that leave the camera or an optic meet (first and second "
        "sheet;\n"
        "# virtual: behind the optic), and as lines the fold curves: where caustics lie on what is seen.\n";
    std::size_t count = 0;  // of points so far
    const auto start = [&](const std::string& name, const std::vector<Vec3>& points) {
        obj += "o " + name + "\n";
        append_points(points, obj);
        count += points.size();
        return count - points.size() + 1;
    };
    for (const auto& layer : drawing.layers) {
        for (const CausticSheet& sheet : layer->caustic) {
            const std::size_t first =
                start(layer_name(*layer, world) + (sheet.sheet == 0 ? "-first" : "-second") +
                          (sheet.is_virtual ? "-virtual" : ""),
                      sheet.points);
            for (const IdTriple& t : sheet.triangles)
                obj += "f " + std::to_string(first + t[0]) + " " + std::to_string(first + t[1]) + " " +
                       std::to_string(first + t[2]) + "\n";
            for (const auto& s : sheet.segments)
                obj += "l " + std::to_string(first + s[0]) + " " + std::to_string(first + s[1]) + "\n";
        }
        for (const FoldCurve& fold : layer->folds) {
            if (fold.object == kNone) continue;  // in the environment, at no place
            std::size_t at =
                start(layer_name(*layer, world) + "-fold-on-" + word(world.names[fold.object]), fold.places);
            obj += "l";
            for (std::size_t i = 0; i < fold.places.size(); ++i) obj += " " + std::to_string(at++);
            obj += "\n";
        }
    }
    return obj;
}

}  // namespace trilens
