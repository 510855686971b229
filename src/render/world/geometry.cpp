#include "render/world/world.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <mutex>

#include "base/raymesh/flat_face.h"
#include "scene/data/scene_digest.h"
#include "surfaces/surfaces.h"

namespace trilens {
namespace {

/// Facets of the fine grid that finds the face under a ray; Newton then finds the exact point. Fewer leave
/// more to Newton's method near silhouettes, more take longer to prepare, and memory that caches do not hold.
constexpr std::size_t kFineFacets = 100'000;
constexpr int kMinFine = 4, kMaxFine = 256;
/// Cages of so many faces that kMinFine goes beyond this have small faces, which need less: about 1 GB here.
constexpr std::size_t kMostFineFacets = 2'000'000;

/// Squares along a side of the parts that are prepared together, when a ray first comes near.
constexpr int kPartSteps = 4;
/// Faces of surfaces that have more are such parts themselves, held by their hulls: bounds by parts would
/// take some 50 kB of each. So many facets all of them have together, and so many squares along a side.
constexpr std::size_t kManyFaces = 5000, kFineOfMany = 800'000;
constexpr int kMinFineOfMany = 2, kMaxFineOfMany = 5;

/// Facets of the grid whose patches beams are held against.
constexpr std::size_t kPatches = 20'000;
constexpr int kMostPatches = 24;  // along a face

int patch_resolution(const Surface& surface) {
    const double per_face = static_cast<double>(kPatches) /
                            (2.0 * static_cast<double>(std::max<std::size_t>(1, surface.face_count())));
    const int n = std::clamp(static_cast<int>(std::sqrt(per_face)), 1, kMostPatches);
    return resolution_within(surface, n, kMostFineFacets);
}

/// Whether every face is flat and its parameters are affine: its facets are the face itself.
bool is_polyhedron(const Surface& surface) {
    for (Id face = 0; face < surface.face_count(); ++face) {
        const std::optional<FlatFace> flat = FlatFace::of(surface, face);
        if (!flat || !flat->is_affine()) return false;
    }
    return true;
}

/// Facets of all faces together, and squares along a side of each.
struct FineGrid {
    std::size_t facets = 0;
    int least = 0, most = 0;
};

int fine_resolution(const Surface& surface, const FineGrid& grid) {
    if (is_polyhedron(surface)) return 1;
    const double faces = static_cast<double>(std::max<std::size_t>(1, surface.face_count())),
                 per_face = static_cast<double>(grid.facets) / (2.0 * faces);
    return std::clamp(static_cast<int>(std::sqrt(per_face)), grid.least, grid.most);
}

int fine_resolution(const Surface& surface) {
    return resolution_within(surface, fine_resolution(surface, {kFineFacets, kMinFine, kMaxFine}),
                             kMostFineFacets);
}

/// Prepared as far as rays come, where the surface says what holds its parts.
std::unique_ptr<LimitTracer> make_limit_tracer(const Surface& surface) {
    if (surface.has_closed_form()) return std::make_unique<LimitTracer>(surface, SurfaceGrid{});
    std::vector<Box> hulls;
    if (surface.face_count() > kManyFaces) hulls = face_hulls(surface);
    const bool by_face = !hulls.empty();
    const int n = by_face ? fine_resolution(surface, {kFineOfMany, kMinFineOfMany, kMaxFineOfMany})
                          : fine_resolution(surface),
              steps = by_face ? n : kPartSteps;
    std::vector<GridPart> parts = grid_parts(surface, n, steps);
    std::vector<Box> boxes = by_face ? std::move(hulls) : part_boxes(surface, n, parts);
    if (boxes.empty())
        return std::make_unique<LimitTracer>(surface, make_grid(surface, fine_resolution(surface)));
    return std::make_unique<LimitTracer>(
        surface, LimitTracer::Parts{std::move(boxes), [&surface, n, parts = std::move(parts)](Id part) {
                                        return make_part_grid(surface, n, parts[part]);
                                    }});
}

}  // namespace

/// What is kept of one optic.
struct OpticGeometry {
    Lazy<LimitTracer> limit;
    Lazy<FaceNeighbours> neighbours;
    Lazy<PatchTree> patches;
    std::mutex mutex;  // of the two below
    int resolution = 0;
    std::shared_ptr<const OpticFacets> facets;
};

/// What is kept of all objects.
struct ObjectGeometry {
    Lazy<PreparedScene> prepared;
    Lazy<Tracer> tracer;
};

namespace {

/// A digest of all but meshes that beams are made of.
std::string light_digest(const Scene& scene) {
    Scene lit;
    lit.background = scene.background;
    lit.materials = scene.materials;
    lit.lights = scene.lights;
    lit.render = scene.render;
    return scene_digest(lit);
}

}  // namespace

/// What is kept of the lights whose light is followed.
struct CausticGeometry {
    Lazy<CausticLights> lights;
    CausticLights* made = nullptr;
    std::string of;  // the scene's lights and what they meet, when they were made

