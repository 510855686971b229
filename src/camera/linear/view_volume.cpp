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

/// GLM's matrices are made of columns; this one of rows.
Mat4 of_rows(const Vec4& x, const Vec4& y, const Vec4& z, const Vec4& w) {
    return glm::transpose(Mat4(x, y, z, w));
}

Mat4 translation(const Vec3& by) {
    return of_rows({1, 0, 0, by.x}, {0, 1, 0, by.y}, {0, 0, 1, by.z}, {0, 0, 0, 1});
}

Mat4 scaling(const Vec3& by) {
    return of_rows({by.x, 0, 0, 0}, {0, by.y, 0, 0}, {0, 0, by.z, 0}, {0, 0, 0, 1});
}

/// R T(-vrp): world to viewing coordinates.
Mat4 viewing_from_world(const ViewVolume& volume) {
    const ViewAxes axes = view_axes(volume);
    return of_rows(Vec4(axes.u, 0), Vec4(axes.v, 0), Vec4(axes.n, 0), {0, 0, 0, 1}) *
           translation(-volume.vrp);
}

/// Direction of projection: from the prp to the window's middle, in (u, v, n).
Vec3 direction_of_projection(const ViewVolume& volume) {
    const auto& [umin, umax, vmin, vmax] = volume.window;
    return Vec3(0.5 * (umin + umax), 0.5 * (vmin + vmax), 0) - volume.prp;
}

/// Makes the direction of projection parallel to the z axis.
Mat4 shear(const ViewVolume& volume) {
    const Vec3 dop = direction_of_projection(volume);
    return of_rows({1, 0, -dop.x / dop.z, 0}, {0, 1, -dop.y / dop.z, 0}, {0, 0, 1, 0}, {0, 0, 0, 1});
}

/// Throws InputError where the volume is none with two clipping planes, its rays taken as parallel or not.
void check_clipped(ViewVolume volume, bool parallel) {
    volume.parallel = parallel;
    check_view_volume(volume);
    if (!std::isfinite(volume.front)) CameraSite().reject("front", "a normalising matrix needs this plane");
    if (!std::isfinite(volume.back)) CameraSite().reject("back", "a normalising matrix needs this plane");
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

Mat4 npar(const ViewVolume& volume) {
    check_clipped(volume, true);
    const auto& [umin, umax, vmin, vmax] = volume.window;
    const Mat4 t = translation({-0.5 * (umax + umin), -0.5 * (vmax + vmin), -volume.front});
    const Mat4 s = scaling({2 / (umax - umin), 2 / (vmax - vmin), 1 / (volume.front - volume.back)});
    return s * t * shear(volume) * viewing_from_world(volume);
}

Mat4 nper(const ViewVolume& volume) {
    check_clipped(volume, false);
    const auto& [umin, umax, vmin, vmax] = volume.window;
    const double vrp_z = -volume.prp.z;  // of the vrp, after the prp has moved to the origin
    const Mat4 s = scaling({2 * vrp_z / ((umax - umin) * (vrp_z + volume.back)),
                            2 * vrp_z / ((vmax - vmin) * (vrp_z + volume.back)), -1 / (vrp_z + volume.back)});
    return s * shear(volume) * translation(-volume.prp) * viewing_from_world(volume);
}

double nper_front(const ViewVolume& volume) {
    check_clipped(volume, false);
    return -(volume.front - volume.prp.z) / (volume.back - volume.prp.z);
}

Mat4 parallel_from_perspective(double z_min) {
    if (!(z_min > -1 && z_min < 0))
        CameraSite().reject("z_min", "the front plane lies between the eye and the back plane: in (-1, 0)");
    return of_rows({1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1 / (1 + z_min), -z_min / (1 + z_min)}, {0, 0, -1, 0});
}

std::vector<Vec4> clip_homogeneous(std::span<const Vec4> polygon) {
    // Each plane as the signed distance of a corner, by its coordinates; the last two are z = 0 and z = -w.
    // w > 0 follows from the first two.
    static const Vec4 kPlanes[] = {{1, 0, 0, 1},  {-1, 0, 0, 1}, {0, 1, 0, 1},
                                   {0, -1, 0, 1}, {0, 0, -1, 0}, {0, 0, 1, 1}};
    std::vector<Vec4> left(polygon.begin(), polygon.end());
    for (const Vec4& plane : kPlanes) {
        std::vector<Vec4> inside;
        for (std::size_t i = 0; i < left.size(); ++i) {
            const Vec4 &a = left[i], &b = left[(i + 1) % left.size()];
            const double at_a = dot(plane, a), at_b = dot(plane, b);
            if (at_a >= 0) inside.push_back(a);
            if ((at_a < 0) != (at_b < 0)) inside.push_back(a + (at_a / (at_a - at_b)) * (b - a));
        }
        left = std::move(inside);
    }
    return left;
}

}  // namespace trilens
