// What `trilens project` and `explain` answer: images of points as JSON and as CSV, one pixel explained; the
// forms that answers share.
#pragma once

#include <trilens/project.h>
#include <trilens/render.h>

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "terminal/libraries.h"

namespace trilens {

// What `trilens project` answers: the images of points, as JSON and as CSV.

/// A list with an entry per point, `images[p]` those of `points[p]`: the field `points` of
/// `trilens.project/1`.
Json points_json(const Renderer& renderer, std::span<const Vec3> points,
                 std::span<const PointProjection> images);

/// A header and a line per meeting with an optic, of refined images.
std::string point_steps_text(const Renderer& renderer, std::span<const PointProjection> images);

/// A header and a line per image.
std::string points_text(const Renderer& renderer, std::vector<PointProjection> images);

// One pixel explained, as JSON.

/// What the centre of the pixel shows, and how.
Json explanation_json(const Renderer& renderer, const EngineChoice& engine, const PixelExplanation& pixel);

// Forms that several answers share: vectors, ids, what may be missing, steps of a path.

/// [x, y, z].
Json vector_json(const Vec3& v);

/// Null where there is none.
Json optional_json(const std::optional<double>& value);
Json id_json(Id id);

/// The meetings with optics on the way, in their order.
Json steps_json(const Renderer& renderer, std::span<const Step> steps);

}  // namespace trilens
