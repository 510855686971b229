#include "paths/facets/divide_facet.h"

#include <cmath>
#include <limits>
#include <optional>

namespace trilens {
namespace {

constexpr double kNoError = std::numeric_limits<double>::infinity();

Vec3 across(const Vec3& v, const Vec3& unit) {
    return v - dot(v, unit) * unit;
}

/// The numbers m with miss = m.x a + m.y b, least squares; none where a and b are one line.
std::optional<Vec2> in_parts(const Vec3& miss, const Vec3& a, const Vec3& b) {
    const double aa = dot(a, a), ab = dot(a, b), bb = dot(b, b), ma = dot(a, miss), mb = dot(b, miss);
    const double determinant = aa * bb - ab * ab;
    if (!(determinant > 1e-12 * aa * bb)) return std::nullopt;
    return Vec2(bb * ma - ab * mb, aa * mb - ab * ma) / determinant;
}

double length_of(const Vec2& shift) {
    const double pixels = length(shift);
    return std::isfinite(pixels) ? pixels : kNoError;
}

}  // namespace

double predicted_displacement(const PredictedRay& predicted) {
    const PathSegment& exact = predicted.probe.segments[predicted.segment];
    const Ray& truth = exact.ray;
    const std::vector<OffsetProbe>& side = predicted.probe.beside;
    if (side.size() != 2 || !side[0].segments[predicted.segment] || !side[1].segments[predicted.segment])
        return kNoError;

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

    const std::optional<Vec2> steps = in_parts(miss, a, b);
    if (!steps) return miss == Vec3(0) ? 0 : kNoError;
    return length_of(steps->x * side[0].step + steps->y * side[1].step);
}

double estimated_displacement(const EstimatedRay& estimated) {
    const RayMesh& mesh = estimated.mesh;
    const IdTriple& corner = mesh.facets[estimated.facet];
    const Ray ray = interpolated_ray(mesh, estimated.facet, estimated.weights);
    const Ray& exact = estimated.exact;

    // The miss, and how the place that is seen moves with the weights of the second and third corner.
    const bool meets = estimated.hit.seen();
    const double scale = meets ? 1 : 1 / length(ray.direction);
    const Vec3 seen = meets ? ray.origin + estimated.hit.t * ray.direction : scale * ray.direction;
    const Vec3 here =
        meets ? exact.origin + dot(seen - exact.origin, exact.direction) * exact.direction : exact.direction;
    const auto moves = [&](std::size_t k) {
        const Ray &from = mesh.rays[corner[0]], &to = mesh.rays[corner[k]];
        const Vec3 turn = to.direction - from.direction;
        return across(meets ? to.origin - from.origin + estimated.hit.t * turn : scale * turn,
                      exact.direction);
    };
    const Vec3 miss = across(seen - here, exact.direction);
    const std::optional<Vec2> steps = in_parts(miss, moves(1), moves(2));
    if (!steps) return miss == Vec3(0) ? 0 : kNoError;

    Vec3 screen(0);
    for (std::size_t k = 0; k < 3; ++k)
        screen += estimated.weights[static_cast<int>(k)] * mesh.screen[corner[k]];
    const Vec2 pixel = Vec2(screen) / screen.z;
    const auto film_moves = [&](std::size_t k) {
        const Vec3 way = mesh.screen[corner[k]] - mesh.screen[corner[0]];
        return (Vec2(way) - pixel * way.z) / screen.z;
    };
    return length_of(steps->x * film_moves(1) + steps->y * film_moves(2));
}

}  // namespace trilens
