#include "render/explain.h"

#include "base/error.h"
#include "base/format.h"
#include "render/engine.h"
#include "render/sample_colour.h"

namespace trilens {

PixelExplanation explain_pixel(const World& world, const PictureRequest& request, int x, int y) {
    const Film& film = world.scene.film;
    if (x < 0 || y < 0 || x >= film.width || y >= film.height)
        throw UsageError(
            fmt::format("the pixel {},{} is outside the {} x {} film", x, y, film.width, film.height));
    PixelExplanation explained;
    explained.x = x;
    explained.y = y;
    make_viewer(world, request.frame, request.engine, {})({x, y, x + 1, y + 1, 1}, explained.views);
    explained.colour = sample_colour(world, explained.views, explained.view());
    return explained;
}

}  // namespace trilens
