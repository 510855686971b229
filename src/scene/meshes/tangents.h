// Tangents of an object's normal map, one for each corner, where its file has none.
#pragma once

#include <vector>

#include "base/description/material.h"
#include "scene/data/scene.h"

namespace trilens {

/// Gives tangents to each triangle that has a normal map and no tangents of its file; takes them from all
/// whose materials have no normal map, and leaves the mesh without any where none has one.
///
/// The tangent of a corner is a unit vector at right angles to its normal (its triangle's, where the mesh has
/// none): the mean direction of growing u over the triangles of its group, each direction laid into the plane
/// of the normal and weighted by the triangle's angle there, seen along the normal. A group are triangles of
/// one material around one vertex (corners with the same place, normal and uv), from edge to edge, whose uv
/// turn the same way: w is 1 where they turn as the corners do, -1 where the map is mirrored; v grows along
/// w cross(normal, tangent). Triangles whose uv have no area say no direction; they belong to the first group
/// that reaches them, and where none does they have any tangent that lies in the surface. These are the
/// tangents that glTF 2.0 asks for (section 3.7.2.1), but of the mesh as it stands in the world.
/// Source: Mikkelsen, Simulation of Wrinkled Surfaces Revisited, Copenhagen 2008, section 3.4.
void add_tangents(ObjectMesh& mesh, const std::vector<Material>& materials);

}  // namespace trilens
