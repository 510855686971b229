// The world: a scene made of triangles to look at, and optics to look through.
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "base/raymesh/surface.h"
#include "base/util/progress.h"
#include "render/world/scene_reuse.h"
#include "scene/data/scene.h"
#include "shade/shade.h"

namespace trilens {

/// One optic: its exact surface and what it does to light.
struct Optic {
    Id mesh = kNone;                         // object id in images
    std::shared_ptr<const Surface> surface;  // world frame, with the file's normals
    int resolution = 8;                      // of its grid, where nothing else is asked for
    Id material = kNone;
    bool mirror = true;  // else glass
};

struct WorldGeometry;

/// What does not change from picture to picture; pointers inside point into the world itself, so it stays
/// where it is. Thread-safe to read. What is built from it (trees, grids) is in geometry.h.
struct World {
    World();
    ~World();
    World(const World&) = delete;
    World& operator=(const World&) = delete;

    Scene scene;
    TriangleScene objects;  // every triangle of the meshes that are objects
    ShadeScene shading;     // of `objects`
    std::vector<Optic> optics;
    std::vector<std::string> names;  // object id -> name
    std::unique_ptr<WorldGeometry> geometry;
    std::vector<std::string> mesh_digests;  // of scene.meshes, once change_scene has asked for them
};

/// The exact surface of an optic, as a world of that scene has it. Throws InputError where its cage cannot be
/// used.
std::shared_ptr<const Surface> make_optic_surface(const Scene& scene, Id mesh, const Warn& warn);

/// Builds the surfaces and gathers the triangles. Throws InputError where a cage cannot be used.
std::unique_ptr<World> make_world(Scene scene, const Warn& warn);

/// Gives the world another scene. Meshes that are the same in both, at the same index, keep what is built of
/// them. Throws as make_world does, and then nothing has changed. Nobody may draw meanwhile.
SceneReuse change_scene(World& world, Scene scene, const Warn& warn);

/// The resolution of an optic's grid: `asked`, or its own where that is 0.
inline int grid_resolution(const Optic& optic, int asked) {
    return asked > 0 ? asked : optic.resolution;
}

/// The facets of all optics together at that resolution (0: each at its own).
std::size_t facet_count(const World& world, int resolution);

/// Throws InputError where that is too many to hold.
void check_facet_count(const World& world, int resolution);

}  // namespace trilens
