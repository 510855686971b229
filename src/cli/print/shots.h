// What `trilens shoot` answers: rays and their meetings with optics, as JSON and as CSV.
#pragma once

#include <trilens/project.h>
#include <string>

#include "terminal/libraries.h"

namespace trilens {

/// A list with an entry per ray: the field `rays` of `trilens.shoot/1`.
Json shots_json(const Renderer& renderer, const ShotRays& shots);

/// A header and a line per ray.
std::string shots_text(const Renderer& renderer, const ShotRays& shots);

/// A header and a line per meeting.
std::string shot_events_text(const Renderer& renderer, const ShotRays& shots);

/// The same as fields of CSV, from optic to normal_z.
std::string event_csv(std::span<const OpticInfo> optics, const PathEvent& event);

/// One meeting with an optic, as JSON; `optics`: Renderer::optics().
Json event_json(std::span<const OpticInfo> optics, const PathEvent& event);

}  // namespace trilens
