// Sphere, paraboloid, cylinder, cone and plane: regular parametrisations with closed-form inverses.
#include "surfaces/primitive_shapes.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "surfaces/checked_cage.h"

namespace trilens {
namespace {

constexpr double kHalfTurn = 3.14159265358979323846;

/// Faces whose corners are numbered, so that equal corner pairs are one edge.
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

/// tan of -45 to 45 degrees with its derivatives, over a parameter 0 to 1: equal steps are nearly equal
/// angles.
struct Tangent {
    double value, first, second;
};
Tangent tangent(double u) {
    const double x = std::tan(kHalfTurn / 4 * (2 * u - 1));
    return {x, kHalfTurn / 2 * (1 + x * x), kHalfTurn * kHalfTurn / 2 * x * (1 + x * x)};
}
double inverse_tangent(double value) {
    return std::clamp(0.5 + 2 / kHalfTurn * std::atan(value), 0.0, 1.0);
}

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

/// A vector in the xy plane turned by whole quarter turns, exactly.
Vec2 quarter_turns(const Vec2& p, Id turns) {
    switch (turns % 4) {
        case 1:
            return {-p.y, p.x};
        case 2:
            return {-p.x, -p.y};
        case 3:
            return {p.y, -p.x};
        default:
            return p;
    }
}

/// The quarter turn about z in which a point lies, and which part of it, from 0 to 1, comes before it.
std::pair<Id, double> quarter_of(const Vec2& p) {
    const Id quarter = p.y >= 0 ? (p.x > 0 ? 0 : 1) : (p.x <= 0 ? 2 : 3);
    const Vec2 q = quarter_turns(p, 4 - quarter);
    return {quarter, std::clamp(std::atan2(q.y, q.x) / (kHalfTurn / 2), 0.0, 1.0)};
}

/// z = (x^2 + y^2) / (4 focal length) over a disk. The disk is a square of half the radius (face 4) and four
/// sides (faces 0 to 3, u outward, v around) that blend linearly from its edge to the rim along one angle.
class Paraboloid final : public PrimitiveShape {
  public:
    explicit Paraboloid(const ParaboloidPrimitive& paraboloid)
        : rim_(paraboloid.radius), inner_(paraboloid.radius / 2), four_f_(4 * paraboloid.focal_length) {}
    std::size_t face_count() const override { return 5; }
    FaceBorder border(Id face) const override { return borders_[face]; }

    SurfacePoint eval(Id face, const Vec2& uv) const override {
        const Flat flat = face == 4 ? square(uv) : side(face, uv);
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
        if (std::abs(p.x) <= inner_ && std::abs(p.y) <= inner_)
            return {4, {inverse_tangent(p.x / inner_), inverse_tangent(p.y / inner_)}};
        const Id face = std::abs(p.x) >= std::abs(p.y) ? (p.x > 0 ? 0 : 2) : (p.y > 0 ? 1 : 3);
        const Vec2 q = quarter_turns(p, 4 - face);
        const double outer = rim_ * q.x / length(q);
        return {face, {std::clamp((q.x - inner_) / (outer - inner_), 0.0, 1.0), inverse_tangent(q.y / q.x)}};
    }

  private:
    struct Flat {
        Vec2 p, u, v, uu, uv, vv;  // a point of the disk with its derivatives
    };
    Flat square(const Vec2& uv) const {
        const Tangent a = tangent(uv.x), b = tangent(uv.y);
        const Vec2 x(inner_, 0), y(0, inner_), none(0);
        return {a.value * x + b.value * y, a.first * x, b.first * y, a.second * x, none, b.second * y};
    }
    Flat side(Id face, const Vec2& uv) const {
        const Tangent b = tangent(uv.y);
        const double angle = kHalfTurn / 4 * (2 * uv.y - 1), speed = kHalfTurn / 2;
        const Vec2 in(inner_, inner_ * b.value), in_v(0, inner_ * b.first), in_vv(0, inner_ * b.second);
        const Vec2 out = rim_ * Vec2(std::cos(angle), std::sin(angle));
        const Vec2 out_v = speed * quarter_turns(out, 1), out_vv = -speed * speed * out;
        const auto blend = [&uv](const Vec2& a, const Vec2& c) { return (1 - uv.x) * a + uv.x * c; };
        Flat flat{blend(in, out), out - in, blend(in_v, out_v), Vec2(0), out_v - in_v, blend(in_vv, out_vv)};
        for (Vec2* part : {&flat.p, &flat.u, &flat.v, &flat.uv, &flat.vv}) *part = quarter_turns(*part, face);
        return flat;
    }

    double rim_, inner_, four_f_;
    // Corners of the square 0 to 3 from (-, -) counter-clockwise, those of the rim 4 to 7 outside of them.
    std::vector<FaceBorder> borders_ =
        borders_of({{1, 5, 6, 2}, {2, 6, 7, 3}, {3, 7, 4, 0}, {0, 4, 5, 1}, {0, 1, 2, 3}});
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

std::unique_ptr<PrimitiveShape> shape_of(const SpherePrimitive& sphere) {
    return std::make_unique<Sphere>(sphere);
}
std::unique_ptr<PrimitiveShape> shape_of(const ParaboloidPrimitive& paraboloid) {
    return std::make_unique<Paraboloid>(paraboloid);
}
std::unique_ptr<PrimitiveShape> shape_of(const CylinderPrimitive& cylinder) {
    return std::make_unique<Cylinder>(cylinder);
}
std::unique_ptr<PrimitiveShape> shape_of(const ConePrimitive& cone) {
    return std::make_unique<Cone>(cone);
}
std::unique_ptr<PrimitiveShape> shape_of(const PlanePrimitive& plane) {
    return std::make_unique<Plane>(plane);
}

}  // namespace

std::unique_ptr<PrimitiveShape> make_primitive_shape(const PrimitiveKind& kind) {
    return std::visit([](const auto& one) { return shape_of(one); }, kind);
}

}  // namespace trilens
