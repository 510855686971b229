// Closed bodies of glass whose rays are known in closed form: flat-sided ones, and lenses.
#pragma once

#include <array>
#include <cmath>
#include <vector>

#include "intersect/test_surfaces.h"

namespace trilens_test {

/// A body with flat sides: quads (4 corners) and triangles (the last two corners equal), counter-clockwise
/// from outside.
class FlatBody : public trilens::Surface {
  public:
    explicit FlatBody(std::vector<std::array<Vec3, 4>> sides) : sides_(std::move(sides)) {}
    std::size_t face_count() const override { return sides_.size(); }
    FaceDomain domain(Id face) const override {
        return sides_[face][2] == sides_[face][3] ? FaceDomain::kTriangle : FaceDomain::kSquare;
    }
    SurfacePoint eval(Id face, const Vec2& at) const override {
        const auto& [a, b, c, d] = sides_[face];
        const bool triangle = domain(face) == FaceDomain::kTriangle;
        const Vec2 uv = clamped(domain(face), at);
        const Vec3 twist = triangle ? Vec3(0) : a - b + c - d;
        SurfacePoint p;
        p.du = b - a + uv.y * twist;
        p.dv = d - a + uv.x * twist;
        p.duv = twist;
        p.position = a + uv.x * (b - a) + uv.y * (d - a) + uv.x * uv.y * twist;
        set_normal(p);
        return p;
    }

  private:
    std::vector<std::array<Vec3, 4>> sides_;
};

inline FlatBody make_box(const Vec3& low, const Vec3& high) {
    const auto at = [&](int x, int y, int z) {
        return Vec3(x ? high.x : low.x, y ? high.y : low.y, z ? high.z : low.z);
    };
    return FlatBody({{at(0, 0, 1), at(1, 0, 1), at(1, 1, 1), at(0, 1, 1)},
                     {at(1, 0, 0), at(0, 0, 0), at(0, 1, 0), at(1, 1, 0)},
                     {at(1, 0, 1), at(1, 0, 0), at(1, 1, 0), at(1, 1, 1)},
                     {at(0, 0, 0), at(0, 0, 1), at(0, 1, 1), at(0, 1, 0)},
                     {at(0, 1, 1), at(1, 1, 1), at(1, 1, 0), at(0, 1, 0)},
                     {at(0, 0, 0), at(1, 0, 0), at(1, 0, 1), at(0, 0, 1)}});
}

/// A prism along z, |z| <= depth, over a triangle in the x-y plane that runs counter-clockwise.
inline FlatBody make_prism(const std::array<Vec2, 3>& corner, double depth) {
    std::array<Vec3, 3> near, far;
    for (std::size_t k = 0; k < 3; ++k) {
        near[k] = {corner[k].x, corner[k].y, depth};
        far[k] = {corner[k].x, corner[k].y, -depth};
    }
    std::vector<std::array<Vec3, 4>> sides{{near[0], near[1], near[2], near[2]},
                                           {far[0], far[2], far[1], far[1]}};
    for (std::size_t k = 0; k < 3; ++k) {
        const std::size_t next = (k + 1) % 3;
        sides.push_back({near[k], far[k], far[next], near[next]});
    }
    return FlatBody(std::move(sides));
}

/// One side of a lens about the z axis: through (0, 0, vertex), its centre at vertex - 1 / curvature.
struct CapSide {
    double vertex = 0, curvature = 0;
};

/// A lens of square outline |x|, |y| <= half: `front` above in z, `back` below, four walls between.
class Lens : public trilens::Surface {
  public:
    Lens(const CapSide& front, const CapSide& back, double half)
        : front_(front), back_(back), half_(half) {}
    std::size_t face_count() const override { return 6; }
    FaceDomain domain(Id) const override { return FaceDomain::kSquare; }
    SurfacePoint eval(Id face, const Vec2& at) const override {
        const Vec2 uv = clamped(FaceDomain::kSquare, at);
        SurfacePoint p;
        if (face < 2) {
            // The back's parameters change places, so that du x dv points down.
            const Vec2 xy = half_ * (2.0 * (face == 0 ? uv : Vec2(uv.y, uv.x)) - Vec2(1));
            const Height h = height(face == 0 ? front_ : back_, xy);
            const double w = 2 * half_;
            p.position = {xy.x, xy.y, h.z};
            p.du = w * Vec3(1, 0, h.zx), p.dv = w * Vec3(0, 1, h.zy);
            p.duu = {0, 0, w * w * h.zxx}, p.duv = {0, 0, w * w * h.zxy}, p.dvv = {0, 0, w * w * h.zyy};
            if (face == 1) std::swap(p.du, p.dv), std::swap(p.duu, p.dvv);
        } else {
            static const std::array<Vec2, 5> corner{Vec2(1, -1), Vec2(1, 1), Vec2(-1, 1), Vec2(-1, -1),
                                                    Vec2(1, -1)};
            const Vec2 from = half_ * corner[face - 2], along = half_ * corner[face - 1] - from;
            const Vec2 xy = from + uv.x * along;
            const Height top = height(front_, xy), bottom = height(back_, xy);
            const auto slope = [&](const Height& h) { return h.zx * along.x + h.zy * along.y; };
            const auto bend = [&](const Height& h) {
                return h.zxx * along.x * along.x + 2 * h.zxy * along.x * along.y + h.zyy * along.y * along.y;
            };
            p.position = {xy.x, xy.y, bottom.z + uv.y * (top.z - bottom.z)};
            p.du = {along.x, along.y, slope(bottom) + uv.y * (slope(top) - slope(bottom))};
            p.dv = {0, 0, top.z - bottom.z};
            p.duu = {0, 0, bend(bottom) + uv.y * (bend(top) - bend(bottom))};
            p.duv = {0, 0, slope(top) - slope(bottom)};
        }
        set_normal(p);
        return p;
    }

  private:
    struct Height {
        double z, zx, zy, zxx, zxy, zyy;
    };
    static Height height(const CapSide& side, const Vec2& at) {
        const double c = side.curvature, r2 = dot(at, at), root = std::sqrt(1 - c * c * r2);
        const double c3 = c * c * c / (root * root * root);
        return {side.vertex - c * r2 / (1 + root), -c * at.x / root,  -c * at.y / root,
                -c / root - c3 * at.x * at.x,      -c3 * at.x * at.y, -c / root - c3 * at.y * at.y};
    }

    CapSide front_, back_;
    double half_;
};

}  // namespace trilens_test
