// Forms that several answers share: vectors, ids, what may be missing, steps of a path.
#pragma once

#include <trilens/render.h>
#include <optional>
#include <span>

#include "terminal/json.h"

namespace trilens {

/// [x, y, z].
Json vector_json(const Vec3& v);

/// Null where there is none.
Json optional_json(const std::optional<double>& value);
Json id_json(Id id);

/// The meetings with optics on the way, in their order.
Json steps_json(const Renderer& renderer, std::span<const Step> steps);

}  // namespace trilens
