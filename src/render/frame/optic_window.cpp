#include "render/frame/optic_window.h"

#include <algorithm>
#include <cmath>

namespace trilens {
namespace {

/// Of what rounding makes of the sums that a position on the screen is.
constexpr double kRounding = 1e-14;

/// How far off a screen position of a point may be, in pixels, and a pixel more.
double room_around(const LinearCamera& camera, const Vec3& point, double w) {
    const Vec4 sizes(glm::abs(point), 1);
    const double terms =
        std::max(dot(glm::abs(camera.screen_x), sizes), dot(glm::abs(camera.screen_y), sizes));
    return 1 + kRounding * terms / w;
}

}  // namespace

SampleGrid optic_window(const FramedOptic& optic, const CameraRays& camera) {
    const Vec2 film(camera.film.width, camera.film.height);
    const SampleGrid all{0, 0, static_cast<int>(film.x), static_cast<int>(film.y), 1};
    if (!camera.linear) return all;
    Vec2 low = film, high(0);
    for (const Vec3& point : optic.facets->grid().points) {
        const Vec3 s = screen_from_world(*camera.linear, point);
        if (!(s.z > 0)) return all;
        const double room = room_around(*camera.linear, point, s.z);
        const Vec2 at = Vec2(s) / s.z;
        if (!std::isfinite(at.x + at.y + room)) return all;
        low = glm::min(low, at - room);
        high = glm::max(high, at + room);
    }
    low = glm::clamp(glm::floor(low), Vec2(0), film);
    high = glm::clamp(glm::ceil(high), low, film);
    return {static_cast<int>(low.x), static_cast<int>(low.y), static_cast<int>(high.x),
            static_cast<int>(high.y), 1};
}

SampleGrid part_in(const SampleGrid& grid, const SampleGrid& window) {
    SampleGrid part = grid;
    if (!grid.chosen.empty()) return part;
    part.x0 = std::clamp(window.x0, grid.x0, grid.x1);
    part.y0 = std::clamp(window.y0, grid.y0, grid.y1);
    part.x1 = std::clamp(window.x1, part.x0, grid.x1);
    part.y1 = std::clamp(window.y1, part.y0, grid.y1);
    return part;
}

}  // namespace trilens
