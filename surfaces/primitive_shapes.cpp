// Sphere, paraboloid, cylinder, cone and plane: regular parametrisations with closed-form inverses.
#include "surfaces/primitive_shapes.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "surfaces/checked_cage.h"
#include "surfaces/primitives/disk_map.h"

namespace trilens {
namespace {

/// A cube mapped onto the sphere; a face's parameters are angles seen from the centre.
class Sphere final : public PrimitiveShape {
  public:
    explicit Sphere(const SpherePrimitive& sphere) : radius_(sphere.radius) {}
    std::size_t face_count() const override { return 6; }
    FaceBorder border(Id face) const override { return borders_[face]; }

    SurfacePoint eval(Id face, const Vec2& uv) const override {
        // q runs over the cube's face, the point is q / |q|, and scale is 1 / |q|.
        const Axes& axes = kAxes[face];
        const Tangent a = tangent(uv.x), b = tangent(uv.y);
        const Vec3 q = axes.out + a.value * axes.u + b.value * axes.v;
        const Vec3 qu = a.first * axes.u, qv = b.first * axes.v;
        const double scale = 1 / length(q), cubed = scale * scale * scale, fifth = cubed * scale * scale;

        // Derivatives of scale, from |q|^2 = 1 + a^2 + b^2.
        const double half_u = a.value * a.first, half_v = b.value * b.first;
        const double su = -half_u * cubed, sv = -half_v * cubed;
        const double suu = 3 * half_u * half_u * fifth - (a.first * a.first + a.value * a.second) * cubed;
        const double svv = 3 * half_v * half_v * fifth - (b.first * b.first + b.value * b.second) * cubed;
        const double suv = 3 * half_u * half_v * fifth;

        SurfacePoint point;
        point.normal = scale * q;
        point.position = radius_ * point.normal;
        point.du = radius_ * (su * q + scale * qu);
        point.dv = radius_ * (sv * q + scale * qv);
        point.duu = radius_ * (suu * q + 2 * su * qu + scale * a.second * axes.u);
        point.dvv = radius_ * (svv * q + 2 * sv * qv + scale * b.second * axes.v);
        point.duv = radius_ * (suv * q + su * qv + sv * qu);
        return point;
    }

    std::array<double, 3> equation(const Ray& ray) const override {
        const double distance = length(ray.origin);
        return {(distance - radius_) * (distance + radius_), dot(ray.origin, ray.direction),
                dot(ray.direction, ray.direction)};
    }

    SurfaceParameter place(const Vec3& point) const override {
        Id face = 0;
        for (Id other = 1; other < 6; ++other)
            if (dot(point, kAxes[other].out) > dot(point, kAxes[face].out)) face = other;
        const Axes& axes = kAxes[face];
        const double out = dot(point, axes.out);
        return {face, {inverse_tangent(dot(point, axes.u) / out), inverse_tangent(dot(point, axes.v) / out)}};
    }
    bool has(const Vec3&) const override { return true; }

  private:
    struct Axes {
        Vec3 out, u, v;  // right-handed: u x v = out
    };
    static inline const std::array<Axes, 6> kAxes = {{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
                                                      {{-1, 0, 0}, {0, 0, 1}, {0, 1, 0}},
                                                      {{0, 1, 0}, {0, 0, 1}, {1, 0, 0}},
                                                      {{0, -1, 0}, {1, 0, 0}, {0, 0, 1}},
                                                      {{0, 0, 1}, {1, 0, 0}, {0, 1, 0}},
                                                      {{0, 0, -1}, {0, 1, 0}, {1, 0, 0}}}};

    static std::vector<std::array<Id, 4>> cube_corners() {
        std::vector<std::array<Id, 4>> faces;
        for (const Axes& axes : kAxes) {
            // A corner of the cube is numbered by the signs of its coordinates.
            const auto number = [&axes](double u, double v) {
                const Vec3 corner = axes.out + u * axes.u + v * axes.v;
                return static_cast<Id>((corner.x > 0) + 2 * (corner.y > 0) + 4 * (corner.z > 0));
            };
            faces.push_back({number(-1, -1), number(1, -1), number(1, 1), number(-1, 1)});
        }
        return faces;
    }

