// A cage from a triangle mesh, whose points stand there once per texture seam and crease.
#pragma once

#include "scene/data/polygons.h"

namespace trilens {

/// Makes points at one place (bit for bit; 0 and -0 are one) one point. Faces that lose a corner by it are
/// dropped with their corners' entries.
void weld_points(PolygonMesh& mesh);

/// Joins each two triangles that follow each other, share an edge and lie nearly in one plane (kNearlyFlat)
/// to the quad that a program cut in two; the rest stays. What corners have goes with them.
void join_quads(PolygonMesh& mesh);
inline constexpr double kNearlyFlat = 0.8;  // cosine of the angle between the normals

/// Cuts all faces into triangles; holes are left out. Returns how many cross themselves: they became fans
/// that do not cover them.
std::size_t cut_into_triangles(PolygonMesh& mesh);

}  // namespace trilens
