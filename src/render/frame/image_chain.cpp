#include "render/frame/image_chain.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "render/frame/camera_rays.h"
#include "shade/optic_weights.h"
#include "shade/shade.h"

namespace trilens {

namespace {

/// Pixels move by differences of a step of this share of the distance, where the camera has no linear map.
constexpr double kPlaceStep = 1e-6;

/// The media of a start's events, from that of the camera's ray at its pixel.
std::optional<PerEvent<EventMedia>> media_of(const World& world, const Frame& frame,
                                             const ChainStart& start) {
    Media around;
    if (!frame.camera_media.none()) {
        const std::optional<Ray> view = exact_ray(frame.camera, start.pixel);
        if (!view) return std::nullopt;
        around = frame.camera_media.of(*view);
    }
    return event_media(world, around, start.events);
}

/// Its chain through them, from `eye` to a point at the world's origin.
PathChain chain_through(const World& world, const ChainEnd& eye, const ChainStart& start,
                        std::span<const EventMedia> media) {
    const Colours colours = start.colours.value_or(usual_colours(start.events.size()));
    const auto index_of = [&](Id body) {
        return body == kNone ? 1 : ior_of(world.scene.materials[world.optics[body].material], colours);
    };
    PathChain chain{eye, {}, {}};
    for (std::size_t i = 0; i < media.size(); ++i) {
        const PathEvent& event = start.events[i];
        chain.events.push_back({world.optics[event.optic].surface.get(), index_of(media[i].before),
                                index_of(media[i].after), event.event == Event::kReflect});
    }
    return chain;
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

std::optional<PerEvent<EventMedia>> event_media(const World& world, const Media& around,
                                                std::span<const PathEvent> events) {
    const auto active = [&](const Media& media) {
        return media.active([&](Id optic) { return world.scene.meshes[world.optics[optic].mesh].priority; });
    };
    PerEvent<EventMedia> media;
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
    const std::optional<Ray> view = camera.model ? exact_ray(camera, *pixel) : std::nullopt;
    if (!view) return std::nullopt;
    const double step = kPlaceStep * length(place - view->origin);
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

HistoryQuery history_query(const World& world, const Frame& frame, std::span<const Step> steps,
                           const Vec3& point) {
    HistoryQuery query;
    query.world = &path_world(world);
    query.camera_ray = [&camera = frame.camera](const Vec2& pixel) {
        return exact_ray(camera, pixel).value_or(Ray{});
    };
    if (!frame.camera_media.none())
        query.around = [&frame](const Ray& ray) { return frame.camera_media.of(ray); };
    Colours colours = kAllColours;
    for (std::size_t i = 0; i < steps.size(); ++i) {
        const Optic& optic = world.optics[steps[i].optic];
        if (steps[i].event == Event::kTransmit && world.scene.materials[optic.material].dispersion > 0)
            colours = 1;
        PathSegment segment;
        segment.colours = colours;
        segment.parent = i == 0 ? kNone : static_cast<Id>(i - 1);
        segment.step = steps[i];
        segment.ends = i + 1 == steps.size();
        query.history.push_back(segment);
    }
    query.point = point;
    return query;
}

std::optional<PathChain> chain_from(const World& world, const Frame& frame, const ChainStart& start) {
    const std::optional<ChainEnd> eye = chain_eye(frame.camera);
    if (start.events.empty() || !eye) return std::nullopt;
    const auto media = media_of(world, frame, start);
    if (!media) return std::nullopt;
    return chain_through(world, *eye, start, *media);
}

std::optional<SolvedChain> solve_path(const World& world, const Frame& frame, const ChainStart& start,
                                      const ProjectedPoint& point) {
    std::optional<PathChain> chain = chain_from(world, frame, start);
    if (!chain) return std::nullopt;
    chain->point = {point.place, point.is_direction};
    SolvedChain solved;
    solved.chain = std::move(*chain);

    PerEvent<SurfaceParameter> at;
    for (const PathEvent& event : start.events) at.push_back({event.face, event.uv});
    const auto find = [&](const LeavingStep& step) -> std::optional<SurfaceParameter> {
        const Id optic = start.events[step.event].optic;
        if (!world.optics[optic].surface->has_closed_form())
            return face_neighbours(world, optic).over_edge(step.border, step.towards);
        const LimitTracer& tracer = limit_tracer(world, optic);
        const Ray ray{step.from, step.towards - step.from};
        const auto hit = tracer.first_hit(ray, step.event == 0 ? 0 : tracer.self_hit_t_min(ray));
        if (!hit) return std::nullopt;
        return SurfaceParameter{hit->face, hit->uv};
    };
    std::optional<ChainShape> shape = solve_chain(solved.chain, at, find);
    if (!shape) return std::nullopt;
    const ChainBend bend = chain_bend(solved.chain, shape->points);
    for (std::size_t i = 0; i < shape->points.size(); ++i)
        if ((dot(bend.way[i], shape->points[i].normal) <= 0) != start.events[i].front) return std::nullopt;
    solved.shape = std::move(*shape);
    return solved;
}

std::optional<ChainImage> solve_image(const World& world, const Frame& frame, const ChainStart& start,
                                      const ProjectedPoint& point) {
    const std::optional<SolvedChain> solved = solve_path(world, frame, start, point);
    if (!solved) return std::nullopt;
    const ChainShape& shape = solved->shape;
    ChainImage image;
    image.events.assign(start.events.begin(), start.events.end());
    for (std::size_t i = 0; i < shape.points.size(); ++i) {
        image.events[i].face = shape.at[i].face;
        image.events[i].uv = shape.at[i].uv;
        image.events[i].point = shape.points[i].position;
        image.events[i].normal = shape.points[i].normal;
    }
    const auto film = film_place(frame.camera, image.events.front().point, start.pixel);
    if (!film) return std::nullopt;
    image.film = *film;

    const PathSensitivity sensitivity(solved->chain, shape.points, image.film.slope);
    image.is_regular = sensitivity.is_regular();
    image.derivative = sensitivity.by_point();
    return image;
}

std::optional<ChainImage> solve_any_image(const World& world, const Frame& frame, const ChainStart& start,
                                          const ProjectedPoint& point) {
    if (chain_eye(frame.camera)) return solve_image(world, frame, start, point);
    if (start.events.empty()) return std::nullopt;
    std::vector<Step> steps;
    for (const PathEvent& event : start.events) steps.push_back({event.optic, event.event});
    HistoryQuery query = history_query(world, frame, steps, point.place);
    query.is_direction = point.is_direction;
    std::optional<HistoryImage> found = refine_history_image(query, start.pixel);
    if (!found) return std::nullopt;
    for (std::size_t i = 0; i < steps.size(); ++i)
        if (found->events[i].front != start.events[i].front) return std::nullopt;
    return ChainImage{std::move(found->events), {found->pixel, {}}, found->derivative, true};
}

std::optional<ImageSensitivity> image_sensitivity(const World& world, const Frame& frame,
                                                  const ChainStart& start, const ProjectedPoint& point) {
    const std::optional<ChainEnd> eye = chain_eye(frame.camera);
    if (start.events.empty() || !eye) return std::nullopt;
    const auto media = media_of(world, frame, start);
    if (!media) return std::nullopt;
    PathChain chain = chain_through(world, *eye, start, *media);
    chain.point = {point.place, point.is_direction};
    PerEvent<SurfacePoint> points;
    for (std::size_t i = 0; i < start.events.size(); ++i)
        points.push_back(chain.events[i].surface->eval(start.events[i].face, start.events[i].uv));
    const auto film = film_place(frame.camera, points.front().position, start.pixel);
    if (!film) return std::nullopt;
    return ImageSensitivity{*media, *film, PathSensitivity(chain, points, film->slope)};
}

}  // namespace trilens
