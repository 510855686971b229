#include "render/project/image_light.h"

#include <algorithm>
#include <cmath>

#include "base/math/box.h"
#include "base/util/parallel.h"
#include "reflect/reflection.h"
#include "refract/refraction.h"
#include "render/frame/camera_rays.h"
#include "scene/data/scene_digest.h"

namespace trilens {
namespace {

/// Steps to either side, relative: about the cube root of rounding, where truncation and rounding of a
/// central difference meet.
constexpr double kParameterStep = 1e-5;
/// Directions are as far away as this, in sizes of the scene, where a camera shows them directly.
constexpr double kFarInSizes = 1e6;

/// Whether a number is a length, whose steps go by the scene's size.
bool is_length(const std::string& pointer) {
    for (const char* key : {"translate", "center", "radius", "height", "size", "focalLength", "points", "eye",
                            "at", "ymag", "fit"})
        if (pointer.find(std::string("/") + key) != std::string::npos) return true;
    return false;
}

double size_of(const World& world, const Frame& frame) {
    Box box;
    for (const FramedOptic& optic : frame.optics)
        for (const Vec3& point : optic.facets->grid().points) box.include(point);
    if (frame.optics.empty())  // a frame without facets, of warm starts
        for (const Optic& optic : world.optics)
            for (Id face = 0; face < optic.surface->face_count(); ++face)
                for (const Vec2& uv : {Vec2(0), Vec2(1, 0), Vec2(0, 1)})
                    box.include(optic.surface->eval(face, uv).position);
    const double size = length(box.size());
    return size > 0 && std::isfinite(size) ? size : 1;
}

/// The optics' meshes and the camera as digests: what stays is not made again.
struct PartDigests {
    std::string camera;
    std::vector<std::string> meshes;  // per optic
};

PartDigests part_digests(const World& world, const Scene& scene, std::size_t camera) {
    PartDigests digests{camera_digest(scene.cameras[camera]), {}};
    for (const Optic& optic : world.optics) digests.meshes.push_back(mesh_digest(scene.meshes[optic.mesh]));
    return digests;
}

Vec3 eye_change(const Camera& before, const Camera& after) {
    const std::optional<ChainEnd> from = chain_eye(before), to = chain_eye(after);
    return from && to ? to->place - from->place : Vec3(0);
}

}  // namespace

/// What a number moves, from a step below its value to one above; null or empty what stays.
struct ParameterDerivatives::Step {
    struct Surfaces {
        std::shared_ptr<const Surface> below, above;
    };
    struct Cameras {
        Camera below, above;
        Vec3 eye{0};  // from one to the other; of parallel rays the direction

        /// How the film shows two places, one for each, differently; none where one of them shows none.
        std::optional<Vec2> change(const Vec3& low, const Vec3& high, const Vec2& near) const {
            const auto from = film_pixel(below, low, near), to = film_pixel(above, high, near);
            if (!from || !to) return std::nullopt;
            return *to - *from;
        }
    };

    double size = 0;  // between both
    std::unique_ptr<const Cameras> cameras;
    std::vector<Surfaces> surfaces;            // per optic
    std::vector<std::array<double, 2>> glass;  // per optic: how its index changes for usual_colours(1), (2)

