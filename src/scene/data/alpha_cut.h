// Cut-outs: triangles cut along the line where their picture's opacity falls below the cutoff (glTF's
// alphaMode MASK), so that every engine, shadow and reflection sees the same holes.
#pragma once

#include <cstddef>
#include <vector>

#include "scene/data/scene.h"

namespace trilens {

/// Which surfaces of a material show what lies behind in part: those at whose corners the mesh's own colours
/// have an alpha below 1 (kByColors), or all.
enum class Blending { kNever, kByColors, kAll };
Blending blending_of(const Material& material);

/// Whether one of the mesh's triangles does, whose material blends so.
bool blends(Blending material, const ObjectMesh& mesh, std::size_t triangle);

/// What was done.
struct AlphaCut {
    std::size_t cut = 0;       // triangles that were cut or taken away
    std::size_t colored = 0;   // triangles of masks whose corners have an alpha of their own, not cut by it
    std::size_t too_fine = 0;  // triangles that stand whole: their pictures repeat too often on them
};

/// Takes away what is less opaque than the cutoff of the triangles' materials. Opacity is the alpha channel
/// of the base colour's picture, bilinear between its texels, times `alpha_factor`; its contour is followed
/// exactly along the texels' grid and its half steps, and straight between [marching squares: Lorensen and
/// Cline 1987, in the plane]; where opaque corners face each other, opacity's own saddle says whether they
/// are joined. Pieces without area are left out. uvs, normals and materials go with the pieces. Materials of
/// another alpha_mode than kMask are left alone.
AlphaCut cut_by_alpha(ObjectMesh& mesh, const std::vector<Material>& materials);

}  // namespace trilens
