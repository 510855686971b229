// Where a camera sees a point over one history, exactly: Newton's method on the film.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "paths/trace/follow.h"

namespace trilens {

/// One question: at which film positions does the camera's ray pass through `point` after this history?
struct HistoryQuery {
    const PathWorld* world = nullptr;
    std::function<Ray(const Vec2& pixel)> camera_ray;  // exact; pixels from the film's top left
    std::function<Media(const Ray& ray)> around;       // what a ray of the camera starts in; unset: air
    std::vector<PathSegment> history;  // a chain: each segment the parent of the next; only steps, colours
                                       // and `ends` are asked, and the last one ends
    Vec3 point{0};                     // world
};

/// One image of the point.
struct HistoryImage {
    Vec2 pixel{0};
    std::vector<PathEvent> events;  // the path's meetings with optics
    double first_way = 0;           // from the eye to the first of them
    double distance = 0;            // from the last of them to the point
    /// The share of each colour of the point's light that comes to the camera this way.
    Vec3 weight{1};
    double residual = 0;  // distance from the ray to the point, scene units
    /// How the pixel moves with the point: row 0 for x, row 1 for y, in pixels per scene unit.
    std::array<Vec3, 2> derivative{};
};

/// The image that Newton's method reaches from `start`; none where it reaches none: no such image near, or
/// paths from there with another history. What hides the image is not looked at, but for the first optic,
/// which the camera meets where it meets it first.
std::optional<HistoryImage> refine_history_image(const HistoryQuery& query, const Vec2& start);

/// A camera's ray over a history.
struct HistoryPath {
    std::vector<PathEvent> events;
    Ray exit;  // the last ray, unit
};

/// The path of the camera's ray through a film place; none where that ray has another history. Its first
/// optic it meets as the first, whatever hides it.
std::optional<HistoryPath> history_path(const HistoryQuery& query, const Vec2& pixel);

/// The image at a place where it is known to be, without a derivative; none where the camera's ray there has
/// another history, or passes the point by at more than refine_history_image lets stand.
std::optional<HistoryImage> history_image_at(const HistoryQuery& query, const Vec2& pixel);

}  // namespace trilens
