// Surfaces with known answers, given to the limit tracer as if they had none.
#pragma once

#include <array>
#include <cmath>
#include <vector>

#include "base/raymesh/surface.h"

namespace trilens_test {

using trilens::FaceDomain;
using trilens::Id;
using trilens::SurfaceGrid;
using trilens::SurfacePoint;
using trilens::Vec2;
using trilens::Vec3;

inline void set_normal(SurfacePoint& p) {
    p.normal = trilens::normalize_or_zero(cross(p.du, p.dv));
}

inline Vec2 clamped(FaceDomain domain, Vec2 uv) {
    uv = glm::clamp(uv, 0.0, 1.0);
    const double over = uv.x + uv.y - 1;
    if (domain == FaceDomain::kTriangle && over > 0) uv = glm::clamp(uv - 0.5 * over, 0.0, 1.0);
    return uv;
}

/// centre + radius * q / |q| with q linear in (u, v): a sphere from the 6 faces of a cube or the 8 of an
/// octahedron.
class ProjectedSphere : public trilens::Surface {
  public:
    ProjectedSphere(FaceDomain domain, const Vec3& centre, double radius)
        : domain_(domain), centre_(centre), radius_(radius) {
        for (int axis = 0; axis < 3; ++axis) {
            for (const double sign : {1.0, -1.0}) {
                Vec3 n(0), a(0), b(0);
                n[axis] = sign, a[(axis + 1) % 3] = sign, b[(axis + 2) % 3] = 1;
                if (domain == FaceDomain::kSquare) faces_.push_back({n - a - b, 2.0 * a, 2.0 * b});
            }
        }
        for (int i = 0; domain == FaceDomain::kTriangle && i < 8; ++i) {
            const Vec3 x(i & 1 ? -1 : 1, 0, 0), y(0, i & 2 ? -1 : 1, 0), z(0, 0, i & 4 ? -1 : 1);
            const bool turned = ((i & 1) + (i >> 1 & 1) + (i >> 2 & 1)) % 2 != 0;
            faces_.push_back({x, (turned ? z : y) - x, (turned ? y : z) - x});
        }
    }
    std::size_t face_count() const override { return faces_.size(); }
    FaceDomain domain(Id) const override { return domain_; }
    SurfacePoint eval(Id face, const Vec2& at) const override {
        const auto& [origin, qu, qv] = faces_[face];
        const Vec2 uv = clamped(domain_, at);
        const Vec3 q = origin + uv.x * qu + uv.y * qv;
        const double size = length(q), s3 = 1 / (size * size * size), s5 = s3 / (size * size);
        const double u = dot(q, qu), v = dot(q, qv);
        SurfacePoint p;
        p.position = centre_ + radius_ * q / size;
        p.du = radius_ * (qu / size - q * u * s3);
        p.dv = radius_ * (qv / size - q * v * s3);
        p.duu = radius_ * (-s3 * (2.0 * u * qu + dot(qu, qu) * q) + 3 * s5 * u * u * q);
        p.duv = radius_ * (-s3 * (v * qu + u * qv + dot(qu, qv) * q) + 3 * s5 * u * v * q);
        p.dvv = radius_ * (-s3 * (2.0 * v * qv + dot(qv, qv) * q) + 3 * s5 * v * v * q);
        set_normal(p);
        return p;
    }

  private:
    FaceDomain domain_;
    Vec3 centre_;
    double radius_;
    std::vector<std::array<Vec3, 3>> faces_;
};

/// A torus about the y axis in 4 x 4 faces.
class Torus : public trilens::Surface {
  public:
    Torus(double major, double minor) : major_(major), minor_(minor) {}
    std::size_t face_count() const override { return 16; }
    FaceDomain domain(Id) const override { return FaceDomain::kSquare; }
    SurfacePoint eval(Id face, const Vec2& at) const override {
        const Vec2 uv = clamped(FaceDomain::kSquare, at);
        const double w = M_PI / 2, a = w * (face % 4 + uv.x), b = w * (face / 4 + uv.y);
        const double ca = std::cos(a), sa = std::sin(a), cb = std::cos(b), sb = std::sin(b);
        const double ring = major_ + minor_ * cb;
        SurfacePoint p;
        p.position = {ring * ca, minor_ * sb, -ring * sa};
        p.du = w * ring * Vec3(-sa, 0, -ca);
        p.dv = w * minor_ * Vec3(-sb * ca, cb, sb * sa);
        p.duu = w * w * ring * Vec3(-ca, 0, sa);
        p.duv = w * w * minor_ * sb * Vec3(sa, 0, ca);
        p.dvv = w * w * minor_ * Vec3(-cb * ca, -sb, cb * sa);
        set_normal(p);
        return p;
    }
    /// Signed distance of a point, negative inside; exact.
    long double distance(const std::array<long double, 3>& x) const {
        return std::hypot(std::hypot(x[0], x[2]) - major_, x[1]) - minor_;
    }

