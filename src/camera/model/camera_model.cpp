#include "camera/model/camera_model.h"

#include <cmath>

#include "base/util/error.h"

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

namespace {

// Sine of the angle between `up` and the view axis below which the film's roll would be rounding noise.
constexpr double kSmallestSine = 1e-9;

}  // namespace

void CameraSite::reject(const std::string& field, const std::string& message) const {
    const bool both = !place.empty() && !field.empty();
    throw InputError(file, place + (both ? "/" : "") + field, message);
}

bool is_finite_vector(const Vec3& v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

FilmAxes make_film_axes(const Placement& look_at, const CameraSite& site) {
    if (!is_finite_vector(look_at.eye) || !is_finite_vector(look_at.at) || !is_finite_vector(look_at.up))
        site.reject("lookAt", "eye, at and up must be finite numbers");
    FilmAxes axes;
    axes.forward = normalize_or_zero(look_at.at - look_at.eye);
    if (axes.forward == Vec3(0)) site.reject("lookAt", "eye and at are the same point");
    const Vec3 right = cross(axes.forward, normalize_or_zero(look_at.up));
    if (!(length(right) > kSmallestSine)) site.reject("lookAt", "up is zero or parallel to the view axis");
    axes.right = normalize(right);
    axes.up = cross(axes.right, axes.forward);
    return axes;
}

void require_film(double width, double height, const CameraSite& site) {
    if (!(width >= 1 && height >= 1)) site.reject("film", "width and height must be at least one pixel");
    if (!std::isfinite(width) || !std::isfinite(height)) site.reject("film", "width or height is not finite");
}

}  // namespace trilens
