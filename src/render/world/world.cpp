#include "render/world/world.h"

#include <algorithm>
#include <array>
#include <initializer_list>

#include "base/math/box.h"
#include "base/util/error.h"
#include "render/world/blended_surfaces.h"
#include "render/world/volume_geometry.h"
#include "scene/data/alpha_cut.h"
#include "scene/data/scene_digest.h"
#include "shade/material_maps.h"
#include "shade/optic_weights.h"
#include "surfaces/memory_budget.h"
#include "surfaces/normal_override.h"
#include "surfaces/surfaces.h"
#include "surfaces/texture_places.h"

namespace trilens {
namespace {

/// More facets than this over all optics are refused: they would not fit in memory.
constexpr std::size_t kMaxFacets = 100'000'000;
/// What drawing holds per facet of a mirror at its most: measured, rounded up.
constexpr double kBytesPerFacet = 350;
/// What drawing holds per tetrahedron of a volume: measured, rounded up.
constexpr double kBytesPerCell = 700;

/// What a mesh has per triangle; those of earlier meshes that have none get zeros, those after the last mesh
/// that has some get `nothing`.
template <typename Corners>
void append_where_given(const std::vector<Corners>& given, std::size_t first_triangle,
                        std::vector<Corners>& all, const Corners& nothing = {}) {
    if (given.empty()) return;
    all.resize(first_triangle, nothing);
    all.insert(all.end(), given.begin(), given.end());
}

/// Triangles and what shading knows of them, as they are gathered.
struct Gathered {
    TriangleScene& triangles;
    ShadeScene& shading;

