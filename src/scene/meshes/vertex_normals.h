// Normals of a polygon mesh's points: the mean of the faces around each, weighted by their angles there.
#pragma once

#include <cstddef>
#include <vector>

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

/// For each point the first one at the same place.
std::vector<std::size_t> first_at_place(const std::vector<Vec3>& points);

/// What a face brings to the mean normal at each of its corners: its unit normal, on the side that shows it
/// anticlockwise, times its angle there in radians; zero in holes and where a face has no area.
std::vector<Vec3> corner_normals(const Cage& cage);
/// Sums of them that are shorter cancel but for rounding, and have no direction.
inline constexpr double kCancelled = 1e-9;

/// Gives every corner without a normal (none at all, or zero) the unit mean of the normals of the faces that
/// meet at its point, each weighted by its angle there [Thuermer, Wuethrich, Computing Vertex Normals from
/// Polygonal Facets, 1998], in the mesh's frame, on the side that shows the faces anticlockwise. Points at
/// one place count as one, whatever their indices, so that seams of textures do not show; holes and faces
/// without area take no part. A corner whose faces cancel keeps zero: it is lit by its triangle's own normal.
void add_smooth_normals(PolygonMesh& mesh);

/// Leaves the mesh the normals that `shading` asks for.
void set_shading(PolygonMesh& mesh, ObjectShading shading);

}  // namespace trilens
