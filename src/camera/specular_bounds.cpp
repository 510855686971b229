// Arithmetic on balls: a vector known to lie within a radius of a middle.
#include "camera/specular_bounds.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "camera/specular_law.h"

namespace trilens {
namespace {

/// From the ball of `from_radius` around `from`: the ways between two balls are those from the one's middle
/// to a ball of both radii. False where the balls meet.
bool sight_from(const Vec3& from, double from_radius, const PlaceBounds& place, Sight& sight) {
    const Vec3 way = place.position - from;
    const double distance = length(way), radius = place.position_radius + from_radius;
    if (!(distance > radius)) return false;
    sight.by_distance = 1 / distance;
    sight.direction = way * sight.by_distance;
    sight.sine = radius * sight.by_distance;
    sight.turn = chord_of(sight.sine);
    return true;
}

struct Light {
    Sight eye, point;
    PathIndices n;
    Vec3 bend{0};          // h at the middle
    double bend_turn = 0;  // no h differs by more
};

/// None where the eye or a point may lie on the piece.
bool light_over(const SpecularQuery& query, double point_radius, const PlaceBounds& place,
                const EyeView& view, Light& light) {
    if (!view.is_apart || !sight_from(query.point, point_radius, place, light.point)) return false;
    light.eye = view.sight;
    light.n = path_indices(query);
    light.bend = light.n.eye * light.eye.direction + light.n.point * light.point.direction;
    light.bend_turn = light.n.eye * light.eye.turn + light.n.point * light.point.turn;
    return true;
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
double rounding_of_law(const SpecularQuery& query, double point_radius, const Light& light,
                       const Vec3& position) {
    constexpr double kRounding = 64 * std::numeric_limits<double>::epsilon();
    const double coordinate =
        std::max({largest_coordinate(position), largest_coordinate(query.point) + point_radius,
                  query.camera.parallel ? 0 : largest_coordinate(query.camera.eye)});
    const double by_nearest = light.point.by_distance + (point_radius > 0 ? light.point.stretch() : 0);
    return kRounding * (light.n.eye * (1 + coordinate * light.eye.by_distance) +
                        light.n.point * (1 + coordinate * by_nearest));
}

}  // namespace

PlaceBounds place_of(const SurfaceBounds& bounds) {
    return {bounds.middle.position, bounds.position_radius, bounds.middle.normal, bounds.normal_radius};
}

EyeView eye_view(const SpecularQuery& query, const PlaceBounds& place) {
    EyeView view;
    if (query.camera.parallel) {
        // Of oblique cameras it is no unit vector.
        view.sight.direction = normalize_or_zero(query.camera.view_direction);
    } else {
        const Vec4& w = query.camera.screen_w;
        const double depth = screen_from_world(query.camera, place.position).z;
        view.is_behind = depth + length(Vec3(w)) * place.position_radius < 0;
        view.is_apart = sight_from(query.camera.eye, 0, place, view.sight);
    }
    // Where every direction may be a normal there are no sides.
    if (!view.is_apart || place.normal_radius >= 1) return view;
    view.cosine = dot(view.sight.direction, place.normal);
    view.knows_side = !(std::fabs(view.cosine) <= view.sight.turn + place.normal_radius);
    if (view.knows_side && query.viewed != ViewedSide::kEither &&
        (view.cosine < 0) != (query.viewed == ViewedSide::kFront))
        view.is_behind = true;
    return view;
}

PlaceTest test_place(const SpecularQuery& query, const PlaceBounds& place, const EyeView& view,
                     double point_radius) {
    PlaceTest test{view.is_behind, place.position_radius, point_radius};
    if (test.empty) return test;
    // Where every direction may be a normal no light is excluded.
    if (place.normal_radius >= 1) {
        test.by_place = std::numeric_limits<double>::infinity();
        return test;
    }
    Sight point;
    if (!view.is_apart || !sight_from(query.point, point_radius, place, point)) return test;
    if (view.knows_side) {
        const double cosine = dot(point.direction, place.normal);
        test.empty = !(std::fabs(cosine) <= point.turn + place.normal_radius) &&
                     (view.cosine * cosine > 0) != (query.event == SpecularEvent::kReflect);
        if (test.empty) return test;
    }

    // Where h is parallel to a normal N, |h x n| = |(h - h') x n + h' x (n - N)| for the middle's h and n.
    const PathIndices i = path_indices(query);
    const Vec3 bend = i.eye * view.sight.direction + i.point * point.direction;
    const double turn = i.eye * view.sight.turn + i.point * point.turn;
    const Vec3& n = place.normal;
    const Vec3 across = bend - dot(bend, n) * n;
    const double most = turn + (length(bend) + turn) * place.normal_radius;
    test.empty = dot(across, across) > most * most;
    test.by_points = i.point * point_radius * point.by_distance;
    test.by_place = most - test.by_points;
    return test;
}

NewtonBounds newton_bounds(const SpecularQuery& query, const SurfaceBounds& bounds, const EyeView& view,
                           const Vec2& half, double point_radius) {
    NewtonBounds result;
    Light light;
    if (!light_over(query, point_radius, place_of(bounds), view, light)) return result;
    const SurfacePoint& middle = bounds.middle;
    const Size u{length(middle.du), bounds.du_radius}, v{length(middle.dv), bounds.dv_radius};
    const double uu = entry_radius(light, u, u, {length(middle.duu), bounds.duu_radius});
    const double uv = entry_radius(light, u, v, {length(middle.duv), bounds.duv_radius});
    const double vv = entry_radius(light, v, v, {length(middle.dvv), bounds.dvv_radius});
    if (!std::isfinite(uu + uv + vv)) return result;

    const SpecularPath path{light.eye.direction, light.point.direction, 1 / light.eye.by_distance,
                            1 / light.point.by_distance, light.bend};
    const Mat2 jacobian = path_hessian(query, path, middle);
    result.inverse = glm::inverse(jacobian);
    result.law = {dot(light.bend, middle.du), dot(light.bend, middle.dv)};
    result.step = -(result.inverse * result.law);
    const Vec2 change(uu * half.x + uv * half.y, uv * half.x + vv * half.y);
    result.spread = absolute_product(result.inverse, change);
    const double rounding = rounding_of_law(query, point_radius, light, middle.position);
    result.rounding = absolute_product(result.inverse, rounding * Vec2(u.length, v.length));
    const double turn = light.n.point * chord_of(point_radius * light.point.by_distance);
    result.shift = absolute_product(result.inverse, turn * Vec2(u.length, v.length));
    const Vec2 sum = result.step + result.spread + result.rounding + result.shift;
    result.known = std::isfinite(sum.x + sum.y);
    return result;
}

void step_with_care(const SpecularQuery& query, const SurfacePoint& middle, NewtonBounds& newton) {
    newton.inverse = glm::inverse(path_hessian(query, middle));
    newton.step = -(newton.inverse * newton.law);
}

}  // namespace trilens
