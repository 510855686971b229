// The screen map of linear cameras, and its inverse: the rays of the film.
#include "camera/linear/linear_cameras.h"

#include <cmath>
#include <numbers>
#include <string>

#include "base/util/check.h"
#include "base/util/error.h"
#include "camera/model/models.h"

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

namespace {

struct ViewAxes {
    Vec3 u{0}, v{0}, n{0};
};

ViewAxes view_axes(const ViewVolume& volume) {
    ViewAxes axes;
    axes.n = normalize_or_zero(volume.vpn);
    axes.u = normalize_or_zero(cross(normalize_or_zero(volume.vup), axes.n));
    axes.v = cross(axes.n, axes.u);
    return axes;
}

Vec3 world_of(const ViewVolume& volume, const ViewAxes& axes, const Vec3& uvn) {
    return volume.vrp + uvn.x * axes.u + uvn.y * axes.v + uvn.z * axes.n;
}

/// Direction of projection: from the prp to the window's middle, in (u, v, n).
Vec3 direction_of_projection(const ViewVolume& volume) {
    const auto& [umin, umax, vmin, vmax] = volume.window;
    return Vec3(0.5 * (umin + umax), 0.5 * (vmin + vmax), 0) - volume.prp;
}

Vec4 plane_row(const Vec3& direction, const Vec3& origin) {
    return {direction, -dot(direction, origin)};
}

}  // namespace

void check_view_volume(const ViewVolume& volume, const CameraSite& site) {
    for (const auto& [name, v] : {std::pair("vrp", volume.vrp), std::pair("vpn", volume.vpn),
                                  std::pair("vup", volume.vup), std::pair("prp", volume.prp)})
        if (!is_finite_vector(v)) site.reject(name, "is not finite");
    const auto& [umin, umax, vmin, vmax] = volume.window;
    if (normalize_or_zero(volume.vpn) == Vec3(0)) site.reject("vpn", "must not be zero");
    if (!(length(cross(normalize_or_zero(volume.vup), normalize_or_zero(volume.vpn))) > 1e-9))
        site.reject("vup", "is zero or parallel to vpn");
    if (!(umin < umax && vmin < vmax) || !std::isfinite(umax - umin) || !std::isfinite(vmax - vmin))
        site.reject("window", "has no area: it is umin, umax, vmin, vmax with umin < umax and vmin < vmax");
    if (volume.prp.z == 0) site.reject("prp", "lies in the view plane: its third number must not be 0");
    const DepthRange depth = depth_range(volume);
    if (!(depth.near_depth < depth.far_depth))
        site.reject("back", "the back plane must lie behind the front plane, seen from the prp");
    if (!volume.parallel && std::isfinite(volume.front) && !(depth.near_depth > 0))
        site.reject("front", "the front plane must lie before the prp");
}

DepthRange depth_range(const ViewVolume& volume) {
    const double towards = volume.prp.z > 0 ? 1 : -1;
    DepthRange depth;
    if (std::isfinite(volume.front)) depth.near_depth = towards * (volume.prp.z - volume.front);
    if (std::isfinite(volume.back)) depth.far_depth = towards * (volume.prp.z - volume.back);
    return depth;
}

LinearCamera make_view_volume(const ViewVolume& volume, const FilmSize& film, const CameraSite& site) {
    require_film(film.width, film.height, site);
    check_view_volume(volume, site);
    const ViewAxes axes = view_axes(volume);
    const auto& [umin, umax, vmin, vmax] = volume.window;
    const double x_per_u = film.width / (umax - umin), y_per_v = -film.height / (vmax - vmin);
    const Vec3 forward = volume.prp.z > 0 ? -axes.n : axes.n;
    const double distance = std::fabs(volume.prp.z);  // from the prp to the view plane

    LinearCamera camera;
    camera.eye = world_of(volume, axes, volume.prp);
    const double x_of_prp = x_per_u * (volume.prp.x - umin), y_of_prp = y_per_v * (volume.prp.y - vmax);
    if (!volume.parallel) {
        // u on the view plane is prp.u + distance * (p - eye) . u / depth.
        camera.view_direction = forward;
        camera.screen_x = plane_row(x_per_u * distance * axes.u + x_of_prp * forward, camera.eye);
        camera.screen_y = plane_row(y_per_v * distance * axes.v + y_of_prp * forward, camera.eye);
        camera.screen_w = plane_row(forward, camera.eye);
        return camera;
    }
    const Vec3 dop = direction_of_projection(volume) / distance;  // of unit depth
    camera.parallel = true;
    camera.view_direction = dop.x * axes.u + dop.y * axes.v + dop.z * axes.n;
    if (dop.x != 0 || dop.y != 0) camera.view_axis = forward;
    // A point at depth z from the prp is moved along the rays to the view plane, at `distance`.
    camera.screen_x = plane_row(x_per_u * (axes.u - dop.x * forward), camera.eye);
    camera.screen_y = plane_row(y_per_v * (axes.v - dop.y * forward), camera.eye);
    camera.screen_x.w += x_of_prp + x_per_u * dop.x * distance;
    camera.screen_y.w += y_of_prp + y_per_v * dop.y * distance;
    camera.screen_w = Vec4(0, 0, 0, 1);
    return camera;
}

