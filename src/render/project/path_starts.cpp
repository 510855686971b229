#include "render/project/path_starts.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace trilens {
namespace {

/// How far inside of a facet's corners, where paths may break, the places are that are followed, as a share
/// of the way to its middle.
constexpr double kInside = 0.1;
/// Events of a facet's paths lie no farther from those that were followed than these are apart.
constexpr double kEventRoom = 1;
/// Differences over this share of a part's reach tell how its rays turn; they may turn this many times as
/// far, and by so much more.
constexpr double kTurnShare = 0.25, kTurnRoom = 8, kTurnMore = 0.03;

KnownPath known_path(const HistoryPath& path, const SurfaceOf& surface_of) {
    return {path.events, std::all_of(path.events.begin(), path.events.end(), [&](const PathEvent& event) {
                return surface_of(event.optic).is_flat(event.face);
            })};
}

}  // namespace

bool same_faces(std::span<const PathEvent> a, std::span<const PathEvent> b) {
    return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const PathEvent& x, const PathEvent& y) {
        return x.optic == y.optic && x.event == y.event && x.front == y.front && x.face == y.face;
    });
}

bool LonePath::may_reach(double sine, double distance) const {
    return !(sine > kTurnRoom * (turn + move / distance) + kTurnMore);
}

LonePath lone_path(const HistoryQuery& query, const Vec2& pixel, double reach, const SurfaceOf& surface_of) {
    LonePath lone;
    std::optional<HistoryPath> path = history_path(query, pixel);
    if (!path) return lone;
    lone.path = known_path(*path, surface_of);
    lone.turn = lone.move = std::numeric_limits<double>::infinity();
    const double step = kTurnShare * reach;
    if (!std::isfinite(step)) return lone;
    double turn = 0, move = 0;
    for (int axis = 0; axis < 2; ++axis) {
        Vec2 by(0);
        by[axis] = step;
        std::optional<HistoryPath> beside = history_path(query, pixel + by);
        if (!beside) beside = history_path(query, pixel - by);
        if (!beside) return lone;
        turn += length(beside->exit.direction - path->exit.direction) / kTurnShare;
        move += length(beside->exit.origin - path->exit.origin) / kTurnShare;
    }
    lone.turn = turn, lone.move = move;
    return lone;
}

FacetPaths::FacetPaths(const HistoryQuery& query, const std::array<Vec3, 3>& corner, bool proven,
                       const SurfaceOf& surface_of) {
    Vec2 middle(0);
    for (std::size_t k = 0; k < 3; ++k) {
        if (!(corner[k].z > 0)) return;
        pixel_[k] = Vec2(corner[k]) / corner[k].z;
        middle += pixel_[k] / 3.0;
    }
    if (!std::isfinite(weights(middle).x)) return;
    std::array<KnownPath, 3> paths;
    for (std::size_t k = 0; k < 3; ++k) {
        const auto path = history_path(query, pixel_[k] + kInside * (middle - pixel_[k]));
        if (!path) return;
        paths[k] = known_path(*path, surface_of);
        if (!same_faces(paths[k].events, paths[0].events)) return;
    }
    path_ = std::move(paths);
    is_proven_ = proven;
}

/// Of the facet's corners; sums to 1, and not finite where the facet has no area.
Vec3 FacetPaths::weights(const Vec2& pixel) const {
    const Vec2 b = pixel_[1] - pixel_[0], c = pixel_[2] - pixel_[0], to = pixel - pixel_[0];
    const double area = cross(b, c);
    const double of_b = cross(to, c) / area, of_c = cross(b, to) / area;
    return {1 - of_b - of_c, of_b, of_c};
}

PerEvent<PathEvent> FacetPaths::at(const Vec2& pixel) const {
    const std::vector<PathEvent>&a = path_[0].events, &b = path_[1].events, &c = path_[2].events;
    const Vec3 w = (weights(pixel) - kInside / 3) / (1 - kInside);
    PerEvent<PathEvent> events(a.begin(), a.end());
    for (std::size_t i = 0; i < events.size(); ++i)
        events[i].uv = glm::clamp(w.x * a[i].uv + w.y * b[i].uv + w.z * c[i].uv, Vec2(0), Vec2(1));
    return events;
}

bool FacetPaths::have(const Vec2& pixel, std::span<const PathEvent> events) const {
    const Vec3 w = weights(pixel);
    if (!is_proven_ || !(w.x >= 0 && w.y >= 0 && w.z >= 0) || !same_faces(events, path_[0].events))
        return false;
    for (std::size_t i = 0; i < events.size(); ++i) {
        const Vec2 &a = path_[0].events[i].uv, &b = path_[1].events[i].uv, &c = path_[2].events[i].uv;
        const Vec2 low = glm::min(a, glm::min(b, c)), high = glm::max(a, glm::max(b, c));
        const double room = kEventRoom * std::max(high.x - low.x, high.y - low.y);
        const Vec2 off = glm::max(low - events[i].uv, events[i].uv - high);
        if (!(off.x <= room && off.y <= room)) return false;
    }
    return true;
}

}  // namespace trilens
