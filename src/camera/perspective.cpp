// The screen map of linear cameras, and its inverse: the rays of the film.
#include "camera/perspective.h"

#include <cmath>
#include <numbers>
#include <string>

#include "base/check.h"
#include "base/error.h"

namespace trilens {
namespace {

// Sine of the angle between `up` and the view axis below which the film's roll would be rounding noise.
constexpr double kSmallestSine = 1e-9;

[[noreturn]] void reject(const std::string& place, const std::string& message) {
    throw InputError("", place, message);
}

bool is_finite(const Vec3& v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

/// The film's axes in the world: unit, at right angles; `up` here is exact, pointing to the film's top.
struct Frame {
    Vec3 right{0}, up{0}, forward{0};
};

Frame make_frame(const Placement& look_at) {
    if (!is_finite(look_at.eye) || !is_finite(look_at.at) || !is_finite(look_at.up)) {
        reject("lookAt", "eye, at and up must be finite numbers");
    }
    Frame frame;
    frame.forward = normalize_or_zero(look_at.at - look_at.eye);
    if (frame.forward == Vec3(0)) reject("lookAt", "eye and at are the same point");
    const Vec3 right = cross(frame.forward, normalize_or_zero(look_at.up));
    if (!(length(right) > kSmallestSine)) reject("lookAt", "up is zero or parallel to the view axis");
    frame.right = normalize(right);
    frame.up = cross(frame.right, frame.forward);
    return frame;
}

void require_film(int width, int height) {
    if (width < 1 || height < 1) reject("film", "width and height must be at least one pixel");
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
    TRILENS_CHECK(determinant != 0, "a linear camera's map must have full rank");
    return (values.x * cross(row_y, row_z) + values.y * cross(row_z, row_x) +
            values.z * cross(row_x, row_y)) /
           determinant;
}

Ray film_ray(const LinearCamera& camera, double x, double y) {
    const Vec3 row_x = linear_part(camera.screen_x), row_y = linear_part(camera.screen_y);
    if (!camera.parallel) {
        return {camera.eye, solve_rows(row_x, row_y, linear_part(camera.screen_w), Vec3(x, y, 1))};
    }
    const Vec3 centre = screen_from_world(camera, camera.eye);
    const Vec3 offset = solve_rows(row_x, row_y, camera.view_direction, Vec3(x - centre.x, y - centre.y, 0));
    return {camera.eye + offset, camera.view_direction};
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
    const Frame frame = make_frame(params.look_at);
    const double half_angle = params.yfov_degrees * (std::numbers::pi / 360);
    const double pixels_per_slope = 0.5 * params.height / std::tan(half_angle);

    LinearCamera camera;
    camera.eye = params.look_at.eye;
    camera.view_direction = frame.forward;
    const Vec3 x_times_w = pixels_per_slope * frame.right + 0.5 * params.width * frame.forward;
    const Vec3 y_times_w = -pixels_per_slope * frame.up + 0.5 * params.height * frame.forward;
    camera.screen_x = row_through(x_times_w, camera.eye);
    camera.screen_y = row_through(y_times_w, camera.eye);
    camera.screen_w = row_through(frame.forward, camera.eye);
    return camera;
}

LinearCamera make_orthographic(const OrthographicParams& params) {
    require_film(params.width, params.height);
    if (!(params.world_height > 0) || !std::isfinite(params.world_height)) {
        reject("worldHeight", "the height must be a positive number");
    }
    const Frame frame = make_frame(params.look_at);
    const double pixels_per_unit = params.height / params.world_height;

    LinearCamera camera;
    camera.parallel = true;
    camera.eye = params.look_at.eye;
    camera.view_direction = frame.forward;
    camera.screen_x = row_through(pixels_per_unit * frame.right, camera.eye);
    camera.screen_y = row_through(-pixels_per_unit * frame.up, camera.eye);
    camera.screen_x.w += 0.5 * params.width;
    camera.screen_y.w += 0.5 * params.height;
    camera.screen_w = Vec4(0, 0, 0, 1);
    return camera;
}

RayMesh make_camera_mesh(const LinearCamera& camera, int width, int height) {
    TRILENS_CHECK(width > 0 && height > 0, "a film has pixels");
    RayMesh mesh;
    for (const Vec2& corner : {Vec2(0, 0), Vec2(width, 0), Vec2(width, height), Vec2(0, height)}) {
        mesh.rays.push_back(film_ray(camera, corner.x, corner.y));
        mesh.screen.emplace_back(corner, 1);
    }
    mesh.facets = {{0, 1, 2}, {0, 2, 3}};
    return mesh;
}

RayMesh make_ray_mesh(const ExplicitRays& rays, int width, int height) {
    require_film(width, height);
    const std::size_t corners = rays.points.size();
    if (rays.directions.size() != corners) reject("directions", "there must be one direction per point");
    if (rays.screen.size() != corners) reject("screen", "there must be one screen position per point");

    RayMesh mesh;
    for (std::size_t k = 0; k < corners; ++k) {
        const Vec2& screen = rays.screen[k];
        if (!is_finite(rays.points[k])) reject(entry("points", k), "not a finite point");
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