  private:
    double major_, minor_;
};

/// The height field y = amplitude sin(frequency x) cos(frequency z) over |x|, |z| <= 1, in 3 x 3 faces.
class Waves : public trilens::Surface {
  public:
    Waves(double amplitude, double frequency) : a_(amplitude), k_(frequency) {}
    std::size_t face_count() const override { return 9; }
    FaceDomain domain(Id) const override { return FaceDomain::kSquare; }
    SurfacePoint eval(Id face, const Vec2& at) const override {
        const Vec2 uv = clamped(FaceDomain::kSquare, at);
        // v runs along x and u along z, so that du x dv points up.
        const double w = 2.0 / 3, x = w * (face % 3 + uv.y) - 1, z = w * (face / 3 + uv.x) - 1;
        const double sx = std::sin(k_ * x), cx = std::cos(k_ * x), sz = std::sin(k_ * z),
                     cz = std::cos(k_ * z);
        SurfacePoint p;
        p.position = {x, a_ * sx * cz, z};
        p.du = w * Vec3(0, -a_ * k_ * sx * sz, 1);
        p.dv = w * Vec3(1, a_ * k_ * cx * cz, 0);
        p.duu = w * w * Vec3(0, -a_ * k_ * k_ * sx * cz, 0);
        p.duv = w * w * Vec3(0, -a_ * k_ * k_ * cx * sz, 0);
        p.dvv = p.duu;
        set_normal(p);
        return p;
    }
    /// The vertical distance over the surface, divided by the steepest slope: no nearer than the surface.
    long double distance(const std::array<long double, 3>& x) const {
        return (x[1] - a_ * std::sin(k_ * x[0]) * std::cos(k_ * x[2])) / std::hypot(1.0L, 1.0L * a_ * k_);
    }

  private:
    double a_, k_;
};

/// The paraboloid y = -(x^2 + z^2) / 2 with (x, z) = (u, v) |(u, v)|^(power - 1) in four quarters: at the
/// middle the derivatives vanish (power > 1) or grow without bound (power < 1), as at extraordinary vertices
/// of subdivision surfaces.
class PinchedParaboloid : public trilens::Surface {
  public:
    explicit PinchedParaboloid(double power) : power_(power) {}
    std::size_t face_count() const override { return 4; }
    FaceDomain domain(Id) const override { return FaceDomain::kSquare; }
    SurfacePoint eval(Id face, const Vec2& at) const override {
        const Vec2 uv = clamped(FaceDomain::kSquare, at);
        const double c[4] = {1, 0, -1, 0}, s[4] = {0, 1, 0, -1};
        const Vec3 x_axis(c[face], 0, -s[face]), z_axis(-s[face], 0, -c[face]);
        const double r2 = dot(uv, uv), g = r2 > 0 ? std::pow(r2, 0.5 * (power_ - 1)) : 0;
        SurfacePoint p;
        if (g == 0) return p;
        // f = g(u, v) times u or v; derivatives of g by the chain rule.
        const double m = power_ - 1, gu = m * g * uv.x / r2, gv = m * g * uv.y / r2;
        const double guu = m * g / r2 + (m - 2) * gu * uv.x / r2, gvv = m * g / r2 + (m - 2) * gv * uv.y / r2;
        const double guv = (m - 2) * gu * uv.y / r2;
        const Vec2 f = g * uv, fu(g + gu * uv.x, gu * uv.y), fv(gv * uv.x, g + gv * uv.y);
        const Vec2 fuu(2 * gu + guu * uv.x, guu * uv.y), fvv(gvv * uv.x, 2 * gv + gvv * uv.y);
        const Vec2 fuv(gv + guv * uv.x, gu + guv * uv.y);
        const auto lift = [&](const Vec2& a, double y) {
            return a.x * x_axis + a.y * z_axis + Vec3(0, y, 0);
        };
        p.position = lift(f, -0.5 * dot(f, f));
        p.du = lift(fu, -dot(f, fu)), p.dv = lift(fv, -dot(f, fv));
        p.duu = lift(fuu, -dot(f, fuu) - dot(fu, fu)), p.dvv = lift(fvv, -dot(f, fvv) - dot(fv, fv));
        p.duv = lift(fuv, -dot(f, fuv) - dot(fu, fv));
        set_normal(p);
        return p;
    }

  private:
    double power_;
};

/// An n x n grid per face, points not shared.
inline SurfaceGrid grid_of(const trilens::Surface& surface, int n) {
    SurfaceGrid grid;
    const auto add = [&](Id face, const Vec2& a, const Vec2& b, const Vec2& c) {
        const Id first = static_cast<Id>(grid.points.size());
        for (const Vec2& uv : {a, b, c}) {
            const SurfacePoint p = surface.eval(face, uv);
            grid.corner_point.push_back(static_cast<Id>(grid.points.size()));
            grid.points.push_back(p.position);
            grid.corner_normal.push_back(p.normal);
        }
        grid.facets.push_back({first, first + 1, first + 2});
        grid.facet_face.push_back(face);
        grid.facet_uv.push_back({a, b, c});
    };
    for (Id face = 0; face < surface.face_count(); ++face) {
        const bool square = surface.domain(face) == FaceDomain::kSquare;
        for (int i = 0; i < n; ++i) {
            for (int j = 0; j < (square ? n : n - i); ++j) {
                const double h = 1.0 / n, u = i * h, v = j * h;
                add(face, {u, v}, {u + h, v}, {u, v + h});
                if (square || i + j + 1 < n) add(face, {u + h, v}, {u + h, v + h}, {u, v + h});
            }
        }
    }
    return grid;
}

}  // namespace trilens_test
