// Warm-started projection: Newton's method on the chain of surfaces from where images were.
#include <algorithm>
#include <limits>
#include <memory>

#include "base/util/check.h"
#include "base/util/parallel.h"
#include "render/frame/camera_rays.h"
#include "render/project/image_light.h"
#include "render/project/project.h"

namespace trilens {
namespace {

constexpr std::size_t kStartsPerTask = 64;
/// Places of a surface that lie no farther apart than this, relative to their size, are one.
constexpr double kSamePlace = 1e-9;

/// The optics' glass and mirrors, without their surfaces: enough to tell how light parts.
PathWorld materials_alone(const World& world) {
    PathWorld paths;
    paths.fresnel = world.scene.render.fresnel;
    for (const Optic& optic : world.optics)
        paths.optics.push_back({nullptr, &world.scene.materials[optic.material], optic.mirror,
                                world.scene.meshes[optic.mesh].priority, false});
    return paths;
}

/// Refines images of one camera.
class ImageRefiner {
  public:
    ImageRefiner(const World& world, const ProjectRequest& request)
        : world_(world), request_(request), materials_(materials_alone(world)), sight_(world, frame_, true) {
        frame_.camera = make_camera_rays(world.scene, request.frame.camera);
        frame_.camera_media = camera_media_of(world, frame_.camera);
        if (!request.parameters.empty())
            parameters_ = std::make_unique<ParameterDerivatives>(world, frame_, request.frame.camera,
                                                                 request.parameters);
    }

    std::optional<WorldImage> refine(const ImageStart& start, const Vec3& point) const {
        std::optional<WorldImage> image =
            start.events.empty() ? refine_direct(start, point) : refine_chain(start, point);
        if (image && parameters_) image->by_parameter = parameters_->of(*image, {point});
        return image;
    }

  private:
    std::optional<WorldImage> refine_chain(const ImageStart& start, const Vec3& point) const;
    std::optional<WorldImage> refine_direct(const ImageStart& start, const Vec3& point) const;
    std::vector<FilmImage> shown(const Vec3& place, const ImageStart& start) const;
    std::optional<ChainImage> solved_from(const ImageStart& start, const Vec3& point) const;
    bool on_film(const Vec2& pixel) const;
    std::optional<Vec3> weight_of(std::span<const PathEvent> events, const Ray& view,
                                  const Vec3& point) const;
    bool is_visible(const WorldImage& image, const Vec3& eye, const Vec3& point) const;

