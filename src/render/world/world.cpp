#include "render/world/world.h"

#include <algorithm>

#include "base/math/box.h"
#include "base/util/error.h"
#include "render/world/volume_geometry.h"
#include "scene/data/scene_digest.h"
#include "shade/optic_weights.h"
#include "surfaces/memory_budget.h"
#include "surfaces/normal_override.h"
#include "surfaces/surfaces.h"

namespace trilens {
namespace {

/// More facets than this over all optics are refused: they would not fit in memory.
constexpr std::size_t kMaxFacets = 100'000'000;
/// What drawing holds per facet of a mirror at its most: measured, rounded up.
constexpr double kBytesPerFacet = 350;
/// What drawing holds per tetrahedron of a volume: measured, rounded up.
constexpr double kBytesPerCell = 700;

/// What a mesh has per triangle; those of earlier meshes that have none get zeros, those after the last mesh
/// that has some get nothing.
template <typename Corners>
void append_where_given(const std::vector<Corners>& given, std::size_t first_triangle,
                        std::vector<Corners>& all) {
    if (given.empty()) return;
    all.resize(first_triangle);
    all.insert(all.end(), given.begin(), given.end());
}

void append_object(World& world, Id id, const Mesh& mesh) {
    const Id first_point = static_cast<Id>(world.objects.points.size());
    world.objects.points.insert(world.objects.points.end(), mesh.object.points.begin(),
                                mesh.object.points.end());
    const std::size_t count = mesh.object.triangles.size();
    for (std::size_t t = 0; t < count; ++t) {
        IdTriple corner = mesh.object.triangles[t];
        for (Id& c : corner) c += first_point;
        world.objects.triangles.push_back(corner);
        world.objects.object.push_back(id);
        world.objects.primitive.push_back(static_cast<Id>(t));
        world.shading.material.push_back(mesh.object.material[t]);
    }
    append_where_given(mesh.object.uvs, world.objects.size() - count, world.shading.uvs);
    append_where_given(mesh.object.second_uvs, world.objects.size() - count, world.shading.second_uvs);
    append_where_given(mesh.object.normals, world.objects.size() - count, world.shading.normals);
}

/// Room for the triangles of all objects, so that nothing is held twice while it grows.
void reserve_objects(World& world) {
    std::size_t points = 0, triangles = 0;
    for (const Mesh& mesh : world.scene.meshes) {
        if (mesh.role != Role::kObject) continue;
        points += mesh.object.points.size();
        triangles += mesh.object.triangles.size();
    }
    world.objects.points.reserve(points);
    world.objects.triangles.reserve(triangles);
    for (auto* ids : {&world.objects.object, &world.objects.primitive, &world.shading.material})
        ids->reserve(triangles);
}

NormalField normal_field(const NormalOverride& from) {
    NormalField field;
    field.type = from.type == NormalOverride::Type::kSphere  ? NormalField::Type::kSphere
                 : from.type == NormalOverride::Type::kNoise ? NormalField::Type::kNoise
                                                             : NormalField::Type::kSmooth;
    field.center = from.center;
    field.seed = static_cast<std::uint64_t>(from.seed);
    field.amplitude = from.amplitude;
    field.scale = from.scale;
    return field;
}

}  // namespace

std::shared_ptr<const Surface> make_optic_surface(const Scene& scene, Id id, const Warn& warn) {
    const Mesh& mesh = scene.meshes[id];
    std::unique_ptr<Surface> surface = mesh.primitive ? make_primitive_surface(*mesh.primitive)
                                                      : make_limit_surface(mesh.cage, mesh.name, warn);
    if (mesh.normals.type != NormalOverride::Type::kSmooth)
        surface = with_normals(std::move(surface), normal_field(mesh.normals));
    return surface;
}

namespace {

Optic make_optic(const Scene& scene, Id id, const Warn& warn) {
    const Mesh& mesh = scene.meshes[id];
    Optic optic;
    optic.mesh = id;
    optic.resolution = mesh.resolution;
    optic.material = mesh.material;
    optic.mirror = is_mirror(scene.materials[mesh.material]);
    optic.surface = make_optic_surface(scene, id, warn);
    return optic;
}

double diagonal(const TriangleScene& scene) {
    Box box;
    for (const Vec3& p : scene.points) box.include(p);
    const double size = length(box.size());
    return size > 0 ? size : 1;
}

}  // namespace

std::size_t facet_count(const World& world, int resolution) {
    std::size_t total = 0;
    for (const Optic& optic : world.optics)
        total += count_facets(*optic.surface, grid_resolution(optic, resolution));
    return total;
}

void check_facet_count(const World& world, int resolution) {
    const std::size_t total = facet_count(world, resolution);
    if (total > kMaxFacets)
        throw InputError(scene_title(world.scene), "/meshes",
                         "the optics have " + std::to_string(total) + " facets, more than " +
                             std::to_string(kMaxFacets) + "; lower their resolution");
    check_memory({kBytesPerFacet * static_cast<double>(total),
                  "drawing the optics' " + std::to_string(total) + " facets", "lower their resolution"},
                 {machine_memory(), scene_title(world.scene)});
}

namespace {

/// The objects' triangles, and what shading knows of each.
void gather_objects(World& world) {
    world.objects = {};
    world.shading = {};
    reserve_objects(world);
    for (Id id = 0; id < world.scene.meshes.size(); ++id)
        if (world.scene.meshes[id].role == Role::kObject) append_object(world, id, world.scene.meshes[id]);
    world.shading.triangles = &world.objects;
    world.shading.size = diagonal(world.objects);
}

/// What the scene says beside its meshes.
void set_up_shading(World& world) {
    world.names.clear();
    for (const Mesh& mesh : world.scene.meshes) world.names.push_back(mesh.name);
    world.shading.materials = world.scene.materials;
    world.shading.lights = world.scene.lights;
    world.shading.background = world.scene.background;
    prepare_textures(world.shading);
    prepare_lights(world.shading);
    world.shading.occluded = {};
    if (has_shadows(world))
        world.shading.occluded = [self = &world](const Segments& segments) {
            return casts_shadow(*self, segments);
        };
    world.shading.occluded_by_all = {};
    world.shading.caustic = {};
    if (!has_caustics(world)) return;
    world.shading.occluded_by_all = [self = &world](const Segments& segments) {
        return meets_anything(*self, segments);
    };
    world.shading.caustic = [self = &world](std::size_t light, const Receiver& receiver) {
        return irradiance(caustic_lights(*self).by_light[light], receiver);
    };
}

/// The scene's volumes, those that the world has already as they are.
void set_up_volumes(World& world) {
    double cells = 0;
    for (const Volume& volume : world.scene.volumes) cells += static_cast<double>(volume.cells->cells.size());
    if (cells > 0)
        check_memory({kBytesPerCell * cells,
                      "drawing the volumes' " + std::to_string(static_cast<long long>(cells)) + " tetrahedra",
                      "take fewer samples or cells"},
                     {machine_memory(), scene_title(world.scene)});
    std::vector<std::shared_ptr<const VolumeGeometry>> volumes;
    for (const Volume& volume : world.scene.volumes) {
        const auto same = std::find_if(world.volumes.begin(), world.volumes.end(), [&](const auto& kept) {
            return &kept->cells() == volume.cells.get() || kept->cells() == *volume.cells;
        });
        volumes.push_back(same != world.volumes.end() ? *same
                                                      : std::make_shared<VolumeGeometry>(volume.cells));
    }
    world.volumes = std::move(volumes);
}

std::vector<std::string> digests_of(const Scene& scene) {
    std::vector<std::string> digests;
    for (const Mesh& mesh : scene.meshes) digests.push_back(mesh_digest(mesh));
    return digests;
}

}  // namespace

std::unique_ptr<World> make_world(Scene scene, const Warn& warn) {
    auto world = std::make_unique<World>();
    world->scene = std::move(scene);
    for (Id id = 0; id < world->scene.meshes.size(); ++id)
        if (world->scene.meshes[id].role == Role::kOptic)
            world->optics.push_back(make_optic(world->scene, id, warn));
    gather_objects(*world);
    prepare_geometry(*world);
    set_up_shading(*world);
    set_up_volumes(*world);
    return world;
}

SceneReuse change_scene(World& world, Scene scene, const Warn& warn) {
    if (world.mesh_digests.empty()) world.mesh_digests = digests_of(world.scene);
    std::vector<std::string> digests = digests_of(scene);
    const auto is_kept = [&](std::size_t mesh) {
        return mesh < world.mesh_digests.size() && digests[mesh] == world.mesh_digests[mesh];
    };
    SceneReuse kept;
    kept.objects = digests.size() == world.mesh_digests.size();
    std::vector<Optic> optics;
    std::vector<Id> kept_optics;
    for (Id id = 0; id < scene.meshes.size(); ++id) {
        if (scene.meshes[id].role == Role::kObject) {
            kept.objects = kept.objects && is_kept(id);
            continue;
        }
        const auto before = std::find_if(world.optics.begin(), world.optics.end(),
                                         [id](const Optic& optic) { return optic.mesh == id; });
        if (is_kept(id) && before != world.optics.end()) {
            optics.push_back(*before);
            optics.back().mirror = is_mirror(scene.materials[before->material]);
            kept_optics.push_back(static_cast<Id>(before - world.optics.begin()));
            ++kept.optics;
        } else {
            kept.objects = kept.objects && before != world.optics.end();  // it was an object
            optics.push_back(make_optic(scene, id, warn));
            kept_optics.push_back(kNone);
        }
    }

    world.scene = std::move(scene);
    world.optics = std::move(optics);
    world.mesh_digests = std::move(digests);
    if (!kept.objects) gather_objects(world);
    keep_geometry(world, kept_optics, kept.objects);
    set_up_shading(world);
    set_up_volumes(world);
    return kept;
}

}  // namespace trilens
