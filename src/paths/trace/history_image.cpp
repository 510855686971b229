// The ray's distance from the point, as a map from two film coordinates to two; its Jacobian by central
// differences of exact rays.
#include "paths/trace/follow.h"

#include <cmath>
#include <limits>

namespace trilens {
namespace {

constexpr double kPixelStep = 1e-3;     // pixels, for differences
constexpr double kFarthest = 64;        // pixels that one step may go
constexpr double kPixelsDone = 1e-10;   // pixels: a step below this ends the search
constexpr double kMostResidual = 1e-7;  // of the distance to the point: more is no image
constexpr int kMostWalks = 40, kMostShorter = 12;

/// The path from one film position.
struct Exit {
    Ray ray;  // unit, after the last optic
    std::vector<PathEvent> events;
    double first_way = 0;
    Vec3 weight{1};     // of light from where the last ray starts to the eye
    Id medium = kNone;  // the body in whose glass the last ray runs; kNone: air
};

/// Follows the camera's ray over the history's steps, one after the other.
std::optional<Exit> exit_at(const HistoryQuery& query, const Vec2& pixel) {
    const PathWorld& world = *query.world;
    const Ray ray = query.camera_ray(pixel);
    const Id optic = query.history[0].step.optic;
    std::optional<SurfaceHit> hit = world.optics[optic].tracer->first_hit(ray);
    if (!hit) return std::nullopt;
    Exit exit;
    exit.first_way = hit->t * length(ray.direction);
    const Vec3 incoming = normalize_or_zero(ray.direction);
    Meeting at{optic, incoming, hit->point.position, hit->point.normal,
               dot(incoming, hit->point.normal) <= 0};
    Media media = query.around ? query.around(ray) : Media();
    exit.weight = body_transmittance(world, active_medium(world, media), exit.first_way);
    Colours colours = kAllColours;
    for (const PathSegment& segment : query.history) {
        const Branches ways = branches(world, at, media, colours);
        const Branch* branch = same_branch(ways, segment);
        if (!branch) return std::nullopt;
        media = branch->media;
        colours = branch->colours;
        exit.events.push_back(
            {at.optic, segment.step.event, at.front, hit->face, hit->uv, at.point, at.normal});
        exit.ray = {at.point, branch->direction};
        exit.weight *= branch->weight;
        exit.medium = active_medium(world, media);
        if (segment.ends) continue;
        const std::optional<NextOptic> next = next_optic(world, {exit.ray, at.optic, media});
        if (!next) return std::nullopt;
        exit.weight *= body_transmittance(world, exit.medium, next->distance);
        at = next->meeting;
        hit = next->hit;
    }
    return exit;
}

/// What the ray misses the point by, at right angles to the ray.
Vec3 miss(const Exit& exit, const HistoryQuery& query) {
    const Vec3 to = query.is_direction ? query.point : query.point - exit.ray.origin;
    return to - dot(to, exit.ray.direction) * exit.ray.direction;
}

/// The miss in two axes at right angles to one ray, and how it changes with the pixel.
struct Linear {
    Vec3 axis[2];
    double jacobian[2][2];  // of the miss: [axis][film coordinate]

