#include "render/project/image_chain.h"

#include <algorithm>
#include <cmath>

#include "render/frame/camera_rays.h"
#include "shade/optic_weights.h"
#include "shade/shade.h"

namespace trilens {

namespace {

/// Pixels move by differences of a step of this share of the distance, where the camera has no linear map.
constexpr double kPlaceStep = 1e-6;

double index_of(const ChainModel& model, Id body, int colour) {
    return body == kNone ? 1 : ior_of(model.scene->materials[model.materials[body]], colour);
}

ChainModel model_of(const World& world, const Frame& frame, std::vector<const Surface*>& surfaces,
                    std::vector<Id>& materials) {
    for (const Optic& optic : world.optics) {
        surfaces.push_back(optic.surface.get());
        materials.push_back(optic.material);
    }
    return {&world.scene, &frame.camera, surfaces, materials};
}

}  // namespace

std::optional<ChainEnd> chain_eye(const Camera& camera) {
    if (camera.linear)
        return camera.linear->parallel ? ChainEnd{normalize(camera.linear->view_direction), true}
                                       : ChainEnd{camera.linear->eye, false};
    if (camera.model)
        if (const auto eye = camera.model->eye()) return ChainEnd{*eye, false};
    return std::nullopt;
}

std::optional<std::vector<EventMedia>> event_media(const World& world, const Media& around,
                                                   std::span<const PathEvent> events) {
    const auto active = [&](const Media& media) {
        return media.active([&](Id optic) { return world.scene.meshes[world.optics[optic].mesh].priority; });
    };
    std::vector<EventMedia> media;
    Media now = around;
    for (const PathEvent& event : events) {
        if (world.optics[event.optic].mirror) {
            media.push_back({active(now), active(now)});
            continue;
        }
        const std::optional<MediaSides> sides = sides_of(now, event.optic, event.front);
        if (!sides) return std::nullopt;
        const bool reflects = event.event == Event::kReflect;
        now = reflects ? sides->before : sides->after;
        media.push_back({active(sides->before), active(now)});
    }
    return media;
}

std::optional<PathChain> make_chain(const ChainModel& model, std::span<const PathEvent> events,
                                    std::span<const EventMedia> media, const ProjectedPoint& point) {
    const std::optional<ChainEnd> eye = chain_eye(*model.camera);
    if (!eye || events.empty()) return std::nullopt;
    PathChain chain;
    chain.eye = *eye;
    chain.point = {point.place, point.is_direction};
    const int colour = events.size() > 1 ? 1 : -1;
    for (std::size_t i = 0; i < events.size(); ++i)
        chain.events.push_back({model.surfaces[events[i].optic], index_of(model, media[i].before, colour),
                                index_of(model, media[i].after, colour), events[i].event == Event::kReflect});
    return chain;
}

std::optional<Vec2> film_pixel(const Camera& camera, const Vec3& place, const Vec2& near) {
    if (camera.linear) {
        const Vec3 screen = screen_from_world(*camera.linear, place);
        if (!(screen.z > 0)) return std::nullopt;
        return Vec2(screen) / screen.z;
    }
    std::optional<Vec2> best;
    for (const FilmImage& image : film_positions(camera, place))
        if (!best || length(image.pixel - near) < length(*best - near)) best = image.pixel;
    return best;
}

std::optional<FilmPlace> film_place(const Camera& camera, const Vec3& place, const Vec2& near) {
    const std::optional<Vec2> pixel = film_pixel(camera, place, near);
    if (!pixel) return std::nullopt;
    FilmPlace found{*pixel};
    if (camera.linear) {
        const double depth = screen_from_world(*camera.linear, place).z;
        for (int axis = 0; axis < 2; ++axis) {
            const Vec4& row = axis == 0 ? camera.linear->screen_x : camera.linear->screen_y;
            found.slope[static_cast<std::size_t>(axis)] =
                (Vec3(row) - found.pixel[axis] * Vec3(camera.linear->screen_w)) / depth;
        }
        return found;
    }
    if (!camera.model || !camera.model->eye()) return std::nullopt;
    const double step = kPlaceStep * length(place - *camera.model->eye());
    for (int k = 0; k < 3; ++k) {
        Vec3 by(0);
        by[k] = step;
        const auto after = film_pixel(camera, place + by, *pixel),
                   before = film_pixel(camera, place - by, *pixel);
        if (!after || !before) return std::nullopt;
        for (int axis = 0; axis < 2; ++axis)
            found.slope[static_cast<std::size_t>(axis)][k] = ((*after)[axis] - (*before)[axis]) / (2 * step);
    }
    return found;
}

std::optional<ChainImage> solve_image(const World& world, const Frame& frame,
                                      std::span<const PathEvent> start, const ProjectedPoint& point,
                                      const Vec2& near) {
    if (start.empty()) return std::nullopt;
    std::vector<const Surface*> surfaces;
    std::vector<Id> materials;
    const ChainModel model = model_of(world, frame, surfaces, materials);
    Media around;
    if (!frame.camera_media.none()) {
        const std::optional<Ray> view = exact_ray(frame.camera, near);
        if (!view) return std::nullopt;
        around = frame.camera_media.of(*view);
    }
    const auto media = event_media(world, around, start);
    const auto chain = media ? make_chain(model, start, *media, point) : std::nullopt;
    if (!chain) return std::nullopt;

    std::vector<SurfaceParameter> at;
    for (const PathEvent& event : start) at.push_back({event.face, event.uv});
    const auto find = [&](std::size_t event, const Vec3& from,
                          const Vec3& towards) -> std::optional<SurfaceParameter> {
        const LimitTracer& tracer = limit_tracer(world, start[event].optic);
        const Ray ray{from, towards - from};
        const auto hit = tracer.first_hit(ray, event == 0 ? 0 : tracer.self_hit_t_min(ray));
        if (!hit) return std::nullopt;
        return SurfaceParameter{hit->face, hit->uv};
    };
    const std::optional<ChainShape> shape = solve_chain(*chain, at, find);
    if (!shape) return std::nullopt;

    ChainImage image;
    image.events.assign(start.begin(), start.end());
    const ChainBend bend = chain_bend(*chain, shape->points);
    for (std::size_t i = 0; i < start.size(); ++i) {
        const SurfacePoint& p = shape->points[i];
        PathEvent& event = image.events[i];
        event.face = shape->at[i].face;
        event.uv = shape->at[i].uv;
        event.point = p.position;
        event.normal = p.normal;
        if ((dot(bend.way[i], p.normal) <= 0) != event.front) return std::nullopt;
    }
    const auto film = film_place(frame.camera, image.events.front().point, near);
    if (!film) return std::nullopt;
    image.film = *film;

    const PathSensitivity sensitivity(*chain, shape->points, image.film.slope);
    image.is_regular = sensitivity.is_regular();
    image.derivative = sensitivity.by_point();
    return image;
}

namespace {

Vec3 transmittance(const Material* glass, double way) {
    return glass ? volume_transmittance(*glass, way) : Vec3(1);
}

/// Cosine of the angle of incidence of light that goes along `in` to the optic and along `out` from it.
double incidence_cosine(Path path, const Vec3& in, const Vec3& out, double eta) {
    if (path == Path::kReflect) return std::sqrt(std::clamp((1 - dot(in, out)) / 2, 0.0, 1.0));
    const Vec3 normal = normalize_or_zero(eta * in - out);  // Snell: n1 in - n2 out is along the normal
    return std::clamp(std::fabs(dot(in, normal)), 0.0, 1.0);
}

}  // namespace

Vec3 weight_over_one(const World& world, const Frame& frame, const OneEventWay& way) {
    const Optic& optic = world.optics[way.optic];
    const Media around = frame.camera_media.none() ? Media() : frame.camera_media.of(way.view);
    const Vec3 to_optic = way.from - way.view.origin, on = way.point - way.from;
    const Vec3 in = normalize_or_zero(way.view.direction), out = normalize_or_zero(on);
    const Material* before = glass_around(world, around);
    const Vec3 arriving = transmittance(before, length(to_optic));
    if (optic.mirror) {
        const double cosine = incidence_cosine(Path::kReflect, in, out, 1);
        const Material& metal = world.scene.materials[optic.material];
        return arriving * optic_weights(metal, {cosine, way.front}, world.scene.render.fresnel).reflect *
               transmittance(before, length(on));
    }
    const GlassInterface glass = interface_of(world, way.optic, around, way.front);
    const double cosine = incidence_cosine(way.path, in, out, eta_of(glass, -1));
    const OpticWeights weights = interface_weights(glass, cosine, world.scene.render.fresnel);
    return way.path == Path::kReflect ? arriving * weights.reflect * transmittance(glass.before, length(on))
                                      : arriving * weights.refract * transmittance(glass.after, length(on));
}

Vec3 weight_of_direct(const World& world, const Frame& frame, const Ray& view, double way) {
    if (frame.camera_media.none()) return Vec3(1);
    return transmittance(glass_around(world, frame.camera_media.of(view)), way);
}

namespace {

/// A segment is free if what it meets lies within this share of its ends.
constexpr double kSightFreeShare = 1e-6;

}  // namespace

bool OcclusionQueries::is_free_of_objects(const Vec3& from, const Vec3& to) const {
    return !object_tracer(world_).occluded({from, to - from}, kSightFreeShare, 1 - kSightFreeShare);
}

bool OcclusionQueries::is_free_of_facets(const Ray& segment, std::size_t optic) const {
    return !frame_.optics[optic].facets->tracer().occluded(segment, kSightFreeShare, 1 - kSightFreeShare);
}

bool OcclusionQueries::is_free_of_surface(const Ray& segment, std::size_t optic) const {
    return !limit_tracer(world_, optic).meets(segment, kSightFreeShare, 1 - kSightFreeShare);
}

bool OcclusionQueries::is_free_of_optic(const Vec3& from, const Vec3& to, std::size_t optic) const {
    const Ray segment{from, to - from};
    return exact_ ? is_free_of_surface(segment, optic) : is_free_of_facets(segment, optic);
}

bool OcclusionQueries::sees(const Vec3& from, const Vec3& to, Id on_facet) const {
    if (!is_free_of_objects(from, to)) return false;
    const Ray segment{from, to - from};
    for (std::size_t i = 0; i < world_.optics.size(); ++i)
        if (i == on_facet ? !is_free_of_facets(segment, i) : !is_free_of_optic(from, to, i)) return false;
    return true;
}

bool OcclusionQueries::goes_straight(const Vec3& from, const Vec3& to, Id on_facet) const {
    const Ray segment{from, to - from};
    for (std::size_t i = 0; i < world_.optics.size(); ++i)
        if (i == on_facet ? !is_free_of_facets(segment, i) : !is_free_of_surface(segment, i)) return false;
    return true;
}

}  // namespace trilens
