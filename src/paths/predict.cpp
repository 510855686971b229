#include "paths/predict.h"

#include <cmath>
#include <limits>

namespace trilens {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

Vec3 across(const Vec3& v, const Vec3& unit) {
    return v - dot(v, unit) * unit;
}

}  // namespace

double predicted_displacement(const PredictedRay& predicted) {
    const PathSegment& exact = predicted.look.segments[predicted.segment];
    const Ray& truth = exact.ray;
    const std::vector<Beside>& side = predicted.look.beside;
    if (side.size() != 2 || !side[0].segments[predicted.segment] || !side[1].segments[predicted.segment])
        return kInfinity;

    // Where the exact rays are, at the distance of what is seen; in the environment, where they point.
    const bool meets = predicted.hit.seen();
    const Vec3 seen = meets ? predicted.ray.origin + predicted.hit.t * predicted.ray.direction
                            : normalize_or_zero(predicted.ray.direction);
    const double distance = meets ? dot(seen - truth.origin, truth.direction) : 0;
    const auto reached = [&](const Ray& ray) {
        return meets ? ray.origin + distance * ray.direction : ray.direction;
    };
    const Vec3 here = reached(truth);
    const Vec3 miss = across(seen - here, truth.direction);
    const Vec3 a = across(reached(side[0].segments[predicted.segment]->ray) - here, truth.direction);
    const Vec3 b = across(reached(side[1].segments[predicted.segment]->ray) - here, truth.direction);

    // miss = m_a a + m_b b, least squares.
    const double aa = dot(a, a), ab = dot(a, b), bb = dot(b, b), ma = dot(a, miss), mb = dot(b, miss);
    const double determinant = aa * bb - ab * ab;
    if (!(determinant > 1e-12 * aa * bb)) return miss == Vec3(0) ? 0 : kInfinity;
    const double along_a = (bb * ma - ab * mb) / determinant, along_b = (aa * mb - ab * ma) / determinant;

    const auto film = [&](const Vec3& point) {
        const Vec3 s = predicted.looking.camera.screen(point);
        return Vec2(s.x, s.y) / s.z;
    };
    const Vec2 at = film(predicted.look.place.point);
    const double shift =
        length(along_a * (film(side[0].place.point) - at) + along_b * (film(side[1].place.point) - at));
    return std::isfinite(shift) ? shift : kInfinity;
}

}  // namespace trilens
