#include "camera/linear/view_volume.h"

#include <cmath>

namespace trilens {
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

}  // namespace trilens
