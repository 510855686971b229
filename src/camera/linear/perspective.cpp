// The screen map of linear cameras, and its inverse: the rays of the film.
#include "camera/linear/perspective.h"

#include <cmath>
#include <numbers>
#include <string>

#include "base/util/error.h"

namespace trilens {
namespace {

[[noreturn]] void reject(const std::string& place, const std::string& message) {
    throw InputError("", place, message);
}

/// The row of the screen map that is direction . (point - origin).
Vec4 row_through(const Vec3& direction, const Vec3& origin) {
    return {direction, -dot(direction, origin)};
}

Vec3 linear_part(const Vec4& row) {
    return {row.x, row.y, row.z};
}

/// The p with rows . p = values, by Cramer's rule.
Vec3 solve_rows(const Vec3& row_x, const Vec3& row_y, const Vec3& row_z, const Vec3& values) {
    const double determinant = triple(row_x, row_y, row_z);
    if (!(std::fabs(determinant) > 0) || !std::isfinite(determinant))
        reject("camera", "its map from the world to the film has no inverse");
    return (values.x * cross(row_y, row_z) + values.y * cross(row_z, row_x) +
            values.z * cross(row_x, row_y)) /
           determinant;
}

std::string entry(const char* field, std::size_t index) {
    return field + ("/" + std::to_string(index));
}

}  // namespace

LinearCamera make_perspective(const PerspectiveParams& params) {
    require_film(params.width, params.height);
    if (!(params.yfov_degrees > 0 && params.yfov_degrees < 180)) {
        reject("yfov", "the angle must lie between 0 and 180 degrees");
    }
    const FilmAxes axes = make_film_axes(params.look_at);
    const double half_angle = params.yfov_degrees * (std::numbers::pi / 360);
    const double pixels_per_slope = 0.5 * params.height / std::tan(half_angle);

    LinearCamera camera;
    camera.eye = params.look_at.eye;
    camera.view_direction = axes.forward;
    const Vec3 x_times_w =
        pixels_per_slope * axes.right + (0.5 - params.shift.x) * params.width * axes.forward;
    const Vec3 y_times_w =
        -pixels_per_slope * axes.up + (0.5 + params.shift.y) * params.height * axes.forward;
    camera.screen_x = row_through(x_times_w, camera.eye);
    camera.screen_y = row_through(y_times_w, camera.eye);
    camera.screen_w = row_through(axes.forward, camera.eye);
    return camera;
}

LinearCamera make_orthographic(const OrthographicParams& params) {
    return make_oblique({params.look_at, params.world_height, 0, 0, params.width, params.height});
}

LinearCamera make_oblique(const ObliqueParams& params) {
    require_film(params.width, params.height);
    if (!(params.world_height > 0) || !std::isfinite(params.world_height))
        reject("worldHeight", "the height must be a positive number");
    if (!std::isfinite(params.angle_degrees)) reject("angle", "the angle must be a finite number");
    if (!std::isfinite(params.scale)) reject("scale", "the scale must be a finite number");
    const FilmAxes axes = make_film_axes(params.look_at);
    const double pixels_per_unit = params.height / params.world_height;
    const double angle = params.angle_degrees * (std::numbers::pi / 180);
    const Vec2 receding(params.scale * std::cos(angle), params.scale * std::sin(angle));

    LinearCamera camera;
    camera.parallel = true;
    camera.eye = params.look_at.eye;
    camera.view_direction = axes.forward - receding.x * axes.right - receding.y * axes.up;
    camera.screen_x = row_through(pixels_per_unit * (axes.right + receding.x * axes.forward), camera.eye);
    camera.screen_y = row_through(-pixels_per_unit * (axes.up + receding.y * axes.forward), camera.eye);
    camera.screen_x.w += 0.5 * params.width;
    camera.screen_y.w += 0.5 * params.height;
    camera.screen_w = Vec4(0, 0, 0, 1);
    if (params.scale != 0) camera.view_axis = axes.forward;
    return camera;
}

Ray film_ray(const LinearCamera& camera, const Vec2& at) {
    const Vec3 row_x = linear_part(camera.screen_x), row_y = linear_part(camera.screen_y);
    if (!camera.parallel) {
        return {camera.eye, solve_rows(row_x, row_y, linear_part(camera.screen_w), Vec3(at, 1))};
    }
    const Vec3 centre = screen_from_world(camera, camera.eye);
    const Vec3 axis = camera.view_axis == Vec3(0) ? camera.view_direction : camera.view_axis;
    const Vec3 offset = solve_rows(row_x, row_y, axis, Vec3(at.x - centre.x, at.y - centre.y, 0));
    return {camera.eye + offset, camera.view_direction};
}

RayMesh make_camera_mesh(const LinearCamera& camera, double width, double height, double from) {
    if (!(width > 0 && height > 0) || !std::isfinite(width) || !std::isfinite(height))
        reject("film", "width and height must be positive numbers of pixels");
    if (!std::isfinite(from)) reject("from", "is not finite");
    RayMesh mesh;
    for (const Vec2& corner : {Vec2(0, 0), Vec2(width, 0), Vec2(width, height), Vec2(0, height)}) {
        Ray ray = film_ray(camera, corner);
        if (from != 0) ray.origin += from * ray.direction;
        if (!is_finite_vector(ray.origin) || !is_finite_vector(ray.direction))
            reject("camera", "a ray of the film's corners is not finite");
        mesh.rays.push_back(ray);
        mesh.screen.emplace_back(corner, 1);
    }
    mesh.facets = {{0, 1, 2}, {0, 2, 3}};
    return mesh;
}

RayMesh make_ray_mesh(const ExplicitRays& rays, double width, double height) {
    require_film(width, height);
    const std::size_t corners = rays.points.size();
    if (rays.directions.size() != corners) reject("directions", "there must be one direction per point");
    if (rays.screen.size() != corners) reject("screen", "there must be one screen position per point");

    RayMesh mesh;
    for (std::size_t k = 0; k < corners; ++k) {
        const Vec2& screen = rays.screen[k];
        if (!is_finite_vector(rays.points[k])) reject(entry("points", k), "not a finite point");
        if (normalize_or_zero(rays.directions[k]) == Vec3(0)) {
            reject(entry("directions", k), "a direction must be finite and not zero");
        }
        if (!std::isfinite(screen.x) || !std::isfinite(screen.y))
            reject(entry("screen", k), "not a finite position");
        mesh.rays.push_back({rays.points[k], rays.directions[k]});
        mesh.screen.emplace_back(screen.x * width, screen.y * height, 1);
    }
    for (std::size_t f = 0; f < rays.triangles.size(); ++f) {
        for (const Id corner : rays.triangles[f]) {
            if (corner >= corners)
                reject(entry("triangles", f), "there is no corner " + std::to_string(corner));
        }
        mesh.facets.push_back(rays.triangles[f]);
    }
    return mesh;
}

}  // namespace trilens
