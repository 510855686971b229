// Laws of primitives: their points satisfy their equations, their hits are the first, and both agree.
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <random>
#include <vector>

#include "base/util/error.h"
#include "support/test.h"
#include "surfaces/surfaces.h"

using namespace trilens;

namespace {

const PrimitiveKind kSphere = SpherePrimitive(), kParaboloid = ParaboloidPrimitive(),
                    kCylinder = CylinderPrimitive(), kCone = ConePrimitive(), kPlane = PlanePrimitive(),
                    kPlate = LensPrimitive();
const PrimitiveKind kKinds[] = {kSphere, kParaboloid, kCylinder, kCone, kPlane};
// Rims of closed ones have two normals: lens_surface_test.cpp has the rest of their laws.
const PrimitiveKind kWithRims[] = {kSphere, kParaboloid, kCylinder, kCone, kPlane, kPlate};

/// A primitive somewhere in space, of a size around `scale`.
Primitive random_primitive(const PrimitiveKind& kind, double scale, std::mt19937& random) {
    std::normal_distribution<double> normal;
    std::uniform_real_distribution<double> size(0.5, 2);
    const auto direction = [&] { return normalize(Vec3(normal(random), normal(random), normal(random))); };
    Primitive primitive{.kind = kind};
    primitive.center = scale * 3.0 * direction();
    primitive.axis = direction();
    primitive.tangent = normalize(cross(primitive.axis, direction()));
    const auto choose = [&](double& length, const char*) { length = scale * size(random); };
    std::visit([&](auto& one) { for_each_length(one, choose); }, primitive.kind);
    return primitive;
}

// What each shape's formula says of a point in its own frame: how far it is from satisfying the equation,
// about in units of length; whether it lies inside the bounds; the unit normal on the side that is the front;
// and the whole area.

double residual(const SpherePrimitive& p, const Vec3& q) {
    return std::sqrt(q.x * q.x + q.y * q.y + q.z * q.z) - p.radius;
}
double residual(const ParaboloidPrimitive& p, const Vec3& q) {
    return (q.x * q.x + q.y * q.y) / (4 * p.focal_length) - q.z;
}
double residual(const CylinderPrimitive& p, const Vec3& q) {
    return std::hypot(q.x, q.y) - p.radius;
}
double residual(const ConePrimitive& p, const Vec3& q) {
    return (std::hypot(q.x, q.y) - std::abs(p.radius * (1 - q.z / p.height))) * p.height /
           std::hypot(p.radius, p.height);
}
double residual(const PlanePrimitive&, const Vec3& q) {
    return q.z;
}

/// Of a plate between rims of two sizes, a solid: the farthest outside of its three parts.
double residual(const LensPrimitive& p, const Vec3& q) {
    const double wider = p.back.aperture - p.front.aperture;
    const double edge = std::hypot(q.x, q.y) - p.front.aperture - wider * q.z / p.thickness;
    return std::max({-q.z, q.z - p.thickness, edge * p.thickness / std::hypot(wider, p.thickness)});
}

bool is_inside(const SpherePrimitive&, const Vec3&, double) {
    return true;
}
bool is_inside(const ParaboloidPrimitive& p, const Vec3& q, double slack) {
    return std::hypot(q.x, q.y) <= p.radius + slack;
}
bool is_inside(const CylinderPrimitive& p, const Vec3& q, double slack) {
    return std::abs(q.z) <= p.height / 2 + slack;
}
bool is_inside(const ConePrimitive& p, const Vec3& q, double slack) {
    return q.z >= -slack && q.z <= p.height + slack;
}
bool is_inside(const PlanePrimitive& p, const Vec3& q, double slack) {
    return std::abs(q.x) <= p.size.x / 2 + slack && std::abs(q.y) <= p.size.y / 2 + slack;
}

bool is_inside(const LensPrimitive&, const Vec3&, double) {
    return true;
}

Vec3 front(const SpherePrimitive&, const Vec3& q) {
    return normalize(q);
}
Vec3 front(const ParaboloidPrimitive& p, const Vec3& q) {
    return normalize(Vec3(-q.x, -q.y, 2 * p.focal_length));
}
Vec3 front(const CylinderPrimitive&, const Vec3& q) {
    return normalize(Vec3(q.x, q.y, 0));
}
Vec3 front(const ConePrimitive& p, const Vec3& q) {
    return normalize(Vec3(p.height * normalize(Vec2(q)), p.radius));
}
Vec3 front(const PlanePrimitive&, const Vec3&) {
    return {0, 0, 1};
}
/// Beside its rims.
Vec3 front(const LensPrimitive& p, const Vec3& q) {
    if (std::abs(q.z) < 1e-12 * p.thickness) return {0, 0, -1};
    if (std::abs(q.z - p.thickness) < 1e-12 * p.thickness) return {0, 0, 1};
    return normalize(Vec3(p.thickness * normalize(Vec2(q)), p.front.aperture - p.back.aperture));
}

constexpr double kPi = 3.14159265358979323846;
double area_of(const SpherePrimitive& p) {
    return 4 * kPi * p.radius * p.radius;
}
double area_of(const ParaboloidPrimitive& p) {
    const double f = p.focal_length, r = p.radius;
    return 8 * kPi * f * f / 3 * (std::pow(1 + r * r / (4 * f * f), 1.5) - 1);
}
double area_of(const CylinderPrimitive& p) {
    return 2 * kPi * p.radius * p.height;
}
double area_of(const ConePrimitive& p) {
    return kPi * p.radius * std::hypot(p.radius, p.height);
}
double area_of(const PlanePrimitive& p) {
    return p.size.x * p.size.y;
}
double area_of(const LensPrimitive& p) {
    const double r = p.front.aperture, s = p.back.aperture;
    return kPi * (r * r + s * s + (r + s) * std::hypot(s - r, p.thickness));
}

Vec3 to_local(const Primitive& p, const Vec3& world) {
    const Vec3 offset = world - p.center;
    return {dot(offset, p.tangent), dot(offset, cross(p.axis, p.tangent)), dot(offset, p.axis)};
}

double residual(const Primitive& p, const Vec3& world) {
    return std::visit([&](const auto& kind) { return residual(kind, to_local(p, world)); }, p.kind);
}

bool is_inside_bounds(const Primitive& p, const Vec3& world, double slack) {
    return std::visit([&](const auto& kind) { return is_inside(kind, to_local(p, world), slack); }, p.kind);
}

Vec3 front(const Primitive& p, const Vec3& world) {
    const Vec3 n = std::visit([&](const auto& kind) { return front(kind, to_local(p, world)); }, p.kind);
    return n.x * p.tangent + n.y * cross(p.axis, p.tangent) + n.z * p.axis;
}

Vec2 random_uv(std::mt19937& random) {
    std::uniform_real_distribution<double> unit(0, 1);
    std::uniform_int_distribution<int> kind(0, 5);
    const auto one = [&] {
        const int k = kind(random);
        return k == 0 ? 0.0 : k == 1 ? 1.0 : unit(random);
    };
    return {one(), one()};
}

}  // namespace