    bool is_of(const Scene& scene) const { return made && of == light_digest(scene); }
};

struct WorldGeometry {
    std::shared_ptr<ObjectGeometry> objects = std::make_shared<ObjectGeometry>();
    Lazy<PathWorld> paths;
    // Of pictures, and of receivers that ask for exact rays.
    std::array<std::shared_ptr<CausticGeometry>, 2> caustics{std::make_shared<CausticGeometry>(),
                                                             std::make_shared<CausticGeometry>()};
    std::vector<std::shared_ptr<OpticGeometry>> optic;
};

World::World() = default;
World::~World() = default;

void prepare_geometry(World& world) {
    keep_geometry(world, std::vector<Id>(world.optics.size(), kNone), false);
}

void keep_geometry(World& world, const std::vector<Id>& kept_optics, bool keeps_objects) {
    auto geometry = std::make_unique<WorldGeometry>();
    if (keeps_objects) geometry->objects = world.geometry->objects;
    for (const Id before : kept_optics)
        geometry->optic.push_back(before == kNone ? std::make_shared<OpticGeometry>()
                                                  : world.geometry->optic[before]);
    bool keeps_optics = world.geometry && kept_optics.size() == world.geometry->optic.size();
    for (std::size_t i = 0; i < kept_optics.size(); ++i) keeps_optics = keeps_optics && kept_optics[i] == i;
    std::vector<CausticGeometry*> kept_lights;
    for (std::size_t k = 0; keeps_objects && keeps_optics && k < geometry->caustics.size(); ++k) {
        if (!world.geometry->caustics[k]->is_of(world.scene)) continue;
        geometry->caustics[k] = world.geometry->caustics[k];
        kept_lights.push_back(geometry->caustics[k].get());
    }
    world.geometry = std::move(geometry);
    // Beams point to these optics, which point into the scene.
    for (CausticGeometry* kept : kept_lights) kept->made->optics = optics_for_lights(world);
}

TriangleScene OpticFacets::scene() const {
    TriangleScene scene;
    append_facets(grid_, object_, scene);
    return scene;
}

const PreparedScene& OpticFacets::prepared() const {
    return prepared_.get([this] { return std::make_unique<PreparedScene>(scene()); });
}

const Tracer& OpticFacets::tracer() const {
    return tracer_.get([this] { return std::make_unique<Tracer>(scene()); });
}

const PreparedScene& prepared_objects(const World& world) {
    return world.geometry->objects->prepared.get(
        [&] { return std::make_unique<PreparedScene>(world.objects); });
}

const Tracer& object_tracer(const World& world) {
    return world.geometry->objects->tracer.get([&] {
        // The world's own triangles, which stay in place as long as what is built of them.
        const std::shared_ptr<const TriangleScene> in_place(std::shared_ptr<void>(), &world.objects);
        return std::make_unique<Tracer>(in_place);
    });
}

const LimitTracer& limit_tracer(const World& world, std::size_t optic) {
    return world.geometry->optic[optic]->limit.get(
        [&] { return make_limit_tracer(*world.optics[optic].surface); });
}

const FaceNeighbours& face_neighbours(const World& world, std::size_t optic) {
    return world.geometry->optic[optic]->neighbours.get(
        [&] { return std::make_unique<FaceNeighbours>(*world.optics[optic].surface); });
}

const PathWorld& path_world(const World& world) {
    return world.geometry->paths.get([&] {
        const RenderSettings& settings = world.scene.render;
        auto paths = std::make_unique<PathWorld>();
        paths->max_depth = settings.max_depth;
        paths->fresnel = settings.fresnel;
        paths->reflect = settings.reflect;
        paths->refract = settings.refract;
        paths->objects = &object_tracer(world);
        for (std::size_t i = 0; i < world.optics.size(); ++i) {
            const Optic& optic = world.optics[i];
            const Surface* surface = optic.surface.get();
            const std::shared_ptr<OpticGeometry> kept = world.geometry->optic[i];
            paths->optics.push_back({&limit_tracer(world, i), &world.scene.materials[optic.material],
                                     optic.mirror, world.scene.meshes[optic.mesh].priority,
                                     surface->sphere_curvature() > 0, [surface, kept]() -> const PatchTree& {
                                         return kept->patches.get([&] {
                                             return std::make_unique<PatchTree>(
                                                 *surface, make_grid(*surface, patch_resolution(*surface)));
                                         });
                                     }});
        }
        return paths;
    });
}

bool has_shadows(const World& world) {
    return std::any_of(world.scene.lights.begin(), world.scene.lights.end(), is_hindered);
}

Segments::Bits casts_shadow(const World& world, const Segments& segments) {
    Segments::Bits hidden = object_tracer(world).occluded(segments);
    for (std::size_t i = 0; i < world.optics.size(); ++i)
        if (world.optics[i].mirror)
            hidden |= limit_tracer(world, i).occluded(segments, segments.all() & ~hidden);
    return hidden;
}

Segments::Bits meets_anything(const World& world, const Segments& segments) {
    Segments::Bits hidden = object_tracer(world).occluded(segments);
    for (std::size_t i = 0; i < world.optics.size(); ++i)
        hidden |= limit_tracer(world, i).occluded(segments, segments.all() & ~hidden);
    return hidden;
}

const CausticLights& caustic_lights(const World& world, bool exact, const Progress& progress) {
    CausticGeometry& kept = *world.geometry->caustics[exact];
    return kept.lights.get([&] {
        const BeamGridParams params =
            exact ? BeamGridParams::truth(BeamGridParams().tolerance) : BeamGridParams();
        std::unique_ptr<CausticLights> made = make_caustic_lights(world, params, progress);
        kept.made = made.get();
        kept.of = light_digest(world.scene);
        return made;
    });
}

const CausticLights* known_caustic_lights(const World& world, bool exact) {
    return world.geometry->caustics[exact]->lights.find();
}

void prepare_shadows(const World& world, bool exact, const Progress& progress) {
    if (!has_shadows(world)) return;
    object_tracer(world);
    for (std::size_t i = 0; i < world.optics.size(); ++i)
        if (world.optics[i].mirror) limit_tracer(world, i);
    if (has_caustics(world)) caustic_lights(world, exact, progress);
}

void prepare_optics(const World& world, const OpticNeeds& needs, const Progress& progress) {
    if (needs.facets) check_facet_count(world, needs.resolution);
    const std::size_t count = world.optics.size();
    progress.begin_stage("surfaces of " + std::to_string(count) + " optics");
    for (std::size_t i = 0; i < count; ++i) {
        progress.stop_if_cancelled();
        progress(static_cast<double>(i) / static_cast<double>(count));
        if (needs.exact_rays) limit_tracer(world, i);
        if (!needs.facets) continue;
        const auto facets = optic_facets(world, i, grid_resolution(world.optics[i], needs.resolution));
        if (needs.projected) facets->prepared();
        if (needs.traced) facets->tracer();
    }
    progress(1);
}

std::shared_ptr<const OpticFacets> optic_facets(const World& world, std::size_t optic, int n) {
    OpticGeometry& kept = *world.geometry->optic[optic];
    const std::lock_guard lock(kept.mutex);
    if (!kept.facets || kept.resolution != n) {
        kept.facets.reset();  // the old one goes first, unless a picture still uses it
        kept.facets = std::make_shared<OpticFacets>(make_grid(*world.optics[optic].surface, n),
                                                    world.optics[optic].mesh);
        kept.resolution = n;
    }
    return kept.facets;
}

}  // namespace trilens
