// Where the film shows what searches on an optic's exact surface found.
#include <algorithm>

#include "render/project/image_weight.h"
#include "render/project/point_projector.h"

namespace trilens {
namespace {

/// An image through the facets this near to an exact one, in pixels, is taken for the same.
constexpr double kSameImage = 3;

/// An exact image farther from the facets' than this, in pixels, is another one.
constexpr double kFilmReach = 16;

}  // namespace

/// Of a camera with an eye whose film is not linear, the images as points of the surface; their pixels mean
/// nothing but tell them apart.
std::vector<SpecularSearch> PointProjector::search(const OpticPath& path,
                                                   std::span<const Vec3> points) const {
    if (!searches_surfaces()) return std::vector<SpecularSearch>(points.size());
    const SpecularQuery query = specular_query(world_, frame_, path.optic, path.path);
    const SpecularSearcher& searcher = *searcher_[path.optic];
    return path.path == Path::kRefract ? searcher.find_each_in_body(query, points)
                                       : searcher.find_each(query, points);
}

/// Where the film shows what a search found on the surface.
std::vector<OpticImage> PointProjector::images_on_film(const OpticPath& path,
                                                       const SpecularSearch& searched) const {
    std::vector<OpticImage> images;
    for (const SpecularPoint& exact : searched.images) {
        const Id facet = facets_at_[path.optic].at(exact.at.face, exact.at.uv);
        const auto add = [&](const Vec2& pixel) { images.push_back(optic_image(exact, facet, pixel)); };
        if (camera_.linear) add(exact.pixel);
        if (camera_.model)
            for (const FilmImage& image : film_positions(camera_, exact.position)) add(image.pixel);
    }
    return images;
}

namespace {

/// A facets' image, moved to an exact one.
OpticImage on_film_image(const HistoryImage& exact, OpticImage image) {
    const PathEvent& last = exact.events.back();
    image.pixel = exact.pixel;
    image.t = exact.distance / exact.first_way;
    image.length = exact.distance;
    image.from = last.point;
    image.at = {last.face, last.uv};
    image.normal = last.normal;
    image.refined = true;
    return image;
}

}  // namespace

/// Through a camera without one eye: each image of the facets is moved to where the exact ray passes through
/// the point; two that come to one place count once.
void PointProjector::refine_on_film(const OpticPath& path, const Vec3& point,
                                    std::vector<OpticImage>& images) const {
    const Event event = path.path == Path::kReflect ? Event::kReflect : Event::kTransmit;
    const HistoryQuery query = history_query(world_, frame_, {{path.optic, event}}, point);
    std::vector<OpticImage> kept;
    for (OpticImage image : images) {
        const auto exact = refine_history_image(query, image.pixel);
        if (exact && length(exact->pixel - image.pixel) < kFilmReach) image = on_film_image(*exact, image);
        const bool known = std::any_of(kept.begin(), kept.end(), [&](const OpticImage& one) {
            return one.refined && image.refined && length(one.pixel - image.pixel) < kSamePixels;
        });
        if (!known) kept.push_back(image);
    }
    images = std::move(kept);
}

std::vector<OpticImage> PointProjector::optic_images(const OpticPath& path, const Vec3& point,
                                                     const SpecularSearch& searched,
                                                     PointProjection& result) const {
    if (!searches_surfaces()) {
        result.complete = false;
        std::vector<OpticImage> images =
            path.facets->images(point, request_.refine && camera_.linear.has_value());
        if (request_.refine && !camera_.linear) refine_on_film(path, point, images);
        return images;
    }
    std::vector<OpticImage> found = images_on_film(path, searched);
    if (searched.complete) return found;
    result.complete = false;
    const bool refine = camera_.linear.has_value();
    const std::size_t exact = found.size();
    for (const OpticImage& more :
         path.facets->images(point, refine, refine ? searched.images : std::vector<SpecularPoint>())) {
        const auto is_known = [&](const OpticImage& known) {
            return !refine && length(known.pixel - more.pixel) < kSameImage;
        };
        const auto end = found.begin() + static_cast<std::ptrdiff_t>(exact);
        if (std::none_of(found.begin(), end, is_known)) found.push_back(more);
    }
    return found;
}

}  // namespace trilens