TEST_CASE("Points of primitives satisfy the equation, with its normal and derivatives",
          "[surfaces][oracle]") {
    std::mt19937 random(3);
    for (const PrimitiveKind& kind : kKinds)
        for (double scale : {1e-4, 1e-2, 1.0, 1e2, 1e4}) {
            CAPTURE(kind.index(), scale);
            const Primitive primitive = random_primitive(kind, scale, random);
            const auto surface = make_primitive_surface(primitive);
            double area = 0;
            for (int i = 0; i < 200; ++i) {
                const Id face = static_cast<Id>(random() % surface->face_count());
                const Vec2 uv = random_uv(random);
                const SurfacePoint point = surface->eval(face, uv);
                CHECK(std::abs(residual(primitive, point.position)) < 1e-14 * scale * 10);
                CHECK(is_inside_bounds(primitive, point.position, 1e-14 * scale * 10));
                CHECK(length(point.normal) == Approx(1).epsilon(1e-14));
                if (point.du != Vec3(0)) {  // at a cone's apex each direction has a normal of its own
                    CHECK(length(point.normal - front(primitive, point.position)) < 1e-13);
                    CHECK(length(point.normal - normalize(cross(point.du, point.dv))) < 1e-12);
                }
                area += length(cross(point.du, point.dv)) / (scale * scale);

                const Vec2 inside = glm::clamp(uv, 0.01, 0.99);
                constexpr double kStep = 1e-5;
                const auto at = [&](double u, double v) { return surface->eval(face, inside + Vec2(u, v)); };
                const SurfacePoint here = at(0, 0), r = at(kStep, 0), l = at(-kStep, 0), t = at(0, kStep),
                                   b = at(0, -kStep);
                const double tolerance = 1e-8 * scale * 2 * kStep * 10;
                CHECK(length(r.position - l.position - 2 * kStep * here.du) < tolerance);
                CHECK(length(t.position - b.position - 2 * kStep * here.dv) < tolerance);
                CHECK(length(r.du - l.du - 2 * kStep * here.duu) < tolerance);
                CHECK(length(t.du - b.du - 2 * kStep * here.duv) < tolerance);
                CHECK(length(r.dv - l.dv - 2 * kStep * here.duv) < tolerance);
                CHECK(length(t.dv - b.dv - 2 * kStep * here.dvv) < tolerance);
            }
            CHECK(area > 0);
        }
}

