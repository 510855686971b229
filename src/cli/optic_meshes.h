// An optic as facets: its grid, and the RayMeshes that look away from it.
#pragma once

#include "base/ray_mesh.h"
#include "base/surface.h"
#include "cli/world.h"

namespace trilens {

struct LinearCamera;

/// Facets of the RayMeshes are those of the grid; a RayMesh is empty where the scene does not draw its path
/// or the optic has none.
struct OpticMeshes {
    SurfaceGrid grid;
    RayMesh reflect, refract;
};

/// Throws InputError where the optics together have too many facets to hold.
void check_facet_count(const World& world);

/// The optic's grid at its own resolution, seen by the camera.
OpticMeshes make_optic_meshes(const World& world, const Optic& optic, const LinearCamera& camera);

}  // namespace trilens
