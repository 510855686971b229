#include "caustics/exact_arrivals.h"

#include <cmath>

namespace trilens {
namespace {

constexpr int kNewtonSteps = 12;
/// Of derivatives by central differences: a share of the window, near the cube root of a double's precision.
constexpr double kDifferenceStep = 1e-5;
/// A beam's map, continued beyond its triangle, is believed so far: in units of the triangle.
constexpr double kFarStart = 1.5;

/// d(plane) / d(place).
std::optional<Mat2> derivative(const ExactMap& map, const ReceiverPlane& plane, const Vec2& place) {
    Mat2 by_place(0);
    for (int k = 0; k < 2; ++k) {
        Vec2 step(0);
        step[k] = kDifferenceStep;
        const std::optional<Vec2> high = map.fall(place + step, plane), low = map.fall(place - step, plane);
        if (!high || !low) return std::nullopt;
        by_place[k] = (*high - *low) / (2 * kDifferenceStep);
    }
    return by_place;
}

/// The affine map of a triangle: from places to the plane; none where it has no area.
std::optional<Mat2> affine(const std::array<Vec2, 3>& places, const FallenBeam& fallen) {
    const Mat2 place(places[1] - places[0], places[2] - places[0]),
        plane(fallen.at[1] - fallen.at[0], fallen.at[2] - fallen.at[0]);
    if (glm::determinant(place) == 0 || glm::determinant(plane) == 0) return std::nullopt;
    return plane * glm::inverse(place);
}

}  // namespace

std::optional<Vec2> ExactMap::fall(const Vec2& place, const ReceiverPlane& plane, SinglePath* single) const {
    std::optional<SinglePath> found = follow_history(space, source, window.ray(place), like);
    if (!found) return std::nullopt;
    const Ray& ray = found->path.ray;
    const double falls = -dot(ray.direction, plane.normal);
    const double t = dot(ray.origin - plane.point, plane.normal) / falls;
    if (!(falls > 0) || !(t >= 0)) return std::nullopt;
    const Vec2 at = plane.at(ray.origin + t * ray.direction);
    if (single) *single = std::move(*found);
    return at;
}

std::optional<ExactArrival> ExactMap::arrive(const std::array<Vec2, 3>& places, const FallenBeam& fallen,
                                             const ReceiverPlane& plane, double tolerance) const {
    std::optional<Mat2> by_place = affine(places, fallen);
    if (!by_place) return std::nullopt;
    Vec2 place = places[0] - glm::inverse(*by_place) * fallen.at[0];
    const Vec2 middle = (places[0] + places[1] + places[2]) / 3.0;
    double reach = 0;
    for (const Vec2& corner : places) reach = std::max(reach, length(corner - middle));
    if (length(place - middle) > kFarStart * reach) return std::nullopt;

    SinglePath single;
    std::optional<Vec2> off = fall(place, plane, &single);
    for (int i = 0; i < kNewtonSteps; ++i) {
        if (!off) return std::nullopt;
        if (length(*off) < tolerance) break;
        // The beam's own slope brings it near; then the exact one.
        if (i > 1) {
            by_place = derivative(*this, plane, place);
            if (!by_place || glm::determinant(*by_place) == 0) return std::nullopt;
        }
        Vec2 step = -(glm::inverse(*by_place) * *off);
        if (length(step) > reach) step *= reach / length(step);
        std::optional<Vec2> next;
        for (int half = 0; half < 6; ++half, step *= 0.5) {
            next = fall(place + step, plane, &single);
            if (next && length(*next) < 2 * length(*off)) break;
        }
        place += step;
        off = next;
    }
    if (!off || !(length(*off) < tolerance)) return std::nullopt;
    if (length(place - middle) > 4 * kFarStart * reach) return std::nullopt;
    by_place = derivative(*this, plane, place);
    if (!by_place) return std::nullopt;
    const double spread = std::fabs(glm::determinant(*by_place)) * plane.unit_area;
    if (!(spread > 0)) return std::nullopt;
    return ExactArrival{place, window.ray(place), std::move(single), window.density(place) / spread};
}

}  // namespace trilens