TEST_CASE("The faces of a primitive cover it once", "[surfaces][law]") {
    std::mt19937 random(4);
    for (const PrimitiveKind& kind : kWithRims) {
        CAPTURE(kind.index());
        const Primitive p = random_primitive(kind, 1, random);
        const auto surface = make_primitive_surface(p);
        // The integral of |du x dv| over all faces against the area in closed form.
        double area = 0;
        constexpr int kSteps = 200;
        for (Id face = 0; face < surface->face_count(); ++face)
            for (int i = 0; i < kSteps; ++i)
                for (int j = 0; j < kSteps; ++j) {
                    const SurfacePoint point = surface->eval(face, {(i + 0.5) / kSteps, (j + 0.5) / kSteps});
                    area += length(cross(point.du, point.dv)) / (kSteps * kSteps);
                }
        const double expected = std::visit([](const auto& one) { return area_of(one); }, p.kind);
        CHECK(area == Approx(expected).epsilon(1e-4));
    }
}

TEST_CASE("A hit lies on the ray and on the surface, and is the first", "[surfaces]") {
    std::mt19937 random(5);
    std::normal_distribution<double> normal;
    std::uniform_real_distribution<double> exponent(-3, 3);
    for (const PrimitiveKind& kind : kWithRims)
        for (double scale : {1e-4, 1.0, 1e4}) {
            CAPTURE(kind.index(), scale);
            const Primitive primitive = random_primitive(kind, scale, random);
            const auto surface = make_primitive_surface(primitive);
            CHECK(surface->has_closed_form());
            int hits = 0, misses = 0;
            for (int i = 0; i < 300; ++i) {
                // Towards a point of the surface or beside it, from near or far, with a direction of any
                // length.
                const Vec3 target =
                    surface->eval(static_cast<Id>(random() % surface->face_count()), random_uv(random))
                        .position +
                    (i % 3 == 0 ? scale * Vec3(normal(random), normal(random), normal(random)) : Vec3(0));
                const double far = scale * std::pow(10, exponent(random));
                Ray ray{target + far * normalize(Vec3(normal(random), normal(random), normal(random))), {}};
                ray.direction = (target - ray.origin) * std::pow(10, exponent(random));
                const auto hit = surface->intersect(ray, 0);
                for (const double t_max : {1.0, 0.3, 2.0, hit ? hit->t : 1.0})
                    CHECK(surface->meets(ray, 0, t_max) == (hit && hit->t < t_max));
                // What a ray says is known to the rounding of its origin, its direction and the equation.
                const double tolerance = 1e-14 * (far + 10 * scale) * 4;

                // Brute force: signs of the equation along the ray, from behind the origin to past the shape.
                const double reach =
                    (length(ray.origin - primitive.center) + 10 * scale) / length(ray.direction);
                const double t0 = std::max(
                    0.0, (length(ray.origin - primitive.center) - 10 * scale) / length(ray.direction));
                std::optional<double> first;
                constexpr int kSteps = 4000;
                for (int k = 0; k < kSteps && !first; ++k) {
                    double a = t0 + (reach - t0) * k / kSteps, b = t0 + (reach - t0) * (k + 1) / kSteps;
                    const auto value = [&](double t) {
                        return residual(primitive, ray.origin + t * ray.direction);
                    };
                    if ((value(a) > 0) == (value(b) > 0)) continue;
                    for (int step = 0; step < 60; ++step)
                        ((value(a) > 0) == (value((a + b) / 2) > 0) ? a : b) = (a + b) / 2;
                    if (is_inside_bounds(primitive, ray.origin + b * ray.direction, -100 * tolerance))
                        first = b;
                }
                if (first) {
                    ++hits;
                    REQUIRE(hit);
                    // The surface may be hit once more between two steps, so the hit may be earlier, never
                    // later.
                    CHECK((hit->t - *first) * length(ray.direction) < 1e-6 * (far + scale));
                } else {
                    ++misses;
                }
                if (!hit) continue;
                CHECK(hit->t > 0);
                const Vec3 on_ray = ray.origin + hit->t * ray.direction;
                const SurfacePoint again = surface->eval(hit->face, hit->uv);
                CHECK(again.position == hit->point.position);
                CHECK(again.normal == hit->point.normal);
                CHECK(length(on_ray - again.position) < 100 * tolerance);
            }
            CHECK(hits > 50);
            CHECK(misses > 10);
        }
}

