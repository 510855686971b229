// Arithmetic on balls: a vector known to lie within a radius of a middle.
#include "camera/specular_bounds.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "camera/specular_law.h"

namespace trilens {
namespace {

/// Directions from the eye (or the point) to a ball of positions.
struct Sight {
    Vec3 direction{0};       // unit, to the ball's middle
    double turn = 0;         // no direction differs by more
    double sine = 0;         // of the largest angle
    double by_distance = 0;  // 1 / distance of the middle

    /// No 1 / distance differs by more.
    double stretch() const { return by_distance * sine / (1 - sine); }
};

/// False where the ball holds the place itself.
bool sight_from(const Vec3& from, const PlaceBounds& place, Sight& sight) {
    const Vec3 way = place.position - from;
    const double distance = length(way);
    if (!(distance > place.position_radius)) return false;
    sight.by_distance = 1 / distance;
    sight.direction = way * sight.by_distance;
    sight.sine = place.position_radius * sight.by_distance;
    // The chord 2 sin(angle / 2) is at most this for all sines up to 1.
    sight.turn = sight.sine * (1 + 0.4143 * sight.sine * sight.sine);
    return true;
}

struct Light {
    Sight eye, point;
    PathIndices n;
    Vec3 bend{0};          // h at the middle
    double bend_turn = 0;  // no h differs by more
};

bool light_over(const SpecularQuery& query, const PlaceBounds& place, Light& light) {
    if (query.camera.parallel) {
        light.eye.direction = query.camera.view_direction;
    } else if (!sight_from(query.camera.eye, place, light.eye)) {
        return false;
    }
    if (!sight_from(query.point, place, light.point)) return false;
    light.n = path_indices(query);
    light.bend = light.n.eye * light.eye.direction + light.n.point * light.point.direction;
    light.bend_turn = light.n.eye * light.eye.turn + light.n.point * light.point.turn;
    return true;
}

bool wrong_side(const SpecularQuery& query, const Light& light, const PlaceBounds& place) {
    const double eye = dot(light.eye.direction, place.normal);
    const double point = dot(light.point.direction, place.normal);
    const double eye_error = light.eye.turn + place.normal_radius;
    if (std::fabs(eye) <= eye_error) return false;
    if (query.viewed != ViewedSide::kEither && (eye < 0) != (query.viewed == ViewedSide::kFront)) return true;
    if (std::fabs(point) <= light.point.turn + place.normal_radius) return false;
    return (eye * point > 0) != (query.event == SpecularEvent::kReflect);
}

/// A vector's length at the middle, and how much the vector changes.
struct Size {
    double length, radius;
};

/// The most that (a . Q b) / d changes, Q the projection across a sight of distance d.
double turning_radius(const Sight& sight, const Size& a, const Size& b) {
    const double all_a = a.length + a.radius, all_b = b.length + b.radius;
    return sight.stretch() * all_a * all_b +
           sight.by_distance * (a.radius * all_b + a.length * (sight.sine * all_b + b.radius));
}

/// The most that an entry of the Hessian changes: a, b the tangents and `second` their second derivative.
double entry_radius(const Light& light, const Size& a, const Size& b, const Size& second) {
    return light.n.eye * turning_radius(light.eye, a, b) + light.n.point * turning_radius(light.point, a, b) +
           light.bend_turn * (second.length + second.radius) + length(light.bend) * second.radius;
}

double largest_coordinate(const Vec3& v) {
    return std::max({std::fabs(v.x), std::fabs(v.y), std::fabs(v.z)});
}

Vec2 absolute_product(const Mat2& m, const Vec2& v) {
    return {std::fabs(m[0][0]) * v.x + std::fabs(m[1][0]) * v.y,
            std::fabs(m[0][1]) * v.x + std::fabs(m[1][1]) * v.y};
}

/// What rounding leaves of the gradient at a zero, per length of the tangent.
double rounding_of_law(const SpecularQuery& query, const Light& light, const Vec3& position) {
    constexpr double kRounding = 64 * std::numeric_limits<double>::epsilon();
    const double coordinate = std::max({largest_coordinate(position), largest_coordinate(query.point),
                                        query.camera.parallel ? 0 : largest_coordinate(query.camera.eye)});
    return kRounding * (light.n.eye * (1 + coordinate * light.eye.by_distance) +
                        light.n.point * (1 + coordinate * light.point.by_distance));
}

}  // namespace

PlaceBounds place_of(const SurfaceBounds& bounds) {
    return {bounds.middle.position, bounds.position_radius, bounds.middle.normal, bounds.normal_radius};
}

bool holds_no_image(const SpecularQuery& query, const PlaceBounds& place) {
    if (!query.camera.parallel) {
        const Vec4& w = query.camera.screen_w;
        const double depth = screen_from_world(query.camera, place.position).z;
        if (depth + length(Vec3(w)) * place.position_radius < 0) return true;
    }
    // Where every direction may be a normal no light is excluded.
    if (place.normal_radius >= 1) return false;
    Light light;
    if (!light_over(query, place, light)) return false;
    if (wrong_side(query, light, place)) return true;

    // Where h is parallel to a normal N, |h x n| = |(h - h') x n + h' x (n - N)| for the middle's h and n.
    const Vec3& n = place.normal;
    const Vec3 across = light.bend - dot(light.bend, n) * n;
    const double most = light.bend_turn + (length(light.bend) + light.bend_turn) * place.normal_radius;
    return dot(across, across) > most * most;
}

NewtonBounds newton_bounds(const SpecularQuery& query, const SurfaceBounds& bounds, const Vec2& half) {
    NewtonBounds result;
    Light light;
    if (!light_over(query, place_of(bounds), light)) return result;
    const SurfacePoint& middle = bounds.middle;
    const Size u{length(middle.du), bounds.du_radius}, v{length(middle.dv), bounds.dv_radius};
    const double uu = entry_radius(light, u, u, {length(middle.duu), bounds.duu_radius});
    const double uv = entry_radius(light, u, v, {length(middle.duv), bounds.duv_radius});
    const double vv = entry_radius(light, v, v, {length(middle.dvv), bounds.dvv_radius});
    if (!std::isfinite(uu + uv + vv)) return result;

    const Mat2 jacobian = path_hessian(query, middle);
    result.inverse = glm::inverse(jacobian);
    const Vec2 law(dot(light.bend, middle.du), dot(light.bend, middle.dv));
    result.step = -(result.inverse * law);
    const Vec2 change(uu * half.x + uv * half.y, uv * half.x + vv * half.y);
    result.spread = absolute_product(result.inverse, change);
    const double rounding = rounding_of_law(query, light, middle.position);
    result.rounding = absolute_product(result.inverse, rounding * Vec2(u.length, v.length));
    const Vec2 sum = result.step + result.spread + result.rounding;
    result.known = std::isfinite(sum.x + sum.y);
    return result;
}

}  // namespace trilens
