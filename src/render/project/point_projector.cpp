#include "render/project/point_projector.h"

#include <algorithm>
#include <functional>
#include <limits>

#include "base/math/box.h"
#include "base/util/error.h"
#include "reflect/reflection.h"
#include "render/project/image_light.h"

namespace trilens {
namespace {

/// A point nearer to the eye's plane than this share of the coordinates has no direct image: rounding put it
/// there.
constexpr double kLeastDepth = 1e-12;

/// The cosine of the angle by which an image that only facets have may miss its point, on the exact surface.
constexpr double kLeastCosine = 0.866;

/// Points farther from the middle than this many times the size of the optics and the eye about them are
/// searched for at that distance, and then moved: beyond it rounding tells images of neighbouring faces
/// apart.
constexpr double kReachInSizes = 1e6;
/// From so many points on it pays to know what an optic hides of itself.
constexpr std::size_t kManyPoints = 4000;
/// An image of a point that was searched for within reach is another one if it moves by more pixels than
/// this.
constexpr double kMostMove = 8;

/// Exact images need facets as places to start from alone: those that are seen, with the rays at their
/// corners.
FrameParams frame_of_seeds(const ProjectRequest& request) {
    FrameParams frame = request.frame;
    if (request.refine && !frame.rays) frame.rays = CornerRays::kInterpolated;
    return frame;
}

}  // namespace

PointProjector::PointProjector(const World& world, const ProjectRequest& request)
    : world_(world),
      request_(request),
      frame_(make_frame(world, frame_of_seeds(request), {})),
      sight_(world, frame_, request.refine) {
    if (!(request.min_weight >= 0))
        throw UsageError("the least weight of an image is a number of at least 0");
    object_tracer(world);
    Box box;
    const std::optional<Ray> middle = exact_ray(camera_, 0.5 * Vec2(camera_.film.width, camera_.film.height));
    if (middle) box.include(middle->origin);
    for (const FramedOptic& optic : frame_.optics)
        for (const Vec3& point : optic.facets->grid().points) box.include(point);
    middle_ = 0.5 * (box.low + box.high);
    const double size = length(box.size());
    reach_ = kReachInSizes * (size > 0 && std::isfinite(size) ? size : 1);
    if (!request.parameters.empty())
        parameters_ =
            std::make_unique<ParameterDerivatives>(world, frame_, request.frame.camera, request.parameters);
    if (!camera_.linear && !camera_.model) {
        camera_mesh_ = std::make_unique<MeshPointImages>(camera_.mesh);
        return;
    }
    for (std::size_t i = 0; i < frame_.optics.size(); ++i) add_optic(i);
}

/// Whether light may come over several optics at all: not over one that no ray that leaves it meets again.
bool PointProjector::may_have_several() const {
    if (request_.path.asks() ? request_.path.size() <= 1 : world_.scene.render.max_depth == 0) return false;
    const std::vector<PathOptic>& optics = path_world(world_).optics;
    if (optics.size() != 1 || !optics[0].mirror || !optics[0].convex) return !optics.empty();
    const std::optional<Vec3> eye = eye_of(camera_);
    return !eye || !lies_before(frame_.optics[0].facets->grid(), *eye);
}

/// Rays that tell what of an optic lies behind itself, where images there are left out.
Occluder PointProjector::what_hides(std::size_t index) const {
    if (!request_.refine || !eye_of(camera_)) return {};
    return [this, index](const Ray& ray, double t_min) {
        return limit_tracer(world_, index).first_hit(ray, t_min);
    };
}

void PointProjector::add_optic(std::size_t index) {
    const OpticFacets& facets = *frame_.optics[index].facets;
    facets.tracer();
    may_have_several_ = may_have_several();
    const bool asks_one = !request_.path.asks() || request_.path.size() == 1;
    if (searches_surfaces()) {
        searcher_.push_back(
            asks_one ? std::make_unique<SpecularSearcher>(*world_.optics[index].surface, what_hides(index))
                     : nullptr);
        limit_tracer(world_, index);  // by the bounds that the searcher holds
        facets_at_.emplace_back(facets.grid(), world_.optics[index].surface->face_count());
    }
    for (const PathMesh& path : frame_.optics[index].paths) {
        const Event event = path.path == Path::kReflect ? Event::kReflect : Event::kTransmit;
        if (asks_one && request_.path.allows(0, event) && !path.mesh.facets.empty())
            paths_.push_back({path.path, static_cast<Id>(index),
                              std::make_unique<FacetImages>(world_, frame_, index, path)});
    }
    path_world(world_);
    if (may_have_several_ || (searches_film() && asks_one))
        several_.push_back(std::make_unique<SeveralOpticsImages>(
            world_, frame_, index,
            SeveralOpticsChoice{request_.path, request_.min_weight, searches_film() ? std::size_t{1} : 2}));
}

bool PointProjector::on_film(const Vec2& pixel) const {
    return pixel.x >= 0 && pixel.y >= 0 && pixel.x <= world_.scene.film.width &&
           pixel.y <= world_.scene.film.height;
}

/// By the chain of the image's surfaces, once for the point and all parameters.
void PointProjector::differentiate(WorldImage& image, const ProjectedPoint& point) const {
    const bool is_direct = image.path == Path::kDirect;
    // Through a camera without one eye the numbers' derivatives are made of the point's.
    const bool asks = request_.derivatives || (parameters_ && !chain_eye(camera_));
    const bool by_point = asks && image.refined && !image.has_derivative && !is_direct;
    if (is_direct && parameters_) image.by_parameter = parameters_->of(image, point);
    if (is_direct || !(by_point || parameters_)) return;
    const auto sensitivity = image_sensitivity(world_, frame_, {image.events, image.pixel}, point);
    if (by_point) {
        if (sensitivity && sensitivity->path.is_light()) {
            image.has_derivative = sensitivity->path.is_regular();
            image.derivative = sensitivity->path.by_point();
        } else {
            solve_derivative(image, point);
        }
    }
    if (!parameters_) return;
    image.by_parameter = sensitivity ? parameters_->of(image, *sensitivity) : parameters_->of(image, point);
}

/// By the chain solved anew; where the camera has no eye, by the exact paths around the image.
void PointProjector::solve_derivative(WorldImage& image, const ProjectedPoint& point) const {
    if (const auto solved = solve_any_image(world_, frame_, {image.events, image.pixel}, point)) {
        if (!solved->is_regular || length(solved->film.pixel - image.pixel) > kSamePixels) return;
        image.has_derivative = true;
        image.derivative = solved->derivative;
        return;
    }
    if (point.is_direction) return;
    const auto exact =
        refine_history_image(history_query(world_, frame_, image.steps, point.place), image.pixel);
    if (!exact || length(exact->pixel - image.pixel) > kSamePixels) return;
    image.has_derivative = true;
    image.derivative = exact->derivative;
}

/// Where a point is searched for.
Vec3 PointProjector::within_reach(const ProjectedPoint& point) const {
    if (point.is_direction) return middle_ + reach_ * point.place;
    const Vec3 way = point.place - middle_;
    return length(way) <= reach_ ? point.place : middle_ + reach_ * normalize_or_zero(way);
}

/// The image of a point that continues one of a point near its way.
std::optional<ChainImage> PointProjector::moved_image(const WorldImage& image,
                                                      const ProjectedPoint& point) const {
    const bool have_own_normals = std::ranges::all_of(image.steps, [&](const Step& step) {
        return has_own_normals(world_.scene.meshes[world_.optics[step.optic].mesh]);
    });
    if (have_own_normals || point.is_direction || !chain_eye(camera_))
        return solve_any_image(world_, frame_, {image.events, image.pixel}, point);
    if (!image.refined) return std::nullopt;
    const auto exact =
        refine_history_image(history_query(world_, frame_, image.steps, point.place), image.pixel);
    if (!exact) return std::nullopt;
    ChainImage moved;
    moved.film.pixel = exact->pixel;
    moved.events = exact->events;
    moved.derivative = exact->derivative;
    moved.is_regular = true;
    return moved;
}

/// Moves images of a point that was searched for within reach to those of the point itself.
void PointProjector::move_to(const ProjectedPoint& point, PointProjection& result) const {
    for (WorldImage& image : result.images) {
        if (image.path == Path::kDirect) continue;
        image.has_derivative = false;
        const std::optional<ChainImage> solved = moved_image(image, point);
        if (!solved || length(solved->film.pixel - image.pixel) > kMostMove) {
            image.refined = false;
            image.off = kUnknownOffset;
            result.complete = false;
            continue;
        }
        image.pixel = solved->film.pixel;
        image.inside = on_film(image.pixel);
        image.events = solved->events;
        image.length = point.is_direction ? std::numeric_limits<double>::infinity()
                                          : length(point.place - image.events.back().point);
        image.t = image.length /
                  length(image.events.front().point - exact_ray(camera_, image.pixel).value_or(Ray{}).origin);
        image.has_derivative = solved->is_regular;
        image.derivative = solved->derivative;
    }
}

/// Of a list that is too long the images that carry the most, in their order.
void PointProjector::keep_strongest(PointProjection& result) const {
    std::erase_if(result.images, [&](const WorldImage& image) {
        return of_worst_colour(image.weight) < request_.min_weight;
    });
    if (request_.max_images == 0 || result.images.size() <= request_.max_images) return;
    const auto light = [](const WorldImage& image) {
        return image.weight.x + image.weight.y + image.weight.z;
    };
    std::vector<double> lights;
    for (const WorldImage& image : result.images) lights.push_back(light(image));
    std::nth_element(lights.begin(), lights.begin() + static_cast<std::ptrdiff_t>(request_.max_images - 1),
                     lights.end(), std::greater<>());
    const double least = lights[request_.max_images - 1];
    auto equal = static_cast<std::ptrdiff_t>(request_.max_images) -
                 std::count_if(lights.begin(), lights.end(), [&](double one) { return one > least; });
    std::erase_if(result.images, [&](const WorldImage& image) {
        return light(image) < least || (light(image) == least && equal-- <= 0);
    });
    result.complete = false;
}

void PointProjector::add_several(const SeveralOpticsImages& several, const Vec3& point,
                                 PointProjection& result) const {
    for (SeveralOpticsImage& found : several.images(point)) {
        const std::optional<Ray> view = exact_ray(camera_, found.exact.pixel);
        // Where paths end after one optic it is seen through what they would meet next.
        const bool goes_on = world_.scene.render.max_depth > 0 || found.steps.size() > 1;
        if (!view || (goes_on && !sight_.goes_straight(found.exact.events.back().point, point))) continue;
        if (std::any_of(result.images.begin(), result.images.end(), [&](const WorldImage& one) {
                return one.refined && one.steps == found.steps &&
                       length(one.pixel - found.exact.pixel) < kSamePixels;
            }))
            continue;
        WorldImage image;
        image.weight = found.exact.weight;
        if (image.weight == Vec3(0)) continue;  // no light comes this way
        image.path = found.path;
        image.optic = found.optic;
        image.object = world_.optics[found.optic].mesh;
        image.facet = found.facet;
        image.pixel = found.exact.pixel;
        image.length = found.exact.distance;
        image.t = found.exact.distance / found.exact.first_way;
        image.refined = true;
        image.steps = std::move(found.steps);
        image.events = std::move(found.exact.events);
        image.has_derivative = true;
        image.derivative = found.exact.derivative;
        image.inside = on_film(image.pixel);
        const std::vector<PathEvent>& events = image.events;
        image.visible = asks_what_hides(image) && is_free_beyond(events.back().point, point) &&
                        sight_.sees(view->origin, events.front().point);
        for (std::size_t i = 0; i + 1 < events.size() && image.visible; ++i)
            image.visible = sight_.is_free_of_objects(events[i].point, events[i + 1].point);
        result.images.push_back(std::move(image));
    }
}

void PointProjector::add_direct(const ProjectedPoint& asked, PointProjection& result) const {
    // At infinity the direction counts from the eye.
    const std::optional<ChainEnd> eye = chain_eye(camera_);
    if (asked.is_direction && (!eye || eye->is_direction)) return;
    const Vec3 point = asked.is_direction ? eye->place + reach_ * asked.place : asked.place;
    for (const FilmImage& found : film_positions(camera_, point)) {
        // The eye itself has no image, which rounding may put in front of it.
        const double least = kLeastDepth * (length(found.origin) + length(point));
        if (!(found.t > (camera_.linear && camera_.linear->parallel ? 0 : least))) continue;
        WorldImage image;
        image.pixel = found.pixel;
        image.t = found.t;
        image.length = length(point - found.origin);
        if (asked.is_direction) image.t = image.length = std::numeric_limits<double>::infinity();
        image.inside = on_film(image.pixel);
        image.refined = true;
        image.weight = weight_of_direct(world_, frame_, {found.origin, point - found.origin}, image.length);
        image.visible =
            asks_what_hides(image) && (request_.visible_at_optics ? sight_.goes_straight(found.origin, point)
                                                                  : sight_.sees(found.origin, point));
        if (camera_.linear) {
            // d (s / w) = (ds - (s / w) dw) / w.
            const double depth = screen_from_world(*camera_.linear, point).z;
            image.has_derivative = true;
            for (int axis = 0; axis < 2; ++axis) {
                const Vec4& row = axis == 0 ? camera_.linear->screen_x : camera_.linear->screen_y;
                image.derivative[static_cast<std::size_t>(axis)] =
                    (Vec3(row) - image.pixel[axis] * Vec3(camera_.linear->screen_w)) *
                    ((asked.is_direction ? reach_ : 1) / depth);
            }
        } else if (const auto place = film_place(camera_, point, image.pixel)) {
            image.has_derivative = true;
            for (std::size_t axis = 0; axis < 2; ++axis)
                image.derivative[axis] = place->slope[axis] * (asked.is_direction ? reach_ : 1);
        }
        result.images.push_back(image);
    }
}

void PointProjector::add_camera_mesh(const Vec3& point, PointProjection& result) const {
    for (const MeshPointImage& found : camera_mesh_->images(point)) {
        const Ray ray = interpolated_ray(camera_.mesh, found.facet, found.weights);
        WorldImage image;
        image.facet = found.facet;
        image.pixel = found.screen;
        image.t = found.t;
        image.length = found.t * length(ray.direction);
        image.weight = weight_of_direct(world_, frame_, ray, image.length);
        image.inside = on_film(image.pixel);
        image.visible = asks_what_hides(image) && is_free_beyond(ray.origin, point);
        result.images.push_back(image);
    }
}

/// Whether the camera's exact ray, mirrored, goes about where the facets' ray goes: where several views blend
/// facets may be far from it.
bool PointProjector::leads_towards(const Ray& view, const OpticPath& path, const Vec3& point) const {
    if (camera_.linear || path.path != Path::kReflect) return true;
    const std::optional<SurfaceHit> hit = limit_tracer(world_, path.optic).first_hit(view);
    if (!hit) return true;  // past the silhouette, which facets have elsewhere
    const Vec3 out = mirrored(view.direction, hit->point.normal);
    const Vec3 way = point - hit->point.position;
    return dot(out, way) > kLeastCosine * length(out) * length(way);
}

void PointProjector::add_optic_path(const OpticPath& path, const Vec3& point, const SpecularSearch& searched,
                                    PointProjection& result) const {
    for (const OpticImage& one : optic_images(path, point, searched, result)) {
        const std::optional<Ray> view = exact_ray(camera_, one.pixel);
        if (!view) continue;
        const Vec3& eye = view->origin;
        if (searches_surfaces() && one.refined && !sight_.is_free_of_optic(eye, one.from, path.optic))
            continue;
        if (!one.refined && request_.refine && !leads_towards(*view, path, point)) continue;
        const Id on_facet = one.refined ? kNone : path.optic;
        if (world_.scene.render.max_depth > 0 && !sight_.goes_straight(one.from, point, on_facet)) continue;
        const double t =
            camera_.near_depth + dot(one.from - eye, view->direction) / dot(view->direction, view->direction);
        WorldImage image;
        image.weight =
            weight_over_one(world_, frame_, {path.optic, path.path, *view, one.from, one.front, point});
        if (image.weight == Vec3(0)) continue;  // no light comes this way
        image.path = path.path;
        const Event event = path.path == Path::kReflect ? Event::kReflect : Event::kTransmit;
        image.steps = {{path.optic, event}};
        if (one.refined)
            image.events = {{path.optic, event, one.front, one.at.face, one.at.uv, one.from, one.normal}};
        image.optic = path.optic;
        image.object = world_.optics[path.optic].mesh;
        image.facet = one.facet;
        image.pixel = one.pixel;
        image.t = one.t;
        image.length = one.length;
        image.refined = one.refined;
        image.off = one.refined ? 0 : kUnknownOffset;
        image.inside = on_film(image.pixel);
        // What only facets have is no image of the exact camera.
        image.visible = asks_what_hides(image) && (one.refined || !request_.refine) && is_between_planes(t) &&
                        is_free_beyond(one.from, point) &&
                        sight_.sees(eye, one.from, on_facet);
        result.images.push_back(std::move(image));
    }
}

void PointProjector::project(std::span<const ProjectedPoint> points, std::span<const std::size_t> some,
                             std::span<PointProjection> result) const {
    std::vector<Vec3> of_some;
    for (const std::size_t p : some) of_some.push_back(within_reach(points[p]));
    std::vector<std::vector<SpecularSearch>> searched;
    SearchLimits limits;
    limits.asks_rays = points.size() >= kManyPoints;
    for (const OpticPath& path : paths_) searched.push_back(search(path, of_some, limits));
    for (std::size_t k = 0; k < some.size(); ++k) {
        const Vec3& point = of_some[k];
        const ProjectedPoint& asked = points[some[k]];
        PointProjection& found = result[some[k]];
        found.complete = !may_have_several_ && several_.empty();
        std::size_t most = 1;
        for (const std::vector<SpecularSearch>& on_path : searched) most += on_path[k].images.size();
        found.images.reserve(most);
        if (camera_mesh_) add_camera_mesh(point, found);
        if (!camera_mesh_ && world_.scene.render.direct &&
            (!request_.path.asks() || request_.path.is_direct()))
            add_direct(asked, found);
        for (std::size_t i = 0; i < paths_.size(); ++i)
            add_optic_path(paths_[i], point, searched[i][k], found);
        for (const auto& several : several_) add_several(*several, point, found);
        if (asked.is_direction || point != asked.place) move_to(asked, found);
        if (request_.min_weight > 0 || request_.max_images > 0) keep_strongest(found);
        for (WorldImage& image : found.images) differentiate(image, asked);
    }
}

}  // namespace trilens