TEST_CASE("t_min leaves earlier hits out", "[surfaces]") {
    const auto sphere = make_primitive_surface(Primitive{});
    const Ray ray{{0, 0, 5}, {0, 0, -2}};
    CHECK(sphere->intersect(ray, 0)->t == Approx(2));
    CHECK(sphere->intersect(ray, 2.5)->t == Approx(3));
    CHECK_FALSE(sphere->intersect(ray, 3.5));
    CHECK_FALSE(sphere->intersect({{0, 0, 5}, {0, 0, 2}}, 0));
    CHECK_FALSE(sphere->intersect({{0, 0, 5}, {0, 0, 0}}, 0));
    CHECK_FALSE(sphere->intersect({{0, 0, 5}, {0, std::nan(""), -1}}, 0));
    CHECK_FALSE(sphere->intersect({{0, 2, 5}, {0, 0, -1}}, 0));
}

TEST_CASE("Of primitives the sphere alone has the curvature of a sphere", "[surfaces]") {
    for (const double radius : {1e-4, 0.5, 3e4}) {
        const Primitive sphere{.kind = SpherePrimitive{radius}};
        const auto surface = make_primitive_surface(sphere);
        CHECK(surface->sphere_curvature() == Approx(1 / radius).epsilon(1e-15));
        // Its normals point away from the centre, and lie on it.
        const SurfacePoint point = surface->eval(2, {0.3, 0.8});
        CHECK(length(point.position - point.normal / surface->sphere_curvature() - sphere.center) <
              1e-14 * radius);
        const SurfaceParameter there = surface->sphere_place(3.0 * point.normal);
        CHECK(there.face == 2);
        CHECK(length(there.uv - Vec2(0.3, 0.8)) < 1e-14);
    }
    CHECK(make_primitive_surface({.kind = kPlane})->sphere_place({0, 0, 1}).face == kNone);
    std::mt19937 random(7);
    for (const PrimitiveKind& kind : kKinds)
        if (!std::holds_alternative<SpherePrimitive>(kind))
            CHECK(make_primitive_surface(random_primitive(kind, 1, random))->sphere_curvature() == 0);
}

