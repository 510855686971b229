#include "support/canonical_volume.h"

namespace trilens_test {
namespace {

using namespace trilens;

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

}  // namespace

Mat4 npar(const ViewVolume& volume) {
    const auto& [umin, umax, vmin, vmax] = volume.window;
    const Mat4 t = translation({-0.5 * (umax + umin), -0.5 * (vmax + vmin), -volume.front});
    const Mat4 s = scaling({2 / (umax - umin), 2 / (vmax - vmin), 1 / (volume.front - volume.back)});
    return s * t * shear(volume) * viewing_from_world(volume);
}

Mat4 nper(const ViewVolume& volume) {
    const auto& [umin, umax, vmin, vmax] = volume.window;
    const double vrp_z = -volume.prp.z;  // of the vrp, after the prp has moved to the origin
    const Mat4 s = scaling({2 * vrp_z / ((umax - umin) * (vrp_z + volume.back)),
                            2 * vrp_z / ((vmax - vmin) * (vrp_z + volume.back)), -1 / (vrp_z + volume.back)});
    return s * shear(volume) * translation(-volume.prp) * viewing_from_world(volume);
}

double nper_front(const ViewVolume& volume) {
    return -(volume.front - volume.prp.z) / (volume.back - volume.prp.z);
}

Mat4 parallel_from_perspective(double z_min) {
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

}  // namespace trilens_test
