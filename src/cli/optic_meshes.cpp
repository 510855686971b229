#include "cli/optic_meshes.h"

#include "reflect/reflection.h"
#include "refract/refraction.h"
#include "surfaces/surfaces.h"

namespace trilens {

OpticMeshes make_optic_meshes(const World& world, const Optic& optic, const LinearCamera& camera) {
    OpticMeshes meshes;
    meshes.grid = make_grid(*optic.surface, optic.resolution);
    if (world.scene.render.reflect) meshes.reflect = make_reflection(meshes.grid, camera);
    if (world.scene.render.refract && !optic.mirror)
        meshes.refract = make_refraction(meshes.grid, camera, world.scene.materials[optic.material].ior);
    return meshes;
}

}  // namespace trilens
