// Normals of a polygon mesh's points: the mean of the faces around each, weighted by their angles there.
#pragma once

#include "base/util/names.h"
#include "scene/data/polygons.h"

namespace trilens {

/// Which normals light an object: those that its file or primitive gives, else its triangles' own; always its
/// triangles' own; those that are given, else the mean of the faces around each point.
enum class ObjectShading { kGivenNormals, kFlatNormals, kSmoothNormals };

template <>
struct EnumNames<ObjectShading> {
    static constexpr std::array kTable{NamedValue<ObjectShading>{ObjectShading::kGivenNormals, "given"},
                                       NamedValue<ObjectShading>{ObjectShading::kFlatNormals, "flat"},
                                       NamedValue<ObjectShading>{ObjectShading::kSmoothNormals, "smooth"}};
};

/// Gives every corner without a normal (none at all, or zero) the unit mean of the normals of the faces that
/// meet at its point, each weighted by its angle there [Thuermer, Wuethrich, Computing Vertex Normals from
/// Polygonal Facets, 1998], in the mesh's frame, on the side that shows the faces anticlockwise. Points at
/// one place count as one, whatever their indices, so that seams of textures do not show; holes and faces
/// without area take no part. A corner whose faces cancel keeps zero: it is lit by its triangle's own normal.
void add_smooth_normals(PolygonMesh& mesh);

/// Leaves the mesh the normals that `shading` asks for.
void set_shading(PolygonMesh& mesh, ObjectShading shading);

}  // namespace trilens