namespace {

LinearView linear_view(const PerspectiveCamera& from, const ModelSource& source) {
    const CameraSite& site = source.site;
    if (!(from.near_depth >= 0)) site.reject("near", "must not be negative");
    if (!(from.far_depth > from.near_depth)) site.reject("far", "must be more than near");
    if (!std::isfinite(from.shift.x) || !std::isfinite(from.shift.y)) site.reject("shift", "is not finite");
    source.axes();  // refuses a lookAt that gives none, by the scene's place
    const PerspectiveParams params{source.look_at(), from.yfov, source.film.width, source.film.height,
                                   from.shift};
    return {make_perspective(params), from.near_depth, from.far_depth};
}

/// Oblique; without receding lines orthographic.
LinearView linear_view(const ObliqueCamera& from, const ModelSource& source) {
    const CameraSite& site = source.site;
    if (!(from.ymag > 0 && std::isfinite(from.ymag))) site.reject("ymag", "must be a positive number");
    source.axes();
    if (!(from.scale >= 0 && std::isfinite(from.scale)))
        site.reject("scale", "must be a number that is not negative");
    return {make_oblique(
        {source.look_at(), 2 * from.ymag, from.angle, from.scale, source.film.width, source.film.height})};
}

LinearView linear_view(const OrthographicCamera& from, const ModelSource& source) {
    return linear_view(ObliqueCamera{from.ymag, 0, 0}, source);
}

LinearView linear_view(const ViewVolume& volume, const ModelSource& source) {
    const LinearCamera camera = make_view_volume(volume, source.film, source.site);
    const DepthRange depth = depth_range(volume);
    return {camera, depth.near_depth, depth.far_depth};
}

}  // namespace

LinearView make_linear_view(const CameraDescription& from, const FilmSize& film, const CameraSite& site) {
    TRILENS_CHECK(is_linear(from), "the camera is linear");
    return std::visit(
        [&]<typename Kind>(const Kind& kind) -> LinearView {
            if constexpr (kIsLinear<Kind>) return linear_view(kind, {from, film, site});
            return {};
        },
        from.kind);
}

// A linear camera as a model: a view of a picture that has several.

namespace {

LinearRays linear_rays_of(const LinearView& view, const FilmSize& film) {
    const auto ray = [&](const Vec2& at) {
        Ray one = film_ray(view.camera, at);
        one.origin += view.near_depth * one.direction;
        return one;
    };
    // Over the whole film, so that rounding does not grow across it.
    const Ray corner = ray(Vec2(0));
    const auto per_pixel = [&](const Vec2& end, double pixels) {
        const Ray there = ray(end);
        return Ray{(there.origin - corner.origin) / pixels, (there.direction - corner.direction) / pixels};
    };
    return {corner, per_pixel({film.width, 0}, film.width), per_pixel({0, film.height}, film.height)};
}

class LinearModel final : public CameraModel {
  public:
    explicit LinearModel(const ModelSource& source)
        : view_(make_linear_view(source.from, source.film, source.site)),
          rays_(linear_rays_of(view_, source.film)),
          focus_(source.focus()) {
        if (const auto* volume = std::get_if<ViewVolume>(&source.from.kind))
            focus_ = std::fabs(volume->prp.z);
    }
    std::optional<Ray> ray(const Vec2& at) const override { return rays_.at(at); }
    const LinearRays* linear_rays() const override { return &rays_; }
    std::optional<FilmImage> place(const Vec3& point, std::size_t) const override {
        const Vec3 screen = screen_from_world(view_.camera, point);
        if (!(screen.z > 0)) return std::nullopt;
        const Vec2 pixel = Vec2(screen.x, screen.y) / screen.z;
        const Ray there = rays_.at(pixel);
        const double t = dot(point - there.origin, there.direction) / dot(there.direction, there.direction);
        return FilmImage{pixel, t, there.origin};
    }
    std::optional<Vec3> eye() const override {
        if (view_.camera.parallel) return std::nullopt;
        return view_.camera.eye;
    }
    double focus() const override { return focus_; }

  private:
    LinearView view_;
    LinearRays rays_;
    double focus_;
};

}  // namespace

ModelPointer make_linear_model(const ModelSource& source) {
    return std::make_shared<LinearModel>(source);
}

}  // namespace trilens
