// Surfaces whose every derivative is plain in a few lines, so that tests need no other room.
#pragma once

#include <array>
#include <cmath>
#include <memory>
#include <utility>

#include "base/raymesh/surface.h"

namespace trilens_test {

using namespace trilens;

/// The point's normal from its derivatives, turned to the side of `front`.
inline void set_normal(SurfacePoint& point, const Vec3& front) {
    const Vec3 normal = normalize_or_zero(cross(point.du, point.dv));
    point.normal = dot(normal, front) < 0 ? -normal : normal;
}

/// Bounds by the largest lengths of the first, second and third derivatives over a whole face.
struct SlopeBounder : SurfaceBounder {
    const Surface& surface;
    std::array<double, 3> slope;
    double normal_slope;

    SlopeBounder(const Surface& s, const std::array<double, 3>& slopes, double normal)
        : surface(s), slope(slopes), normal_slope(normal) {}
    SurfaceBounds bounds(Id face, const Vec2& low, const Vec2& high) const override {
        const double way = 0.5 * (high.x - low.x + high.y - low.y);
        const double rounding = 1e-13 * slope[0];
        SurfaceBounds bounds;
        bounds.middle = surface.eval(face, 0.5 * (low + high));
        bounds.position_radius = slope[0] * way + rounding;
        bounds.du_radius = bounds.dv_radius = slope[1] * way + rounding;
        bounds.duu_radius = bounds.duv_radius = bounds.dvv_radius = slope[2] * way + rounding;
        bounds.normal_radius = normal_slope * way + 1e-14;
        return bounds;
    }
};

/// A sphere from a cube: face f is (u, v) in [-1, 1]^2 on one side of the cube, pushed out to the sphere.
struct CubeSphere : Surface {
    Vec3 center{0};
    double radius = 1;

    CubeSphere(const Vec3& c, double r) : center(c), radius(r) {}
    std::size_t face_count() const override { return 6; }
    FaceDomain domain(Id) const override { return FaceDomain::kSquare; }
    SurfacePoint eval(Id face, const Vec2& given) const override {
        const Vec2 uv = glm::clamp(given, Vec2(0), Vec2(1));
        const int axis = static_cast<int>(face / 2);
        Vec3 w(0), wu(0), wv(0);
        w[axis] = face % 2 ? -1 : 1;
        w[(axis + 1) % 3] = 2 * uv.x - 1;
        w[(axis + 2) % 3] = 2 * uv.y - 1;
        wu[(axis + 1) % 3] = wv[(axis + 2) % 3] = 2;

        // Derivatives of n = w / |w|, w linear in (u, v).
        const double size = length(w);
        const Vec3 n = w / size;
        auto first = [&](const Vec3& step) { return (step - n * dot(n, step)) / size; };
        auto second = [&](const Vec3& a, const Vec3& b) {
            const Vec3 na = first(a), nb = first(b);
            return -(nb * dot(n, a) + n * dot(nb, a) + na * dot(n, b)) / size;
        };
        SurfacePoint point;
        point.position = center + radius * n;
        point.du = radius * first(wu);
        point.dv = radius * first(wv);
        point.duu = radius * second(wu, wu);
        point.duv = radius * second(wu, wv);
        point.dvv = radius * second(wv, wv);
        set_normal(point, n);
        return point;
    }
    /// The largest derivatives lie at the middle of the face, where a great circle is arctan: 2, 4 and 24.
    std::unique_ptr<const SurfaceBounder> make_bounder() const override {
        return std::make_unique<SlopeBounder>(*this, std::array{2 * radius, 4 * radius, 24 * radius}, 2);
    }
    double sphere_curvature() const override { return 1 / radius; }
    SurfaceParameter sphere_place(const Vec3& normal) const override {
        int axis = 0;
        for (const int other : {1, 2})
            if (std::fabs(normal[other]) > std::fabs(normal[axis])) axis = other;
        const double out = std::fabs(normal[axis]);
        const Vec2 across(normal[(axis + 1) % 3], normal[(axis + 2) % 3]);
        return {static_cast<Id>(2 * axis + (normal[axis] < 0)), 0.5 * (across / out + 1.0)};
    }
};

/// One face z = bend (x^2 + y^2) over a square of the plane z = 0 around `center`: a plane, or a paraboloid
/// with focus at height 1 / (4 bend).
struct Patch : Surface {
    Vec3 center{0};
    double half_side = 1, bend = 0;

