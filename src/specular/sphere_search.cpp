#include "specular/sphere_search.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "specular/specular_point.h"

namespace trilens {
namespace {

/// h . normal of zeros at which eye and point are on the same side is no less; where they are not it is zero.
constexpr double kClearOfRim = 0.01;
/// The same of the one in front where no other is asked for, and of the eye outside, in radii.
constexpr double kClearInFront = 1e-3;
/// What is left of the law at a zero: some hundred rounding errors of directions, and those of coordinates.
constexpr double kSphereResidual = 2e-13, kSphereRounding = 64;
constexpr int kLastSphereSteps = 2;  // from seven digits to more than there are

Vec3 in_single(const Vec3& v) {
    return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
}

}  // namespace

SphereSearch::SphereSearch(const Surface& surface, const SpecularQuery& query, const SearchLimits& limits,
                           bool hides)
    : surface_(surface), query_(query) {
    const double curvature = surface.sphere_curvature();
    applies_ = curvature > 0 && query.event == SpecularEvent::kReflect && query.own_normals &&
               !query.camera.parallel && limits.smallest_cell <= SearchLimits().smallest_cell &&
               limits.most_cells >= SearchLimits().most_cells &&
               surface.sphere_place(Vec3(0, 0, 1)).face != kNone;
    if (!applies_) return;
    const SurfacePoint at = surface.eval(0, Vec2(0.5));
    sphere_.radius = 1 / curvature;
    sphere_.center = at.position - sphere_.radius * at.normal;
    const bool is_outside = length(query.camera.eye - sphere_.center) > (1 + kClearInFront) * sphere_.radius;
    if (is_outside && hides && query.viewed == ViewedSide::kEither) query_.viewed = ViewedSide::kFront;
    asks_front_ = is_outside && query_.viewed == ViewedSide::kFront;
}

/// Newton's method on the sphere, whose Hessian is diagonal in the plane of eye, point and centre and across
/// it; from seven digits of the rough zero, so that the result does not depend on how the processor came by
/// it.
std::optional<SphereSearch::Zero> SphereSearch::settle(const Vec3& rough, const Vec3& point) const {
    const double by_radius = 1 / sphere_.radius;
    const Vec3 from[2] = {by_radius * (query_.camera.eye - sphere_.center),
                          by_radius * (point - sphere_.center)};
    Vec3 normal = normalize_or_zero(in_single(rough));
    Vec3 across = normalize_or_zero(cross(from[0], from[1]));
    if (across == Vec3(0)) across = unit_across(normal);
    for (int step = 0; step < kLastSphereSteps; ++step) {
        Vec3 bend(0);
        double slope_along = 0, slope_across = 0;
        for (const Vec3& start : from) {
            const Vec3 way = normal - start;
            const double by_distance = 1 / length(way), cosine = by_distance * dot(way, normal);
            bend += by_distance * way;
            slope_along += cosine * (cosine * by_distance - 1);
            slope_across += by_distance - cosine;
        }
        // The second derivatives along a great circle: those of the path, less what the sphere bends away.
        const Vec3 along = cross(across, normal);
        bend -= dot(bend, normal) * normal;
        normal = normalize_or_zero(normal - dot(bend, along) / slope_along * along -
                                   dot(bend, across) / slope_across * across);
    }
    SpecularQuery query = query_;
    query.point = point;
    Zero zero;
    SpecularPoint& image = zero.point;
    image.position = sphere_.center + sphere_.radius * normal;
    image.normal = normal;
    const SpecularPath path = specular_path(query, image.position);
    zero.along = dot(path.bend, normal);
    image.residual = length(path.bend - zero.along * normal);
    const double coordinate = std::max({length(image.position), length(point), length(query_.camera.eye)});
    const double floor = kSphereResidual + kSphereRounding * std::numeric_limits<double>::epsilon() *
                                               coordinate / std::min(path.eye_distance, path.point_distance);
    if (!(image.residual <= floor)) return std::nullopt;

    image.at = surface_.sphere_place(normal);
    if (image.at.face == kNone) return std::nullopt;
    const Vec3 screen = screen_from_world(query_.camera, image.position);
    zero.is_image = sides_fit(query, path, normal) && screen.z > 0;
    image.pixel = Vec2(screen) / screen.z;
    image.distance = path.point_distance;
    image.t = path.point_distance / path.eye_distance;
    image.front = dot(path.from_eye, normal) < 0;
    image.iterations = kLastSphereSteps;
    return zero;
}

std::optional<SpecularSearch> SphereSearch::settle_front(const FrontZeros& zeros, std::size_t lane,
                                                         const Vec3& point) const {
    SpecularSearch search;
    search.complete = true;
    if (zeros.none >> lane & 1) return search;
    if (!(zeros.one >> lane & 1)) return std::nullopt;
    const std::optional<Zero> zero = settle(zeros.at.at(lane), point);
    if (!zero || !(zero->along < -kClearInFront)) return std::nullopt;
    if (zero->is_image) search.images.push_back(zero->point);
    return search;
}

std::optional<SpecularSearch> SphereSearch::settle_both(const SphereZeros& zeros, std::size_t lane,
                                                        const Vec3& point) const {
    const bool lit = zeros.lit >> lane & 1, shaded = zeros.shaded >> lane & 1;
    if (!lit && !shaded) return std::nullopt;
    const std::optional<Zero> first = settle(zeros.first.at(lane), point),
                              second = settle(zeros.second.at(lane), point);
    if (!first || !second) return std::nullopt;
    // One seen from outside and one from inside, or two from inside: as counted.
    const int outside = (first->along < -kClearOfRim) + (second->along < -kClearOfRim);
    const int inside = (first->along > kClearOfRim) + (second->along > kClearOfRim);
    if (outside != (lit ? 1 : 0) || inside != (lit ? 1 : 2)) return std::nullopt;
    SpecularSearch search;
    search.complete = true;
    for (const Zero* zero : {&*first, &*second})
        if (zero->is_image) search.images.push_back(zero->point);
    search.images = distinct_images(std::move(search.images));
    // Two that come to one are not two.
    const std::size_t both = static_cast<std::size_t>(first->is_image + second->is_image);
    return search.images.size() == both ? std::optional(std::move(search)) : std::nullopt;
}

std::vector<std::optional<SpecularSearch>> SphereSearch::find(std::span<const Vec3> points) const {
    std::vector<std::optional<SpecularSearch>> found(points.size());
    PointLanes lanes;
    SphereZeros zeros;
    FrontZeros front;
    for (std::size_t i = 0; i < points.size(); i += kPointLanes) {
        const std::size_t count = std::min(kPointLanes, points.size() - i);
        for (std::size_t lane = 0; lane < kPointLanes; ++lane)
            lanes.set(lane, points[i + std::min(lane, count - 1)]);
        if (asks_front_) {
            find_front_zeros(sphere_, query_.camera.eye, lanes, front);
            for (std::size_t lane = 0; lane < count; ++lane)
                found[i + lane] = settle_front(front, lane, points[i + lane]);
            continue;
        }
        find_zeros(sphere_, query_.camera.eye, lanes, zeros);
        for (std::size_t lane = 0; lane < count; ++lane)
            found[i + lane] = settle_both(zeros, lane, points[i + lane]);
    }
    return found;
}

}  // namespace trilens
