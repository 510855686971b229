#include "specular/cell_bounds.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "specular/specular_point.h"

namespace trilens {
namespace {

Vec2 absolute_product(const Mat2& m, const Vec2& v) {
    return {std::fabs(m[0][0]) * v.x + std::fabs(m[1][0]) * v.y,
            std::fabs(m[0][1]) * v.x + std::fabs(m[1][1]) * v.y};
}

/// What rounding leaves of the gradient at a zero, per length of the tangent.
double rounding_of_law(const CellTerms& terms, const Sight& sight, const Vec3& point, double point_radius) {
    const double coordinate = std::max(terms.coordinate, largest_coordinate(point) + point_radius);
    const double by_nearest = sight.by_distance + (point_radius > 0 ? sight.stretch() : 0);
    return rounding_of_way(terms.n.eye, terms.eye_by_distance, coordinate) +
           rounding_of_way(terms.n.point, by_nearest, coordinate);
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
        view.is_apart = sight_from(query.camera.eye, place.position_radius, place.position, view.sight);
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
    if (!view.is_apart ||
        !sight_from(query.point, point_radius + place.position_radius, place.position, point))
        return test;
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

CellTerms cell_terms(const SpecularQuery& query, const SurfaceBounds& bounds, const EyeView& view) {
    const SurfacePoint& m = bounds.middle;
    CellTerms terms;
    terms.bounds = &bounds;
    terms.is_apart = view.is_apart;
    terms.u = Reach::of(m.du, bounds.du_radius);
    terms.v = Reach::of(m.dv, bounds.dv_radius);
    terms.uu = Reach::of(m.duu, bounds.duu_radius);
    terms.uv = Reach::of(m.duv, bounds.duv_radius);
    terms.vv = Reach::of(m.dvv, bounds.dvv_radius);
    terms.n = path_indices(query);
    const Sight& eye = view.sight;
    const double n = terms.n.eye, stretch = eye.stretch();
    terms.eye_bend = n * eye.direction;
    terms.eye_turn = n * eye.turn;
    terms.eye_uu = n * turning_radius(eye, stretch, terms.u, terms.u);
    terms.eye_uv = n * turning_radius(eye, stretch, terms.u, terms.v);
    terms.eye_vv = n * turning_radius(eye, stretch, terms.v, terms.v);
    terms.eye_change_u = turn_of_way(n * eye.by_distance, eye.direction, m.du);
    terms.eye_change_v = turn_of_way(n * eye.by_distance, eye.direction, m.dv);
    terms.eye_by_distance = eye.by_distance;
    terms.coordinate = std::max(largest_coordinate(m.position),
                                query.camera.parallel ? 0 : largest_coordinate(query.camera.eye));
    return terms;
}

bool leaves_cell(const NewtonBounds& newton, const Vec2& half) {
    for (int axis = 0; axis < 2; ++axis) {
        const double reach =
            half[axis] + newton.spread[axis] + newton.shift[axis] + newton.rounding[axis] + kCellBorder;
        if (std::fabs(newton.step[axis]) > reach) return true;
    }
    return false;
}

NewtonBounds newton_bounds(const CellTerms& terms, const Vec3& point, const Vec2& half, double point_radius) {
    NewtonBounds result;
    const SurfacePoint& middle = terms.bounds->middle;
    Sight sight;
    if (!terms.is_apart ||
        !sight_from(point, point_radius + terms.bounds->position_radius, middle.position, sight))
        return result;
    const double n = terms.n.point, stretch = sight.stretch(), turn = terms.eye_turn + n * sight.turn;
    const Vec3 bend = terms.eye_bend + n * sight.direction;
    const double bend_size = length(bend);
    const auto radius = [&](double eye, const Reach& a, const Reach& b, const Reach& second) {
        return eye + n * turning_radius(sight, stretch, a, b) + turn * second.all + bend_size * second.radius;
    };
    const double uu = radius(terms.eye_uu, terms.u, terms.u, terms.uu);
    const double uv = radius(terms.eye_uv, terms.u, terms.v, terms.uv);
    const double vv = radius(terms.eye_vv, terms.v, terms.v, terms.vv);
    if (!std::isfinite(uu + uv + vv)) return result;

    const Vec3 change_u = terms.eye_change_u + turn_of_way(n * sight.by_distance, sight.direction, middle.du);
    const Vec3 change_v = terms.eye_change_v + turn_of_way(n * sight.by_distance, sight.direction, middle.dv);
    const double mixed = dot(change_u, middle.dv) + dot(bend, middle.duv);
    result.inverse = glm::inverse(Mat2(dot(change_u, middle.du) + dot(bend, middle.duu), mixed, mixed,
                                       dot(change_v, middle.dv) + dot(bend, middle.dvv)));
    result.law = {dot(bend, middle.du), dot(bend, middle.dv)};
    result.step = -(result.inverse * result.law);
    const Vec2 sizes(terms.u.length, terms.v.length);
    result.spread = absolute_product(result.inverse, {uu * half.x + uv * half.y, uv * half.x + vv * half.y});
    result.rounding =
        absolute_product(result.inverse, rounding_of_law(terms, sight, point, point_radius) * sizes);
    if (point_radius > 0)
        result.shift =
            absolute_product(result.inverse, n * chord_of(point_radius * sight.by_distance) * sizes);
    const Vec2 sum = result.step + result.spread + result.rounding + result.shift;
    result.known = std::isfinite(sum.x + sum.y);
    return result;
}

void step_with_care(const SpecularQuery& query, const SurfacePoint& middle, NewtonBounds& newton) {
    newton.inverse = glm::inverse(path_hessian(query, middle));
    newton.step = -(newton.inverse * newton.law);
}

}  // namespace trilens