    const World& world_;
    const ProjectRequest& request_;
    Frame frame_;  // camera alone
    PathWorld materials_;
    OcclusionQueries sight_;
    std::unique_ptr<ParameterDerivatives> parameters_;  // where some are asked for
};

std::optional<Vec3> ImageRefiner::weight_of(std::span<const PathEvent> events, const Ray& view,
                                            const Vec3& point) const {
    if (events.size() == 1 && chain_eye(frame_.camera)) {
        const PathEvent& one = events.front();
        const Path path = one.event == Event::kReflect ? Path::kReflect : Path::kRefract;
        return weight_over_one(world_, frame_, {one.optic, path, view, one.point, one.front, point});
    }
    return weight_over_several(
        materials_,
        {frame_.camera_media.none() ? Media() : frame_.camera_media.of(view), view.origin, events, point});
}

bool ImageRefiner::is_visible(const WorldImage& image, const Vec3& eye, const Vec3& point) const {
    const std::vector<PathEvent>& events = image.events;
    if (!sight_.sees(eye, events.front().point) || !sight_.is_free_of_objects(events.back().point, point))
        return false;
    for (std::size_t i = 0; i + 1 < events.size(); ++i)
        if (!sight_.is_free_of_objects(events[i].point, events[i + 1].point)) return false;
    return true;
}

bool ImageRefiner::on_film(const Vec2& pixel) const {
    const Film& film = world_.scene.film;
    return pixel.x >= 0 && pixel.y >= 0 && pixel.x <= film.width && pixel.y <= film.height;
}

/// Where the film shows a place, that next to the start's pixel first: it tells apart the branches of a
/// camera that has several.
std::vector<FilmImage> ImageRefiner::shown(const Vec3& place, const ImageStart& start) const {
    std::vector<FilmImage> found = film_positions(frame_.camera, place);
    if (start.pixel)
        std::stable_sort(found.begin(), found.end(), [&](const FilmImage& a, const FilmImage& b) {
            return length(a.pixel - *start.pixel) < length(b.pixel - *start.pixel);
        });
    return found;
}

std::optional<WorldImage> ImageRefiner::refine_direct(const ImageStart& start, const Vec3& point) const {
    const std::vector<FilmImage> found = shown(point, start);
    if (found.empty()) return std::nullopt;
    WorldImage image;
    image.pixel = found.front().pixel;
    image.t = found.front().t;
    image.length = length(point - found.front().origin);
    image.refined = true;
    image.weight =
        weight_of_direct(world_, frame_, {found.front().origin, point - found.front().origin}, image.length);
    image.inside = on_film(image.pixel);
    image.visible = request_.visibility && image.inside && sight_.sees(found.front().origin, point);
    const std::optional<FilmPlace> film = film_place(frame_.camera, point, image.pixel);
    image.has_derivative = film.has_value();
    if (film) image.derivative = film->slope;
    return image;
}

std::optional<ChainImage> ImageRefiner::solved_from(const ImageStart& start, const Vec3& point) const {
    if (std::any_of(start.events.begin(), start.events.end(),
                    [](const PathEvent& event) { return event.face == kNone; }))
        return std::nullopt;
    const PathEvent& first = start.events.front();
    const Vec3 there = world_.optics[first.optic].surface->eval(first.face, first.uv).position;
    std::vector<Vec2> places;
    for (const FilmImage& image : shown(there, start)) places.push_back(image.pixel);
    if (chain_eye(frame_.camera))
        return solve_image(world_, frame_, {start.events, places.empty() ? Vec2(0) : places.front()},
                           {point});
    if (start.pixel) places.push_back(*start.pixel);
    std::optional<ChainImage> nearest;
    double least = std::numeric_limits<double>::infinity();
    for (const Vec2& place : places) {
        std::optional<ChainImage> solved = solve_any_image(world_, frame_, {start.events, place}, {point});
        const double off = solved ? length(solved->events.front().point - there) : least;
        if (off + kSamePlace * (1 + length(there)) < least) nearest = std::move(solved), least = off;
    }
    return nearest;
}

std::optional<WorldImage> ImageRefiner::refine_chain(const ImageStart& start, const Vec3& point) const {
    const PathEvent& first = start.events.front();
    const auto solved = solved_from(start, point);
    if (!solved) return std::nullopt;
    const std::optional<Ray> view = exact_ray(frame_.camera, solved->film.pixel);
    const std::optional<Vec3> weight = view ? weight_of(solved->events, *view, point) : std::nullopt;
    if (!weight) return std::nullopt;

    WorldImage image;
    image.path = first.event == Event::kReflect ? Path::kReflect : Path::kRefract;
    image.optic = first.optic;
    image.object = world_.optics[first.optic].mesh;
    image.pixel = solved->film.pixel;
    image.events = solved->events;
    for (const PathEvent& event : image.events) image.steps.push_back({event.optic, event.event});
    image.length = length(point - image.events.back().point);
    image.t = image.length / length(image.events.front().point - view->origin);
    image.refined = true;
    image.weight = *weight;
    image.has_derivative = solved->is_regular;
    image.derivative = solved->derivative;
    image.inside = on_film(image.pixel);
    image.visible = request_.visibility && image.inside && is_visible(image, view->origin, point);
    return image;
}

}  // namespace

std::vector<std::optional<WorldImage>> refine_images(const World& world, const ProjectRequest& request,
                                                     std::span<const Vec3> points,
                                                     std::span<const ImageStart> starts) {
    const ImageRefiner refiner(world, request);
    std::vector<std::optional<WorldImage>> images(starts.size());
    parallel_for(starts.size(), kStartsPerTask, [&](std::size_t from, std::size_t to) {
        for (std::size_t i = from; i < to; ++i) {
            TRILENS_CHECK(starts[i].point < points.size(), "a start is of a point");
            images[i] = refiner.refine(starts[i], points[starts[i].point]);
        }
    });
    return images;
}

}  // namespace trilens
