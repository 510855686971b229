// The world: a scene made of triangles to look at, and optics to look through.
#pragma once

#include <memory>
#include <vector>

#include "base/progress.h"
#include "base/surface.h"
#include "scene/scene.h"
#include "shade/shade.h"

namespace trilens {

/// One optic: its exact surface and what it does to light.
struct Optic {
    Id mesh = kNone;                         // object id in images
    std::shared_ptr<const Surface> surface;  // world frame, with the file's normals
    int resolution = 8;
    Id material = kNone;
    bool mirror = true;  // else glass

    std::size_t facet_count() const;  // of the grid at `resolution`
};

/// Everything the engines need; pointers inside point into the world itself, so it stays where it is.
struct World {
    World() = default;
    World(const World&) = delete;
    World& operator=(const World&) = delete;

    Scene scene;
    TriangleScene objects;  // every triangle of the meshes that are objects
    ShadeScene shading;     // of `objects`
    std::vector<Optic> optics;
    std::vector<std::string> names;  // object id -> name
};

/// Builds the surfaces and gathers the triangles. Throws InputError where a cage cannot be used.
std::unique_ptr<World> make_world(Scene scene, const Warn& warn);

}  // namespace trilens
