#include "cli/optic_meshes.h"

#include "base/error.h"
#include "reflect/reflection.h"
#include "refract/refraction.h"
#include "surfaces/machine_memory.h"
#include "surfaces/surfaces.h"

namespace trilens {
namespace {

/// More facets than this over all optics are refused: they would not fit in memory.
constexpr std::size_t kMaxFacets = 100'000'000;
/// What drawing holds per facet of a mirror at its most: measured, rounded up.
constexpr double kBytesPerFacet = 350;

}  // namespace

void check_facet_count(const World& world) {
    std::size_t total = 0;
    for (const Optic& optic : world.optics) total += optic.facet_count();
    if (total > kMaxFacets)
        throw InputError(world.scene.file, "/meshes",
                         "the optics have " + std::to_string(total) + " facets, more than " +
                             std::to_string(kMaxFacets) + "; lower their resolution");
    check_memory({kBytesPerFacet * static_cast<double>(total),
                  "drawing the optics' " + std::to_string(total) + " facets", "lower their resolution"},
                 {machine_memory(), world.scene.file});
}

OpticMeshes make_optic_meshes(const World& world, const Optic& optic, const LinearCamera& camera) {
    OpticMeshes meshes;
    meshes.grid = make_grid(*optic.surface, optic.resolution);
    if (world.scene.render.reflect) meshes.reflect = make_reflection(meshes.grid, camera);
    if (world.scene.render.refract && !optic.mirror)
        meshes.refract = make_refraction(meshes.grid, camera, world.scene.materials[optic.material].ior);
    return meshes;
}

}  // namespace trilens
