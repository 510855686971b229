// Lines of text through OpenImageIO's FreeType.
#pragma once

#include "base/description/marks.h"

namespace trilens {

/// As draw_letters of image_io.h.
TextMask letters_of(const TextStyle& style);

}  // namespace trilens
