#include "camera/model/camera_model.h"

#include <cmath>

namespace trilens {

std::vector<FilmImage> film_images(const CameraModel& model, const FilmSize& film, const Vec3& point) {
    std::vector<FilmImage> images;
    const auto on_film = [&](const Vec2& at) {
        return at.x >= 0 && at.y >= 0 && at.x <= film.width && at.y <= film.height;
    };
    std::optional<FilmImage> beyond;
    const auto add = [&](const FilmImage& found, std::size_t branch) {
        if (!(found.t >= 0)) return;
        bool any = false;
        const double period = model.period();
        double x = found.pixel.x;
        if (period > 0) x -= period * std::floor(x / period);
        do {
            FilmImage image = found;
            image.pixel.x = x;
            if (on_film(image.pixel) && model.shows(branch, image.pixel) && model.ray(image.pixel)) {
                images.push_back(image);
                any = true;
            }
            x += period;
        } while (period > 0 && x <= film.width);
        if (!any && model.branch_count() == 1 && model.ray(found.pixel)) beyond = found;
    };
    for (std::size_t branch = 0; branch < model.branch_count(); ++branch)
        for (const FilmImage& found : model.places(point, branch)) add(found, branch);
    if (images.empty() && beyond) images.push_back(*beyond);
    return images;
}

}  // namespace trilens
