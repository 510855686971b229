#include "inverse/maps/film_images.h"

#include <array>

#include "render/project/project.h"
#include "render/world/world.h"

namespace trilens {
namespace {

constexpr double kHalfPixel = 0.25;  // differences: from so much before to so much behind

bool is_asked_for(const World& world, const FilmImagesParams& params, const WorldImage& image) {
    if ((!image.inside && !params.beyond_film) || image.weight == Vec3(0)) return false;
    if (!image.visible) return false;
    if (image.path == Path::kDirect) return params.path == Path::kDirect;
    if (!image.refined) return false;  // nobody knows how far it is off
    if (params.optic && image.optic != *params.optic) return false;
    const Path wanted =
        params.path.value_or(world.optics[image.optic].mirror ? Path::kReflect : Path::kRefract);
    return image.path == wanted;
}

std::uint64_t history_of(const WorldImage& image) {
    std::uint64_t hash = 14695981039346656037ull;  // FNV-1a
    for (const Step& step : image.steps)
        hash = (hash ^ (std::uint64_t{step.optic} << 2 | static_cast<std::uint64_t>(step.event))) *
               1099511628211ull;
    return hash;
}

Mat2 jacobian_of(const WorldImage& image, const WorldPlace& place) {
    Mat2 jacobian;
    for (int row = 0; row < 2; ++row) {
        jacobian[0][row] = dot(image.derivative[static_cast<std::size_t>(row)], place.dx);
        jacobian[1][row] = dot(image.derivative[static_cast<std::size_t>(row)], place.dy);
    }
    return jacobian;
}

/// The image of `moved` that continues this one.
const WorldImage* nearest_image(const PointProjection& moved, const WorldImage& from) {
    const WorldImage* nearest = nullptr;
    for (const WorldImage& image : moved.images)
        if (image.path == from.path && image.steps == from.steps &&
            (!nearest || length(image.pixel - from.pixel) < length(nearest->pixel - from.pixel)))
            nearest = &image;
    return nearest;
}

/// Central differences for images without a derivative: entry k of `lacking` is place[k].
struct Lacking {
    std::size_t place = 0;
    std::size_t image = 0;  // of that place's MapImages
    WorldImage of;
};

void add_differences(const World& world, const ProjectRequest& request,
                     std::span<const std::optional<WorldPlace>> places, const std::vector<Lacking>& lacking,
                     std::span<MapImages> images) {
    if (lacking.empty()) return;
    std::vector<Vec3> points;
    for (const Lacking& one : lacking) {
        const WorldPlace& place = *places[one.place];
        for (const Vec3& step : {place.dx, place.dy})
            for (const double side : {-kHalfPixel, kHalfPixel}) points.push_back(place.point + side * step);
    }
    const std::vector<PointProjection> moved = project_points(world, request, points);
    for (std::size_t k = 0; k < lacking.size(); ++k) {
        std::array<const WorldImage*, 4> found;
        bool whole = true;
        for (std::size_t i = 0; i < 4; ++i) {
            found[i] = nearest_image(moved[4 * k + i], lacking[k].of);
            whole = whole && found[i];
        }
        if (!whole) continue;
        Mat2& jacobian = images[lacking[k].place][lacking[k].image].jacobian;
        for (int axis = 0; axis < 2; ++axis) {
            const auto first = static_cast<std::size_t>(2 * axis);
            jacobian[axis] = (found[first + 1]->pixel - found[first]->pixel) / (2 * kHalfPixel);
        }
    }
}

}  // namespace

void find_film_images(const World& world, const FilmImagesParams& params,
                      std::span<const std::optional<WorldPlace>> places, std::span<MapImages> images) {
    std::vector<Vec3> points;
    std::vector<std::size_t> place_of;
    for (std::size_t i = 0; i < places.size(); ++i) {
        if (!places[i]) continue;
        points.push_back(places[i]->point);
        place_of.push_back(i);
    }
    ProjectRequest request;
    request.frame = params.frame;
    request.visible_at_optics = !params.objects_hide;
    request.derivatives = true;
    const std::vector<PointProjection> found = project_points(world, request, points, {{}, params.cancel});
    std::vector<Lacking> lacking;
    for (std::size_t k = 0; k < found.size(); ++k)
        for (const WorldImage& image : found[k].images) {
            if (!is_asked_for(world, params, image)) continue;
            MapImages& here = images[place_of[k]];
            if (!image.has_derivative) lacking.push_back({place_of[k], here.size(), image});
            here.push_back(
                {image.pixel, jacobian_of(image, *places[place_of[k]]), image.weight, history_of(image)});
        }
    request.derivatives = request.visibility = false;
    add_differences(world, request, places, lacking, images);
}

}  // namespace trilens