    Patch(const Vec3& c, double half, double curvature) : center(c), half_side(half), bend(curvature) {}
    std::size_t face_count() const override { return 1; }
    FaceDomain domain(Id) const override { return FaceDomain::kSquare; }
    SurfacePoint eval(Id, const Vec2& given) const override {
        const Vec2 uv = glm::clamp(given, Vec2(0), Vec2(1));
        const double x = half_side * (2 * uv.x - 1), y = half_side * (2 * uv.y - 1), scale = 2 * half_side;
        SurfacePoint point;
        point.position = center + Vec3(x, y, bend * (x * x + y * y));
        point.du = scale * Vec3(1, 0, 2 * bend * x);
        point.dv = scale * Vec3(0, 1, 2 * bend * y);
        point.duu = point.dvv = Vec3(0, 0, 2 * bend * scale * scale);
        set_normal(point, Vec3(0, 0, 1));
        return point;
    }
    /// Along (-2 bend x, -2 bend y, 1), which is never shorter than 1, the normal turns by 2 bend per length.
    std::unique_ptr<const SurfaceBounder> make_bounder() const override {
        const double scale = 2 * half_side, steep = std::hypot(1, scale * bend);
        return std::make_unique<SlopeBounder>(
            *this, std::array{scale * steep, 2 * std::fabs(bend) * scale * scale, 0.0},
            2 * std::fabs(bend) * scale);
    }
};

/// n x n squares of two facets on every face, corners shared inside a face.
inline SurfaceGrid regular_grid(const Surface& surface, int n) {
    SurfaceGrid grid;
    for (Id face = 0; face < surface.face_count(); ++face) {
        const Id base = static_cast<Id>(grid.points.size());
        auto uv_of = [&](int i, int j) { return Vec2(i, j) / static_cast<double>(n); };
        auto corner_of = [&](int i, int j) { return base + static_cast<Id>(j * (n + 1) + i); };
        for (int j = 0; j <= n; ++j) {
            for (int i = 0; i <= n; ++i) {
                const SurfacePoint point = surface.eval(face, uv_of(i, j));
                grid.corner_point.push_back(static_cast<Id>(grid.points.size()));
                grid.points.push_back(point.position);
                grid.corner_normal.push_back(point.normal);
            }
        }
        for (int j = 0; j < n; ++j) {
            for (int i = 0; i < n; ++i) {
                const bool flipped = [&] {
                    const SurfacePoint p = surface.eval(face, uv_of(i, j));
                    return dot(cross(p.du, p.dv), p.normal) < 0;
                }();
                auto add = [&](std::array<std::array<int, 2>, 3> at) {
                    if (flipped) std::swap(at[1], at[2]);
                    IdTriple facet{};
                    std::array<Vec2, 3> uv{};
                    for (std::size_t k = 0; k < 3; ++k) {
                        facet[k] = corner_of(at[k][0], at[k][1]);
                        uv[k] = uv_of(at[k][0], at[k][1]);
                    }
                    grid.facets.push_back(facet);
                    grid.facet_face.push_back(face);
                    grid.facet_uv.push_back(uv);
                };
                add({{{i, j}, {i + 1, j}, {i + 1, j + 1}}});
                add({{{i, j}, {i + 1, j + 1}, {i, j + 1}}});
            }
        }
    }
    return grid;
}

}  // namespace trilens_test
