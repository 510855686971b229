// Chains over cubic surfaces, whose derivatives and bounds are known in closed form.
#pragma once

#include <cmath>
#include <random>
#include <vector>

#include "specular/chain/path_chain.h"

namespace trilens_test {

/// z = a x^2 + b x y + c y^2 + d x^3 over the unit square of (u, v) = (x, y) + 1/2, placed in the world.
class Cubic final : public trilens::Surface {
  public:
    Cubic(const trilens::Vec3& middle, const trilens::Mat3& frame, const trilens::Vec4& bend)
        : middle_(middle), frame_(frame), bend_(bend) {}
    std::size_t face_count() const override { return 1; }
    trilens::FaceDomain domain(trilens::Id) const override { return trilens::FaceDomain::kSquare; }
    trilens::SurfacePoint eval(trilens::Id, const trilens::Vec2& uv) const override {
        const double x = uv.x - 0.5, y = uv.y - 0.5;
        trilens::SurfacePoint p;
        p.position = middle_ + frame_ * trilens::Vec3(x, y,
                                                      bend_.x * x * x + bend_.y * x * y + bend_.z * y * y +
                                                          bend_.w * x * x * x);
        p.du = frame_ * trilens::Vec3(1, 0, 2 * bend_.x * x + bend_.y * y + 3 * bend_.w * x * x);
        p.dv = frame_ * trilens::Vec3(0, 1, bend_.y * x + 2 * bend_.z * y);
        p.duu = frame_ * trilens::Vec3(0, 0, 2 * bend_.x + 6 * bend_.w * x);
        p.duv = frame_ * trilens::Vec3(0, 0, bend_.y);
        p.dvv = frame_ * trilens::Vec3(0, 0, 2 * bend_.z);
        p.normal = normalize(cross(p.du, p.dv));
        return p;
    }

    void move(const trilens::Vec3& by, const trilens::Vec4& bend) {
        middle_ += by;
        bend_ += bend;
    }

    /// Over the box around `uv`, by the largest of each derivative.
    trilens::SurfaceBounds bounds(const trilens::Vec2& uv, const trilens::Vec2& half) const {
        const trilens::Vec2 most = glm::abs(uv - 0.5) + half;
        const trilens::Vec4 b = glm::abs(bend_);
        trilens::SurfaceBounds bounds;
        bounds.middle = eval(0, uv);
        bounds.duu_radius = 6 * b.w * half.x;
        bounds.duv_radius = bounds.dvv_radius = 0;
        bounds.du_radius = (2 * b.x + 6 * b.w * most.x) * half.x + b.y * half.y;
        bounds.dv_radius = b.y * half.x + 2 * b.z * half.y;
        // (-z_x, -z_y, 1) is at least 1 long: made unit, two of them differ by no more.
        bounds.normal_radius = std::hypot(bounds.du_radius, bounds.dv_radius);
        bounds.position_radius = (length(bounds.middle.du) + bounds.du_radius) * half.x +
                                 (length(bounds.middle.dv) + bounds.dv_radius) * half.y;
        return bounds;
    }

  private:
    trilens::Vec3 middle_;
    trilens::Mat3 frame_;
    trilens::Vec4 bend_;
};

inline trilens::Mat3 frame_towards(const trilens::Vec3& z) {
    const trilens::Vec3 n = normalize(z), side = normalize(cross(trilens::Vec3(0.3, 0.9, 0.2), n));
    return trilens::Mat3(side, cross(n, side), n);
}

struct ChainExample {
    std::vector<Cubic> surfaces;
    trilens::PathChain chain;
    std::vector<trilens::SurfaceParameter> start;
};

/// `count` surfaces in a row along z; `mirrors`: they reflect to and fro instead.
inline ChainExample example_of(std::size_t count, bool mirrors, unsigned seed) {
    std::mt19937 random(seed);
    // To and fro between mirrors tilts add up.
    const double reach = mirrors ? 0.01 : 0.1;
    std::uniform_real_distribution<double> draw(-reach, reach);
    ChainExample example;
    double index = 1;
    for (std::size_t i = 0; i < count; ++i) {
        const double z = mirrors ? (i % 2 == 0 ? 2 : -2) : static_cast<double>(i) + 1;
        const trilens::Vec3 out(draw(random), draw(random), mirrors && i % 2 == 0 ? -1 : 1);
        example.surfaces.emplace_back(trilens::Vec3(draw(random), draw(random), z), frame_towards(out),
                                      trilens::Vec4(draw(random), draw(random), draw(random), draw(random)));
    }
    for (std::size_t i = 0; i < count; ++i) {
        const double next = mirrors ? index : (i % 2 == 0 ? 1.5 : 1.1);
        example.chain.events.push_back({&example.surfaces[i], index, next, mirrors});
        index = next;
        example.start.push_back({0, trilens::Vec2(0.5)});
    }
    example.chain.eye.place = {draw(random), draw(random), mirrors ? 0.0 : -1.5};
    example.chain.point.place = {draw(random), draw(random), mirrors ? 0.4 : static_cast<double>(count) + 2};
    return example;
}

}  // namespace trilens_test