    /// The last ray of the image's pixel over its events, unit, after the step below (side -1) or above (1);
    /// none where it does not go that way.
    std::optional<Ray> last_ray(const World& world, std::span<const EventMedia> media, int side,
                                const Camera& unmoved, const WorldImage& image) const;
    /// Of the image's pixel; none where the camera does not show it on both sides.
    std::optional<Vec2> moved(const WorldImage& image, const ImageSensitivity& by) const;
};

namespace {

/// Where a ray meets a surface near a point of it, to second order of the surface about that point: its place
/// and unit normal; none where it passes along it.
std::optional<Ray> met_near(const SurfacePoint& about, const Ray& ray) {
    constexpr int kMeetingSteps = 4;
    const Vec3 &d = ray.direction, a = unit_across(d), b = cross(d, a);
    Vec2 uv(0);
    Vec3 place, du, dv;
    for (int i = 0; i <= kMeetingSteps; ++i) {
        du = about.du + uv.x * about.duu + uv.y * about.duv;
        dv = about.dv + uv.x * about.duv + uv.y * about.dvv;
        place = about.position + 0.5 * (uv.x * (about.du + du) + uv.y * (about.dv + dv));
        const Vec2 off(dot(place - ray.origin, a), dot(place - ray.origin, b));
        const Vec2 by_u(dot(du, a), dot(du, b)), by_v(dot(dv, a), dot(dv, b));
        const double area = cross(by_u, by_v);
        if (!(std::fabs(area) > 0)) return std::nullopt;
        if (i < kMeetingSteps) uv -= Vec2(cross(off, by_v), cross(by_u, off)) / area;
    }
    return Ray{place, normalize_or_zero(cross(du, dv))};
}

}  // namespace

std::optional<Ray> ParameterDerivatives::Step::last_ray(const World& world, std::span<const EventMedia> media,
                                                        int side, const Camera& unmoved,
                                                        const WorldImage& image) const {
    const Camera& camera = !cameras ? unmoved : side < 0 ? cameras->below : cameras->above;
    std::optional<Ray> ray = exact_ray(camera, image.pixel);
    const auto index_of = [&](Id body) {
        if (body == kNone) return 1.0;
        const double now = ior_of(world.scene.materials[world.optics[body].material], usual_colours(2));
        return glass.empty() ? now : now + 0.5 * side * glass[body][1];
    };
    for (std::size_t i = 0; ray && i < image.events.size(); ++i) {
        const PathEvent& event = image.events[i];
        const Surface* surface = world.optics[event.optic].surface.get();
        if (!surfaces.empty() && surfaces[event.optic].below)
            surface = (side < 0 ? surfaces[event.optic].below : surfaces[event.optic].above).get();
        ray->direction = normalize_or_zero(ray->direction);
        const std::optional<Ray> met = met_near(surface->eval(event.face, event.uv), *ray);
        if (!met) return std::nullopt;
        const Vec3 normal = dot(met->direction, ray->direction) > 0 ? -met->direction : met->direction;
        const std::optional<Vec3> out =
            event.event == Event::kReflect
                ? mirrored(ray->direction, normal)
                : refracted(ray->direction, normal, index_of(media[i].before) / index_of(media[i].after));
        if (!out) return std::nullopt;
        ray = Ray{met->origin, *out};
    }
    return ray;
}

std::optional<Vec2> ParameterDerivatives::Step::moved(const WorldImage& image,
                                                      const ImageSensitivity& by) const {
    const std::span<const PathEvent> events = image.events;
    Vec2 moved(0);
    if (cameras) {
        const Vec3& first = events.front().point;
        const std::optional<Vec2> shown = cameras->change(first, first, image.pixel);
        if (!shown) return std::nullopt;
        moved += *shown + by.path.by_eye(cameras->eye);
    }
    for (std::size_t i = 0; !surfaces.empty() && i < events.size(); ++i) {
        const Surfaces& surface = surfaces[events[i].optic];
        if (!surface.below) continue;
        moved += by.path.by_surface(i, surface.below->eval_first_order(events[i].face, events[i].uv),
                                    surface.above->eval_first_order(events[i].face, events[i].uv));
    }
    for (std::size_t s = 0; !glass.empty() && s <= events.size(); ++s) {
        const Id body = s == 0 ? by.media[0].before : by.media[s - 1].after;
        if (body != kNone) moved += by.path.by_index(s, glass[body][events.size() > 1 ? 1 : 0]);
    }
    return moved / size;
}

ParameterDerivatives::ParameterDerivatives(const World& world, const Frame& frame, std::size_t camera,
                                           std::span<const std::string> pointers)
    : world_(world),
      frame_(frame),
      numbers_(find_numbers(world.scene, pointers)),
      size_(size_of(world, frame)) {
    const PartDigests now = part_digests(world, world.scene, camera);
    const auto scene_at = [&](SceneNumber number, double value) {
        number.value = value;
        return scene_with(world.scene, number);
    };
    const auto surface_of = [&](const Scene& scene, std::size_t optic) {
        return std::shared_ptr<const Surface>(make_optic_surface(scene, world.optics[optic].mesh, {}));
    };
    const auto fill = [&](const Scene& below, const Scene& above, Step& step) {
        const PartDigests low = part_digests(world, below, camera), high = part_digests(world, above, camera);
        if (low.camera != now.camera || high.camera != now.camera) {
            const Camera before = make_camera_rays(below, camera), after = make_camera_rays(above, camera);
            step.cameras = std::make_unique<const Step::Cameras>(
                Step::Cameras{before, after, eye_change(before, after)});
        }
        std::vector<Step::Surfaces> surfaces(world.optics.size());
        std::vector<std::array<double, 2>> glass(world.optics.size());
        for (std::size_t i = 0; i < world.optics.size(); ++i) {
            if (low.meshes[i] != now.meshes[i] || high.meshes[i] != now.meshes[i])
                surfaces[i] = {surface_of(below, i), surface_of(above, i)};
            const Id material = world.optics[i].material;
            for (const std::size_t events : {1, 2})
                glass[i][events - 1] = ior_of(above.materials[material], usual_colours(events)) -
                                       ior_of(below.materials[material], usual_colours(events));
        }
        if (std::any_of(surfaces.begin(), surfaces.end(),
                        [](const auto& one) { return one.below != nullptr; }))
            step.surfaces = std::move(surfaces);
        if (std::any_of(glass.begin(), glass.end(),
                        [](const auto& one) { return one[0] != 0 || one[1] != 0; }))
            step.glass = std::move(glass);
    };
    steps_.resize(numbers_.size());
    parallel_for(numbers_.size(), 1, [&](std::size_t from, std::size_t to) {
        for (std::size_t n = from; n < to; ++n) {
            const SceneNumber& number = numbers_[n];
            const double usual = is_length(number.pointer) ? size_ : 1;
            const double step = kParameterStep * std::max(std::fabs(number.value), usual);
            const double above = number.value + step, below = number.value - step;
            steps_[n].size = above - below;
            fill(scene_at(number, below), scene_at(number, above), steps_[n]);
        }
    });
}

ParameterDerivatives::~ParameterDerivatives() = default;

std::vector<Vec2> ParameterDerivatives::of(const WorldImage& image, const ProjectedPoint& point) const {
    if (image.path == Path::kDirect) return of_direct(image.pixel, point);
    if (!chain_eye(frame_.camera)) return of_film(image, point);
    const auto sensitivity = image_sensitivity(world_, frame_, {image.events, image.pixel}, point);
    return sensitivity ? of(image, *sensitivity) : std::vector<Vec2>();
}

/// A camera whose rays meet in no eye: what a step moves is the last ray of the image's pixel, and the image
/// moves as if the point moved as far the other way.
std::vector<Vec2> ParameterDerivatives::of_film(const WorldImage& image, const ProjectedPoint& point) const {
    if (!image.has_derivative || !std::all_of(image.events.begin(), image.events.end(), [&](const auto& one) {
            return has_own_normals(world_.scene.meshes[world_.optics[one.optic].mesh]);
        }))
        return {};
    const std::optional<Ray> view = exact_ray(frame_.camera, image.pixel);
    const CameraMedia& around = frame_.camera_media;
    if (!view) return {};
    const auto media = event_media(world_, around.none() ? Media() : around.of(*view), image.events);
    if (!media) return {};
    const auto missed = [&](const Step& step, int side) -> std::optional<Vec3> {
        const std::optional<Ray> last = step.last_ray(world_, *media, side, frame_.camera, image);
        if (!last) return std::nullopt;
        const Vec3 to = point.is_direction ? point.place : point.place - last->origin;
        return to - dot(to, last->direction) * last->direction;
    };
    std::vector<Vec2> moved;
    moved.reserve(steps_.size());
    for (const Step& step : steps_) {
        const std::optional<Vec3> below = missed(step, -1), above = missed(step, 1);
        if (!below || !above) return {};
        const Vec3 by = (*above - *below) / step.size;
        moved.emplace_back(dot(image.derivative[0], by), dot(image.derivative[1], by));
    }
    return moved;
}

std::vector<Vec2> ParameterDerivatives::of_direct(const Vec2& pixel, const ProjectedPoint& point) const {
    std::vector<Vec2> moved;
    moved.reserve(steps_.size());
    for (const Step& step : steps_) {
        if (!step.cameras) {
            moved.emplace_back(0);
            continue;
        }
        Vec3 low = point.place, high = low;
        if (point.is_direction) {
            const auto below = chain_eye(step.cameras->below), above = chain_eye(step.cameras->above);
            if (!below || !above || below->is_direction || above->is_direction) return {};
            const Vec3 far = kFarInSizes * size_ * point.place;
            low = below->place + far, high = above->place + far;
        }
        const std::optional<Vec2> change = step.cameras->change(low, high, pixel);
        if (!change) return {};
        moved.push_back(*change / step.size);
    }
    return moved;
}

std::vector<Vec2> ParameterDerivatives::of(const WorldImage& image,
                                           const ImageSensitivity& sensitivity) const {
    if (!sensitivity.path.is_regular()) return {};
    std::vector<Vec2> moved;
    moved.reserve(steps_.size());
    for (const Step& step : steps_) {
        const std::optional<Vec2> one = step.moved(image, sensitivity);
        if (!one) return {};
        moved.push_back(*one);
    }
    return moved;
}

}  // namespace trilens
