// What `trilens project` answers: the images of points, as JSON and as CSV.
#pragma once

#include <trilens/project.h>
#include <span>
#include <string>
#include <vector>

#include "terminal/json.h"

namespace trilens {

/// A list with an entry per point, `images[p]` those of `points[p]`: the field `points` of
/// `trilens.project/1`.
Json points_json(const Renderer& renderer, std::span<const Vec3> points,
                 std::span<const PointProjection> images);

/// A header and a line per meeting with an optic, of refined images.
std::string point_steps_text(const Renderer& renderer, std::span<const PointProjection> images);

/// A header and a line per image.
std::string points_text(const Renderer& renderer, std::vector<PointProjection> images);

}  // namespace trilens