TEST_CASE("Rays along the axis, through the rim's plane and along the surface", "[surfaces]") {
    const Primitive dish{.axis = {0, 0, 1}, .kind = ParaboloidPrimitive{2, 0.5}};
    const auto paraboloid = make_primitive_surface(dish);
    const auto down = paraboloid->intersect({{1, 0.5, 10}, {0, 0, -1}}, 0);
    REQUIRE(down);
    CHECK(length(down->point.position - Vec3(1, 0.5, 0.625)) < 1e-15);
    // The law of the parabola: axis-parallel rays reflect through the focus.
    const Vec3 reflected =
        Vec3(0, 0, -1) - 2.0 * dot(Vec3(0, 0, -1), down->point.normal) * down->point.normal;
    CHECK(length(cross(reflected, Vec3(0, 0, 0.5) - down->point.position)) < 1e-15);

    const Primitive tube{.axis = {0, 0, 1}, .kind = CylinderPrimitive()};
    const auto cylinder = make_primitive_surface(tube);
    CHECK_FALSE(cylinder->intersect({{0.5, 0, 10}, {0, 0, -1}}, 0));
    CHECK(cylinder->intersect({{0, 0, 0.9}, {1, 0, 0}}, 0)->t == Approx(1));
    CHECK_FALSE(cylinder->intersect({{0, 0, 1.1}, {1, 0, 0}}, 0));

    const auto plane = make_primitive_surface({.kind = kPlane});
    CHECK_FALSE(plane->intersect({{-5, 0, 0}, {1, 0, 0}}, 0));
    CHECK(plane->intersect({{0.5, 1, -0.5}, {0, -1, 0}}, 0)->point.normal == Vec3(0, 1, 0));
}

TEST_CASE("Grids of primitives close, and their points satisfy the equation", "[surfaces][oracle]") {
    std::mt19937 random(6);
    for (int n : {1, 4, 9}) {
        CHECK(make_grid(*make_primitive_surface(random_primitive(kSphere, 1, random)), n).points.size() ==
              static_cast<std::size_t>(6 * n * n + 2));
        CHECK(make_grid(*make_primitive_surface(random_primitive(kCylinder, 1, random)), n).points.size() ==
              static_cast<std::size_t>(4 * n * (n + 1)));
        CHECK(make_grid(*make_primitive_surface(random_primitive(kParaboloid, 1, random)), n).points.size() ==
              static_cast<std::size_t>((n + 1) * (n + 1) + 4 * n * n));
        CHECK(make_grid(*make_primitive_surface(random_primitive(kPlane, 1, random)), n).points.size() ==
              static_cast<std::size_t>((n + 1) * (n + 1)));
    }
}

TEST_CASE("Primitives without a size or a frame are refused", "[surfaces][bad-input]") {
    for (const PrimitiveKind& kind : kKinds)
        for (const double wrong : {0.0, -1.0, std::numeric_limits<double>::infinity()})
            for (int which = 0; which < 2; ++which) {
                Primitive bad{.kind = kind};
                int number = 0;
                const auto spoil = [&](double& length, const char*) {
                    if (which == number++) length = wrong;
                };
                std::visit([&](auto& one) { for_each_length(one, spoil); }, bad.kind);
                if (which >= number) continue;  // a sphere has one length alone
                CAPTURE(kind.index(), wrong, which);
                CHECK_THROWS_AS(make_primitive_surface(bad), InputError);
            }
    Primitive bad;
    bad.tangent = 2.0 * bad.axis;
    CHECK_THROWS_AS(make_primitive_surface(bad), InputError);
}
