// The RayMesh of a camera that is not linear: exact rays at the corners of a grid over the film.
#pragma once

#include <optional>

#include "base/raymesh/ray_mesh.h"
#include "camera/model/camera_model.h"

namespace trilens {

/// About n x n cells of two facets; lines of the grid run along the camera's breaks, where corners are
/// double, each with the ray of its own side. Screens are affine (w = 1). Of cells that reach beyond the part
/// of the film that has rays that part is left, cut finer along its border (see add_cut_cell).
RayMesh make_film_mesh(const CameraModel& model, const FilmSize& film, int n);

/// How far the mesh is from the exact rays: for the middles of every facet and of its edges, the points that
/// the mesh's ray passes at the camera's focus and far away, and where the exact camera shows them. In x a
/// pixel counts as CameraModel::stretch says. Places within 8 pixels of a fold of the camera's own picture,
/// where a displacement has no bound, are not judged, nor those as near to where rays end at which no exact
/// ray is found to pass the point.
struct FilmError {
    double pixels = 0;  // the largest
    Vec2 at{0};         // where on the film
};
FilmError film_error(const CameraModel& model, const FilmSize& film, const RayMesh& mesh);

/// The coarsest mesh found whose film_error is at most the tolerance, or none up to most x most cells;
/// `error` is then that of the finest tried.
struct TolerantMesh {
    std::optional<RayMesh> mesh;
    int n = 0;
    FilmError error;
};
TolerantMesh make_film_mesh_within(const CameraModel& model, const FilmSize& film, double tolerance,
                                   int most);

}  // namespace trilens
