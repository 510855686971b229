// Displacement maps: points of a mesh moved along its normals by heights.
#pragma once

#include <cstddef>
#include <vector>

#include "scene/data/polygons.h"

namespace trilens {

/// Most triangles that a displaced mesh is divided into.
inline constexpr std::size_t kMostDisplacedTriangles = std::size_t{1} << 22;

/// Divides every face, all of which are triangles, into n x n alike ones, row by row. What goes with corners
/// is straight between them, normals made unit again. A point between two corners is the same for both faces
/// of their edge, bit for bit.
void divide_triangles(PolygonMesh& mesh, int n);

/// Which heights move a mesh's points.
struct FaceHeights {
    std::vector<HeightMap> maps;
    std::vector<Id> of_face;  // per face an index into `maps`, or kNone: at height 0
};

/// What of the heights a mesh does not show.
struct DisplacementLoss {
    std::size_t without_normal = 0;  // points that have heights, but no direction to be moved in
    double greatest = 0;             // between points: how far edges pass from the heights under them
    double range = 0;                // of all heights there are: the highest less the lowest
};

/// Moves each point by its height along its normal: the mean of its corners' own normals, else of the faces
/// around it, weighted by angles (see corner_normals). Points at one place count as one; where the heights of
/// their corners differ, as at a seam of uv, they get the mean, so that nothing gapes. Corners that had
/// normals get new ones, the mean of the moved faces around them; corners at one place that shared a normal
/// share the new one, so that sharp edges stay sharp. What stays where it was keeps its bits. The mesh has
/// the sets of uv that the maps are of.
DisplacementLoss displace(PolygonMesh& mesh, const FaceHeights& by);

}  // namespace trilens
