// One pixel explained: every ray, hit and weight behind it, as JSON.
#pragma once

#include "cli/json.h"
#include "cli/picture.h"

namespace trilens {

/// What the centre of pixel (x, y) shows and how. Throws UsageError outside the film.
Json explain_pixel(const World& world, const PictureRequest& request, int x, int y, Console& console);

}  // namespace trilens
