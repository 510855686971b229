// The part of a film that has rays, cell by cell: a quadtree down to where its border is straight, and
// marching squares there (Lorensen and Cline, Marching Cubes, SIGGRAPH 1987, in the plane).
#pragma once

#include <optional>

#include "base/raymesh/ray_mesh.h"
#include "camera/model/camera_model.h"

namespace trilens {

/// The film between two of the camera's breaks in x and two in y. Rays are taken within `low` to `high`, a
/// little inside of the breaks, also for places on them.
struct FilmBlock {
    const CameraModel& model;
    Vec2 low{0}, high{0};
    double size = 1;  // of the film's longer side

    std::optional<Ray> ray(const Vec2& at) const { return model.ray(glm::clamp(at, low, high)); }
};

/// A rectangle of the film, pixels.
struct FilmCell {
    Vec2 low{0}, high{0};
};

/// By places at the cell's corners and in it, at most 8 pixels apart.
enum class CellRays { kNowhere, kPartly, kEverywhere };
CellRays rays_in(const FilmBlock& block, const FilmCell& cell);

/// Adds the part of the cell that has rays, as facets with corners of their own, to within a thousandth of a
/// pixel, or 1e-7 of the film, of its border. Borders of neighbouring cells fit together without gaps.
void add_cut_cell(const FilmBlock& block, const FilmCell& cell, RayMesh& mesh);

}  // namespace trilens
