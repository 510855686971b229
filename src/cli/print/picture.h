// What `trilens render` and `trace` answer of a picture.
#pragma once

#include <trilens/render.h>
#include <string>

#include "terminal/json.h"

namespace trilens {

/// Size, counts, what was left out and seconds: fields of `trilens.render/1` and `trilens.trace/1`.
Json picture_fields(const Renderer& renderer, const Picture& picture);

/// The same of a picture as lines, or, with caustics, of an OBJ.
Json drawing_fields(const Film& film, const LineChoice& choice, const LineDrawing& drawing);

/// One line for those who want to read along.
std::string picture_note(const Picture& picture);

}  // namespace trilens
