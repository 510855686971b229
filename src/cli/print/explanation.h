// One pixel explained, as JSON.
#pragma once

#include <trilens/render.h>

#include "terminal/json.h"

namespace trilens {

/// What the centre of the pixel shows, and how.
Json explanation_json(const Renderer& renderer, const EngineChoice& engine, const PixelExplanation& pixel);

}  // namespace trilens
