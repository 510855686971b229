// Directions, their turning, and the second derivatives of the optical path.
#include "specular/specular_law.h"

#include <limits>

namespace trilens {

PathIndices path_indices(const SpecularQuery& query) {
    if (query.event == SpecularEvent::kReflect) return {1, 1};
    return {query.eye_index, query.point_index};
}

SpecularPath specular_path(const SpecularQuery& query, const Vec3& position) {
    SpecularPath path;
    const Vec3 incident = incident_direction(query.camera, position), back = position - query.point;
    path.from_eye = normalize_or_zero(incident);
    path.from_point = normalize_or_zero(back);
    path.eye_distance = query.camera.parallel ? std::numeric_limits<double>::infinity() : length(incident);
    path.point_distance = length(back);
    const PathIndices n = path_indices(query);
    path.bend = n.eye * path.from_eye + n.point * path.from_point;
    return path;
}

namespace {

/// How the unit direction to P from a fixed point changes as P moves by `step`.
Vec3 turn(const Vec3& direction, double distance, const Vec3& step) {
    return (step - dot(direction, step) * direction) / distance;
}

}  // namespace

Mat2 path_hessian(const SpecularQuery& query, const SurfacePoint& point) {
    return path_hessian(query, specular_path(query, point.position), point);
}

Mat2 path_hessian(const SpecularQuery& query, const SpecularPath& path, const SurfacePoint& point) {
    const PathIndices n = path_indices(query);
    auto bend_change = [&](const Vec3& step) {
        return n.eye * turn(path.from_eye, path.eye_distance, step) +
               n.point * turn(path.from_point, path.point_distance, step);
    };
    const Vec3 change_u = bend_change(point.du), change_v = bend_change(point.dv);
    const double uu = dot(change_u, point.du) + dot(path.bend, point.duu);
    const double uv = dot(change_u, point.dv) + dot(path.bend, point.duv);
    const double vv = dot(change_v, point.dv) + dot(path.bend, point.dvv);
    return {Vec2(uu, uv), Vec2(uv, vv)};
}

bool sides_fit(const SpecularQuery& query, const SpecularPath& path, const Vec3& normal) {
    const double sides = dot(path.from_eye, normal) * dot(path.from_point, normal);
    const bool front = dot(path.from_eye, normal) < 0;
    if (query.viewed != ViewedSide::kEither && front != (query.viewed == ViewedSide::kFront)) return false;
    return query.event == SpecularEvent::kReflect ? sides > 0 : sides < 0;
}

}  // namespace trilens