    /// `numbers`: of the mesh's triangles; empty: they are all.
    void append(Id id, const ObjectMesh& mesh, const std::vector<Id>& numbers = {}) const {
        const Id first_point = static_cast<Id>(triangles.points.size());
        triangles.points.insert(triangles.points.end(), mesh.points.begin(), mesh.points.end());
        const std::size_t count = mesh.triangles.size();
        for (std::size_t t = 0; t < count; ++t) {
            IdTriple corner = mesh.triangles[t];
            for (Id& c : corner) c += first_point;
            triangles.triangles.push_back(corner);
            triangles.object.push_back(id);
            triangles.primitive.push_back(numbers.empty() ? static_cast<Id>(t) : numbers[t]);
            shading.material.push_back(mesh.material[t]);
        }
        append_where_given(mesh.uvs, triangles.size() - count, shading.uvs);
        append_where_given(mesh.second_uvs, triangles.size() - count, shading.second_uvs);
        append_where_given(mesh.colors, triangles.size() - count, shading.colors,
                           {Vec4(1), Vec4(1), Vec4(1)});
        append_where_given(mesh.normals, triangles.size() - count, shading.normals);
        append_where_given(mesh.tangents, triangles.size() - count, shading.tangents);
        append_where_given(mesh.baked, triangles.size() - count, shading.baked);
    }
};

/// Those of a mesh's triangles, with the mesh's points.
ObjectMesh part_of(const ObjectMesh& mesh, const std::vector<Id>& numbers) {
    ObjectMesh part;
    part.points = mesh.points;
    const auto take = [&](const auto& all, auto& into) {
        for (const Id t : numbers)
            if (!all.empty()) into.push_back(all[t]);
    };
    take(mesh.triangles, part.triangles);
    take(mesh.uvs, part.uvs);
    take(mesh.second_uvs, part.second_uvs);
    take(mesh.colors, part.colors);
    take(mesh.normals, part.normals);
    take(mesh.tangents, part.tangents);
    take(mesh.material, part.material);
    take(mesh.baked, part.baked);
    return part;
}

/// By material of the scene.
std::vector<Blending> blending_materials(const Scene& scene) {
    std::vector<Blending> blending;
    for (const Material& material : scene.materials) blending.push_back(blending_of(material));
    return blending;
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

/// The normals of a material's map by uv.
MapNormals normals_of_map(const Material& material) {
    return [picture = material.normal_texture.picture, sampler = material.normal_texture.sampler,
            scale = material.normal_scale](const Vec2& uv) {
        return normal_of_texel(lookup(*picture, sampler, sampler.place(uv)), scale);
    };
}

/// Whether optics of both materials have the same normals.
bool has_same_normals(const Material& a, const Material& b) {
    const TextureSampler &s = a.normal_texture.sampler, &t = b.normal_texture.sampler;
    return a.normal_texture.picture == b.normal_texture.picture &&
           (!a.normal_texture.picture ||
            (a.normal_scale == b.normal_scale && s.wrap_s == t.wrap_s && s.wrap_t == t.wrap_t &&
             s.at_zero == t.at_zero && s.along_u == t.along_u && s.along_v == t.along_v &&
             s.uv_set == t.uv_set));
}

}  // namespace

std::unique_ptr<Surface> make_plain_surface(const Mesh& mesh, const Warn& warn) {
    if (mesh.primitive) return make_primitive_surface(*mesh.primitive);
    if (!mesh.patches.empty()) return make_patch_surface(mesh.patches, mesh.name);
    return make_limit_surface(mesh.cage, mesh.name, warn);
}

std::shared_ptr<const Surface> make_optic_surface(const Scene& scene, Id id, const Warn& warn) {
    const Mesh& mesh = scene.meshes[id];
    std::unique_ptr<Surface> surface = make_plain_surface(mesh, warn);
    if (mesh.maps_normals) {
        std::optional<TexturePlaces> places =
            mesh.primitive ? places_on_primitive(*mesh.primitive)
                           : places_on_cage(*surface, mesh.cage, mesh.cage_uvs, mesh.cage_tangents);
        if (places)
            surface = with_normal_map(std::move(surface), std::move(*places),
                                      normals_of_map(scene.materials[mesh.material]));
        else if (warn)
            warn(mesh.name + ": faces were repaired, so that its normal map is ignored");
    }
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

double diagonal(std::initializer_list<const TriangleScene*> scenes) {
    Box box;
    for (const TriangleScene* scene : scenes)
        for (const Vec3& p : scene->points) box.include(p);
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
    const std::vector<Blending> blending = blending_materials(world.scene);
    const Gathered opaque{world.objects, world.shading};
    TriangleScene triangles;
    ShadeScene shading;
    const Gathered blended{triangles, shading};
    for (Id id = 0; id < world.scene.meshes.size(); ++id) {
        if (world.scene.meshes[id].role != Role::kObject) continue;
        const ObjectMesh& mesh = world.scene.meshes[id].object;
        std::array<std::vector<Id>, 2> numbers;  // of opaque triangles, of those that blend
        for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
            numbers[blends(blending[mesh.material[t]], mesh, t) ? 1 : 0].push_back(static_cast<Id>(t));
        if (numbers[1].empty()) {
            opaque.append(id, mesh);
            continue;
        }
        if (!numbers[0].empty()) opaque.append(id, part_of(mesh, numbers[0]), numbers[0]);
        blended.append(id, part_of(mesh, numbers[1]), numbers[1]);
    }
    world.shading.triangles = &world.objects;
    world.shading.size = diagonal({&world.objects, &triangles});
    world.blended.reset();
    if (triangles.size() > 0)
        world.blended = std::make_unique<BlendedSurfaces>(std::move(triangles), std::move(shading));
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
    if (has_caustics(world))
        world.shading.occluded_by_all = [self = &world](const Segments& segments) {
            return meets_anything(*self, segments);
        };
    world.shading.let_through = {};
    if (world.blended && has_shadows(world))
        world.shading.let_through = [self = &world](const Ray& segment) {
            return self->blended->veil(segment).through;
        };
    if (has_caustics(world))
        world.shading.caustic = [self = &world](std::size_t light, const Receiver& receiver) {
            return irradiance_on_surface(*self, light, receiver);
        };
    if (world.blended) world.blended->set_up(world.shading);
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
        if (is_kept(id) && before != world.optics.end() &&
            has_same_normals(world.scene.materials[before->material],
                             scene.materials[scene.meshes[id].material])) {
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

    kept.objects = kept.objects && blending_materials(world.scene) == blending_materials(scene);
    world.scene = std::move(scene);
    world.optics = std::move(optics);
    world.mesh_digests = std::move(digests);
    if (!kept.objects) gather_objects(world);
    keep_geometry(world, kept_optics, kept.objects);
    set_up_shading(world);
    set_up_volumes(world);
    return kept;
}

bool is_rough(const World& world, Id optic) {
    return world.scene.materials[world.optics[optic].material].roughness_factor > 0;
}

bool has_rough_optics(const World& world) {
    for (Id i = 0; i < world.optics.size(); ++i)
        if (is_rough(world, i)) return true;
    return false;
}

}  // namespace trilens