    double radius_;
    std::vector<FaceBorder> borders_ = borders_of(cube_corners());
};

/// z = (x^2 + y^2) / (4 focal length) over a disk.
class Paraboloid final : public PrimitiveShape {
  public:
    explicit Paraboloid(const ParaboloidPrimitive& paraboloid)
        : rim_(paraboloid.radius), four_f_(4 * paraboloid.focal_length), disk_(paraboloid.radius) {}
    std::size_t face_count() const override { return DiskMap::kFaces; }
    FaceBorder border(Id face) const override { return borders_[face]; }

    SurfacePoint eval(Id face, const Vec2& uv) const override {
        const DiskMap::Flat flat = disk_.at(face, uv);
        const auto lift = [this](const Vec2& a, double z) { return Vec3(a, z / four_f_); };
        SurfacePoint point;
        point.position = lift(flat.p, dot(flat.p, flat.p));
        point.du = lift(flat.u, 2 * dot(flat.p, flat.u));
        point.dv = lift(flat.v, 2 * dot(flat.p, flat.v));
        point.duu = lift(flat.uu, 2 * (dot(flat.u, flat.u) + dot(flat.p, flat.uu)));
        point.duv = lift(flat.uv, 2 * (dot(flat.u, flat.v) + dot(flat.p, flat.uv)));
        point.dvv = lift(flat.vv, 2 * (dot(flat.v, flat.v) + dot(flat.p, flat.vv)));
        point.normal = normalize(Vec3(-2.0 * flat.p, four_f_));
        return point;
    }

    std::array<double, 3> equation(const Ray& ray) const override {
        const Vec2 o(ray.origin), d(ray.direction);
        return {dot(o, o) - four_f_ * ray.origin.z, dot(o, d) - four_f_ / 2 * ray.direction.z, dot(d, d)};
    }

    SurfaceParameter place(const Vec3& point) const override {
        const Vec2 p(point);
        if (!(length(p) <= rim_)) return {};
        return disk_.place(p);
    }

  private:
    double rim_, four_f_;
    DiskMap disk_;
    std::vector<FaceBorder> borders_ = borders_of(DiskMap::corners());
};

/// Four quarters, u around and v along the axis.
class Cylinder final : public PrimitiveShape {
  public:
    explicit Cylinder(const CylinderPrimitive& cylinder)
        : radius_(cylinder.radius), height_(cylinder.height) {}
    std::size_t face_count() const override { return 4; }
    FaceBorder border(Id face) const override { return borders_[face]; }

    SurfacePoint eval(Id face, const Vec2& uv) const override {
        const double angle = kHalfTurn / 2 * uv.x, speed = kHalfTurn / 2;
        const Vec2 out = quarter_turns({std::cos(angle), std::sin(angle)}, face);
        SurfacePoint point;
        point.position = Vec3(radius_ * out, height_ * (uv.y - 0.5));
        point.du = Vec3(radius_ * speed * quarter_turns(out, 1), 0);
        point.dv = Vec3(0, 0, height_);
        point.duu = Vec3(-radius_ * speed * speed * out, 0);
        point.normal = Vec3(out, 0);
        return point;
    }

    std::array<double, 3> equation(const Ray& ray) const override {
        const Vec2 o(ray.origin), d(ray.direction);
        const double distance = length(o);
        return {(distance - radius_) * (distance + radius_), dot(o, d), dot(d, d)};
    }

    SurfaceParameter place(const Vec3& point) const override {
        const double v = point.z / height_ + 0.5;
        if (!(v >= 0 && v <= 1)) return {};
        const auto [face, u] = quarter_of(Vec2(point));
        return {face, {u, v}};
    }

  private:
    double radius_, height_;
    std::vector<FaceBorder> borders_ = borders_of({{0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}});
};

/// Four quarters, u around and v from the base to the apex, where each quarter's side v = 1 is a point.
class Cone final : public PrimitiveShape {
  public:
    explicit Cone(const ConePrimitive& cone)
        : radius_(cone.radius), height_(cone.height), slant_(std::hypot(cone.radius, cone.height)) {}
    std::size_t face_count() const override { return 4; }
    FaceBorder border(Id face) const override { return borders_[face]; }

