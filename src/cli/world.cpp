#include "cli/world.h"

#include <algorithm>

#include "base/check.h"
#include "base/facet_scene.h"
#include "surfaces/normal_override.h"
#include "surfaces/surfaces.h"
#include "truth/tracer.h"

namespace trilens {
namespace {

/// Resolution of the surfaces that only cast shadows, lower on those that would have too many facets.
constexpr int kShadowResolution = 16;
constexpr std::size_t kMostShadowFacets = 1'000'000;

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
        world.shading.uvs.push_back(mesh.object.uvs.empty() ? std::array<Vec2, 3>{} : mesh.object.uvs[t]);
        world.shading.normals.push_back(mesh.object.normals.empty() ? std::array<Vec3, 3>{}
                                                                    : mesh.object.normals[t]);
    }
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

Optic make_optic(const Scene& scene, Id id, const Warn& warn) {
    const Mesh& mesh = scene.meshes[id];
    Optic optic;
    optic.mesh = id;
    optic.resolution = mesh.resolution;
    optic.material = mesh.material;
    optic.mirror = scene.materials[mesh.material].transmission_factor < 1;
    std::unique_ptr<Surface> surface = mesh.primitive ? make_primitive_surface(*mesh.primitive)
                                                      : make_limit_surface(mesh.cage, mesh.name, warn);
    if (mesh.normals.type != NormalOverride::Type::kSmooth)
        surface = with_normals(std::move(surface), normal_field(mesh.normals));
    optic.surface = std::move(surface);
    return optic;
}

/// Whether any light asks what lies between it and a point.
bool has_shadows(const Scene& scene) {
    return std::any_of(scene.lights.begin(), scene.lights.end(),
                       [](const Light& light) { return light.shadows; });
}

/// Objects and mirrors cast shadows; glass lets the light through.
TriangleScene shadow_casters(const World& world) {
    TriangleScene casters = world.objects;
    for (const Optic& optic : world.optics) {
        if (!optic.mirror) continue;
        const int n = resolution_within(*optic.surface, kShadowResolution, kMostShadowFacets);
        append_facets(make_grid(*optic.surface, n), optic.mesh, casters);
    }
    return casters;
}

double diagonal(const TriangleScene& scene) {
    if (scene.points.empty()) return 1;
    Vec3 low = scene.points.front(), high = low;
    for (const Vec3& p : scene.points) {
        low = glm::min(low, p);
        high = glm::max(high, p);
    }
    const double size = length(high - low);
    return size > 0 ? size : 1;
}

}  // namespace

std::size_t Optic::facet_count() const {
    return count_facets(*surface, resolution);
}

std::unique_ptr<World> make_world(Scene scene, const Warn& warn) {
    auto world = std::make_unique<World>();
    world->scene = std::move(scene);
    for (Id id = 0; id < world->scene.meshes.size(); ++id) {
        const Mesh& mesh = world->scene.meshes[id];
        world->names.push_back(mesh.name);
        if (mesh.role == Role::kObject) {
            append_object(*world, id, mesh);
        } else {
            world->optics.push_back(make_optic(world->scene, id, warn));
        }
    }

    world->shading.triangles = &world->objects;
    world->shading.materials = world->scene.materials;
    world->shading.lights = world->scene.lights;
    world->shading.background = world->scene.background;
    world->shading.size = diagonal(world->objects);
    if (has_shadows(world->scene)) {
        auto tracer = std::make_shared<Tracer>(shadow_casters(*world));
        world->shading.occluded = [tracer](const Vec3& from, const Vec3& to) {
            return tracer->occluded({from, to - from}, 0.0, 1.0);
        };
    }
    return world;
}

}  // namespace trilens