    double determinant() const { return jacobian[0][0] * jacobian[1][1] - jacobian[0][1] * jacobian[1][0]; }
    /// The change of the pixel that changes the miss by -(a, b).
    Vec2 against(double a, double b) const {
        const double d = determinant();
        return {-(jacobian[1][1] * a - jacobian[0][1] * b) / d,
                -(jacobian[0][0] * b - jacobian[1][0] * a) / d};
    }
};

std::optional<Linear> linearised(const HistoryQuery& query, const Vec2& pixel, const Exit& exit) {
    Linear linear;
    const Vec3& u = exit.ray.direction;
    linear.axis[0] = unit_across(u);
    linear.axis[1] = cross(u, linear.axis[0]);
    for (int k = 0; k < 2; ++k) {
        Vec2 step(0);
        step[k] = kPixelStep;
        const std::optional<Exit> after = exit_at(query, pixel + step), before = exit_at(query, pixel - step);
        if (!after && !before) return std::nullopt;
        const Vec3 change = after && before ? (miss(*after, query) - miss(*before, query)) / (2 * kPixelStep)
                            : after         ? (miss(*after, query) - miss(exit, query)) / kPixelStep
                                            : (miss(exit, query) - miss(*before, query)) / kPixelStep;
        for (int axis = 0; axis < 2; ++axis) linear.jacobian[axis][k] = dot(linear.axis[axis], change);
    }
    if (!(std::fabs(linear.determinant()) > 0)) return std::nullopt;
    return linear;
}

/// What a path is as an image of the point; none where it passes it by.
std::optional<HistoryImage> image_of(const HistoryQuery& query, const Vec2& pixel, const Exit& exit) {
    HistoryImage image;
    image.pixel = pixel;
    image.events = exit.events;
    image.first_way = exit.first_way;
    image.residual = length(miss(exit, query));
    image.weight = exit.weight;
    if (query.is_direction) {
        image.distance = std::numeric_limits<double>::infinity();
        if (!(dot(query.point, exit.ray.direction) > 0) || image.residual > kMostResidual)
            return std::nullopt;
        return image;
    }
    image.distance = dot(query.point - exit.ray.origin, exit.ray.direction);
    image.weight *= body_transmittance(*query.world, exit.medium, image.distance);
    if (!(image.distance > 0) || image.residual > kMostResidual * (image.distance + image.first_way))
        return std::nullopt;
    return image;
}

}  // namespace

std::optional<HistoryPath> history_path(const HistoryQuery& query, const Vec2& pixel) {
    const std::optional<Exit> exit = exit_at(query, pixel);
    if (!exit) return std::nullopt;
    return HistoryPath{exit->events, exit->ray};
}

std::optional<HistoryImage> history_image_at(const HistoryQuery& query, const Vec2& pixel) {
    const std::optional<Exit> exit = exit_at(query, pixel);
    return exit ? image_of(query, pixel, *exit) : std::nullopt;
}

std::optional<HistoryImage> refine_history_image(const HistoryQuery& query, const Vec2& start) {
    Vec2 pixel = start;
    std::optional<Exit> exit = exit_at(query, pixel);
    if (!exit) return std::nullopt;
    double size = length(miss(*exit, query));
    for (int i = 0; i < kMostWalks; ++i) {
        const std::optional<Linear> linear = linearised(query, pixel, *exit);
        if (!linear) return std::nullopt;
        const Vec3 by = miss(*exit, query);
        Vec2 step = linear->against(dot(linear->axis[0], by), dot(linear->axis[1], by));
        const double far = length(step);
        if (!(far < 1e12)) return std::nullopt;
        if (far > kFarthest) step *= kFarthest / far;

        // Halved until the ray comes nearer to the point.
        bool nearer = false;
        for (int h = 0; h < kMostShorter && !nearer; ++h, step *= 0.5) {
            const std::optional<Exit> next = exit_at(query, pixel + step);
            if (!next) continue;
            const double next_size = length(miss(*next, query));
            if (!(next_size < size)) continue;
            pixel += step;
            exit = next;
            size = next_size;
            nearer = true;
        }
        if (!nearer || length(step) < kPixelsDone) break;
    }

    std::optional<HistoryImage> image = image_of(query, pixel, *exit);
    if (!image) return std::nullopt;
    const std::optional<Linear> linear = linearised(query, pixel, *exit);
    if (!linear) return std::nullopt;
    for (int k = 0; k < 3; ++k) {
        const Vec2 moved = linear->against(linear->axis[0][k], linear->axis[1][k]);
        image->derivative[0][k] = moved.x;
        image->derivative[1][k] = moved.y;
    }
    return image;
}

}  // namespace trilens