    SurfacePoint eval(Id face, const Vec2& uv) const override {
        const double angle = kHalfTurn / 2 * uv.x, speed = kHalfTurn / 2, wide = radius_ * (1 - uv.y);
        const Vec2 out = quarter_turns({std::cos(angle), std::sin(angle)}, face);
        const Vec2 around = speed * quarter_turns(out, 1);
        SurfacePoint point;
        point.position = Vec3(wide * out, height_ * uv.y);
        point.du = Vec3(wide * around, 0);
        point.dv = Vec3(-radius_ * out, height_);
        point.duu = Vec3(-wide * speed * speed * out, 0);
        point.duv = Vec3(-radius_ * around, 0);
        point.normal = Vec3(height_ / slant_ * out, radius_ / slant_);
        return point;
    }

    Vec3 equation_center() const override { return {0, 0, height_}; }

    std::array<double, 3> equation(const Ray& ray) const override {
        const Vec2 o(ray.origin), d(ray.direction);
        const double slope = radius_ / height_, wide = slope * (height_ - ray.origin.z),
                     grows = -slope * ray.direction.z, distance = length(o);
        return {(distance - wide) * (distance + wide), dot(o, d) - wide * grows, dot(d, d) - grows * grows};
    }

    SurfaceParameter place(const Vec3& point) const override {
        const double v = point.z / height_;
        if (!(v >= 0 && v <= 1)) return {};
        const auto [face, u] = quarter_of(Vec2(point));
        return {face, {u, v}};
    }

  private:
    static std::vector<FaceBorder> quarters() {
        std::vector<FaceBorder> borders =
            borders_of({{0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}});
        for (FaceBorder& border : borders) border.corners[2] = border.corners[3] = kNone;
        return borders;
    }

    double radius_, height_, slant_;
    std::vector<FaceBorder> borders_ = quarters();
};

class Plane final : public PrimitiveShape {
  public:
    explicit Plane(const PlanePrimitive& plane) : size_(plane.size) {}
    std::size_t face_count() const override { return 1; }
    FaceBorder border(Id) const override { return {}; }

    SurfacePoint eval(Id, const Vec2& uv) const override {
        SurfacePoint point;
        point.position = Vec3(size_ * (uv - 0.5), 0);
        point.du = Vec3(size_.x, 0, 0);
        point.dv = Vec3(0, size_.y, 0);
        point.normal = Vec3(0, 0, 1);
        return point;
    }
    std::array<double, 3> equation(const Ray& ray) const override {
        return {ray.origin.z, ray.direction.z / 2, 0};
    }
    SurfaceParameter place(const Vec3& point) const override {
        const Vec2 uv = Vec2(point) / size_ + 0.5;
        if (!(uv.x >= 0 && uv.x <= 1 && uv.y >= 0 && uv.y <= 1)) return {};
        return {0, uv};
    }

  private:
    Vec2 size_;
};

}  // namespace

std::vector<FaceBorder> borders_of(const std::vector<std::array<Id, 4>>& face_corners) {
    EdgeNumbers edges;
    std::vector<FaceBorder> borders;
    for (const std::array<Id, 4>& corners : face_corners) {
        FaceBorder border;
        border.corners = corners;
        for (std::size_t k = 0; k < 4; ++k) border.sides[k] = edges.side(corners[k], corners[(k + 1) % 4]);
        borders.push_back(border);
    }
    return borders;
}

std::unique_ptr<PrimitiveShape> make_shape(const SpherePrimitive& sphere) {
    return std::make_unique<Sphere>(sphere);
}
std::unique_ptr<PrimitiveShape> make_shape(const ParaboloidPrimitive& paraboloid) {
    return std::make_unique<Paraboloid>(paraboloid);
}
std::unique_ptr<PrimitiveShape> make_shape(const CylinderPrimitive& cylinder) {
    return std::make_unique<Cylinder>(cylinder);
}
std::unique_ptr<PrimitiveShape> make_shape(const ConePrimitive& cone) {
    return std::make_unique<Cone>(cone);
}
std::unique_ptr<PrimitiveShape> make_shape(const PlanePrimitive& plane) {
    return std::make_unique<Plane>(plane);
}

}  // namespace trilens
