#include "inverse/design/mirror_fit.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/util/check.h"
#include "base/util/error.h"
#include "inverse/solve/least_squares.h"
#include "reflect/reflection.h"
#include "refract/refraction.h"

namespace trilens {

namespace {

/// Curvature and tilt, in units in which 1 is a large step.
struct SphereShape {
    double curvature = 0;
    Vec2 tilt{0};
};

std::optional<std::vector<double>> sphere_residuals(const DesignWish& wish, const WishedRays& rays,
                                                    std::span<const Vec2> samples, const SphereShape& shape) {
    std::vector<double> residuals;
    for (const Vec2& at : samples) {
        const std::optional<Height> h = sphere_height(shape.curvature, shape.tilt, at - wish.anchor);
        if (!h) return std::nullopt;
        const Vec3 residual = ray_residual(rays, at, *h);
        residuals.insert(residuals.end(), {residual.x, residual.y, residual.z});
    }
    return residuals;
}

}  // namespace

std::optional<Height> sphere_height(double curvature, const Vec2& tilt, const Vec2& at) {
    // k P . P + 2 n . P = 0 with the unit normal n in the origin: k z^2 + b z + c = 0, the root that goes to
    // the plane's as k goes to 0.
    const Vec3 n = normalize(Vec3(-tilt.x, -tilt.y, 1));
    const double b = 2 * n.z, c = curvature * dot(at, at) + 2 * (n.x * at.x + n.y * at.y);
    const double discriminant = b * b - 4 * curvature * c;
    if (!(discriminant > 0)) return std::nullopt;
    Height h;
    h.z = -2 * c / (b + std::sqrt(discriminant));
    const Vec3 gradient = curvature * Vec3(at, h.z) + n;
    if (!(gradient.z > 0)) return std::nullopt;
    h.x = -gradient.x / gradient.z, h.y = -gradient.y / gradient.z;
    return h;
}

BestSphere best_sphere(const DesignWish& wish, const WishedRays& rays, std::span<const Vec2> samples) {
    const double scale = 1 / std::max(wish.patch.size.x, wish.patch.size.y);  // of curvature
    SphereShape shape;
    const auto moved = [&](std::span<const double> step) {
        return SphereShape{shape.curvature + scale * step[0], shape.tilt + Vec2(step[1], step[2])};
    };
    LeastSquares problem;
    problem.unknowns = 3;
    problem.group = 3;
    problem.group_count = samples.size();
    problem.residuals_after = [&](std::span<const double> step) {
        return sphere_residuals(wish, rays, samples, moved(step));
    };
    problem.accept = [&](std::span<const double> step) { shape = moved(step); };
    problem.linearise = [&] {
        constexpr double kStep = 1e-6;
        Linearisation at{*sphere_residuals(wish, rays, samples, shape), DenseMatrix(3 * samples.size(), 3)};
        for (std::size_t k = 0; k < 3; ++k) {
            std::array<double, 3> step{};
            step[k] = kStep;
            const auto high = sphere_residuals(wish, rays, samples, moved(step));
            step[k] = -kStep;
            const auto low = sphere_residuals(wish, rays, samples, moved(step));
            if (high && low)
                for (std::size_t i = 0; i < at.residuals.size(); ++i)
                    at.jacobian(i, k) = ((*high)[i] - (*low)[i]) / (2 * kStep);
        }
        return at;
    };
    minimise(problem);

    BestSphere best;
    best.radius = shape.curvature != 0 ? 1 / shape.curvature : std::numeric_limits<double>::infinity();
    best.tilt = shape.tilt;
    std::vector<double> degrees;
    for (const Vec2& at : samples)
        degrees.push_back(ray_error(rays, at, *sphere_height(shape.curvature, shape.tilt, at - wish.anchor)));
    best.errors = design_errors(std::move(degrees));
    return best;
}

Design design_of_sphere(const DesignWish& wish, const Design& design) {
    TRILENS_CHECK(design.sphere.has_value(), "the best sphere was found");
    const double curvature = std::isinf(design.sphere->radius) ? 0 : 1 / design.sphere->radius;
    Design sphere;
    sphere.surface = HeightField(wish.patch.size, wish.patch.controls);
    sphere.errors = design.sphere->errors;
    sphere.back = design.back;
    NormalEquations equations(sphere.surface.heights.size());
    for (const Vec2& at :
         patch_samples(wish.patch.size, {4 * wish.patch.controls[0], 4 * wish.patch.controls[1]})) {
        const std::optional<Height> h = sphere_height(curvature, design.sphere->tilt, at - wish.anchor);
        if (!h) throw ComputationError("the best sphere does not reach over the whole rectangle");
        const HeightBasis basis = sphere.surface.basis(at);
        equations.add(basis.index, basis.z, h->z);
    }
    sphere.surface.heights = equations.solve();
    TRILENS_CHECK(!sphere.surface.heights.empty(), "four samples a knot fix all control points");
    return sphere;
}

std::vector<Vec2> patch_samples(const Vec2& size, const std::array<int, 2>& counts) {
    std::vector<Vec2> samples;
    for (int row = 0; row < counts[1]; ++row)
        for (int column = 0; column < counts[0]; ++column)
            samples.push_back((Vec2(column + 0.5, row + 0.5) / Vec2(counts[0], counts[1]) - 0.5) * size);
    return samples;
}

namespace {

/// How far beside a place `depth` above a plane light leaves glass there for a point `across` beside that
/// place and `beyond` behind the plane. The time that it takes is convex (Fermat), so that n sin - sin, its
/// slope, has one root: Newton's, halved where it slows down.
double exit_distance(double ior, double across, double depth, double beyond) {
    double low = 0, high = across, at = across * depth / (depth + beyond), last = across;
    while (high > low) {
        const double to_place = std::hypot(at, depth), to_point = std::hypot(across - at, beyond);
        const double slope = ior * at / to_place - (across - at) / to_point;
        const double bend = ior * depth * depth / (to_place * to_place * to_place) +
                            beyond * beyond / (to_point * to_point * to_point);
        (slope < 0 ? low : high) = at;
        double step = -slope / bend;
        if (!(at + step > low && at + step < high) || std::abs(step) > last / 2) step = (low + high) / 2 - at;
        last = std::abs(step);
        if (at + step == at || last < 1e-17 * across) break;
        at += step;
    }
    return at;
}

/// The wished direction as it is in the glass before it leaves the plane back, from a place of the front;
/// from one behind the back, as of surfaces on their way, it leaves at once. None where what is wished is not
/// behind the back.
std::optional<Vec3> wished_in_glass(const WishedRays& wish, const Vec3& place) {
    constexpr double kLeastDescent = 1e-6;  // of unit directions
    const DesignLens& lens = *wish.lens();
    const std::optional<Vec3> point = wish.wanted_point(place);
    const double depth = lens.thickness + place.z;
    if (point && depth > 0) {
        const Vec2 to_point = Vec2(*point) - Vec2(place);
        const double across = length(to_point), beyond = -lens.thickness - point->z;
        if (!(beyond > kLeastDescent * length(*point - place))) return std::nullopt;
        if (across == 0) return Vec3(0, 0, -1);
        return normalize(Vec3(exit_distance(lens.ior, across, depth, beyond) / across * to_point, -depth));
    }
    const Vec3 wanted = wish.wanted(place);
    if (!(wanted.z < -kLeastDescent)) return std::nullopt;
    const Vec2 across = Vec2(wanted) / lens.ior;
    return Vec3(across, -std::sqrt(1 - dot(across, across)));
}

RayRows mirror_rows(const WishedRays& wish, const Vec2& at, const Height& h, double length_scale) {
    const Vec3 place(at, h.z), up(-h.x, -h.y, 1), u = normalize(up), from_eye = place - wish.eye();
    const Vec3 d = normalize(from_eye);
    RayRows rows;
    // d turns by (e_z - d d_z) / |P - E|, and the wished direction moves with the place.
    const double step = 1e-5 * length_scale;
    const Vec3 wish_moves =
        (wish.wanted(place + Vec3(0, 0, step)) - wish.wanted(place - Vec3(0, 0, step))) / (2 * step);
    rows.by_z = mirrored((Vec3(0, 0, 1) - d * d.z) / length(from_eye), u) - wish_moves;
    // r = d - 2 (d . u) u, with u = N / |N| and N = (-p, -q, 1).
    const auto by_slope = [&](const Vec3& axis) {
        const Vec3 turn = -(axis - u * dot(u, axis)) / length(up);
        return -2.0 * (dot(d, turn) * u + dot(d, u) * turn);
    };
    rows.by_x = by_slope({1, 0, 0});
    rows.by_y = by_slope({0, 1, 0});
    return rows;
}

/// By central differences.
RayRows lens_rows(const WishedRays& wish, const Vec2& at, const Height& h, double length_scale) {
    const auto change = [&](double Height::*number, double step) {
        Height low = h, high = h;
        low.*number -= step, high.*number += step;
        return (ray_residual(wish, at, high) - ray_residual(wish, at, low)) / (2 * step);
    };
    RayRows rows;
    rows.by_z = change(&Height::z, 1e-5 * length_scale);
    rows.by_x = change(&Height::x, 1e-5);
    rows.by_y = change(&Height::y, 1e-5);
    return rows;
}

}  // namespace

NeededSlopes needed_slopes(const WishedRays& wish, const Vec3& place) {
    const Vec3 to_eye = normalize(wish.eye() - place);
    Vec3 normal(0);
    if (!wish.lens()) {
        normal = to_eye + wish.wanted(place);
    } else {
        const std::optional<Vec3> in_glass = wished_in_glass(wish, place);
        if (!in_glass) return {Vec2(0), "what is wished does not lie behind its back"};
        normal = -to_eye - wish.lens()->ior * *in_glass;
    }
    if (!(normal.z > 1e-6) || !(dot(normal, to_eye) > 0))
        return {Vec2(0), wish.lens() ? "no front turns the eye's ray so far" : "the wished ray goes into it"};
    return {Vec2(-normal.x, -normal.y) / normal.z, nullptr};
}

Ray leaving_ray(const WishedRays& wish, const Vec2& at, const Height& h) {
    const Vec3 place(at, h.z), normal = normalize(Vec3(-h.x, -h.y, 1));
    const Vec3 incoming = normalize(place - wish.eye());
    if (!wish.lens()) return {place, mirrored(incoming, normal)};
    const DesignLens& lens = *wish.lens();
    const std::optional<Vec3> in_glass = refracted(incoming, normal, 1 / lens.ior);
    if (!in_glass || !(in_glass->z < 0)) return {place, -incoming};
    const Vec3 from = place - (lens.thickness + h.z) / in_glass->z * *in_glass;
    const std::optional<Vec3> out = refracted(*in_glass, {0, 0, 1}, lens.ior);
    return {from, out ? normalize(*out) : -incoming};
}

Vec3 ray_residual(const WishedRays& wish, const Vec2& at, const Height& h) {
    const Ray ray = leaving_ray(wish, at, h);
    return ray.direction - wish.wanted(Vec3(at, h.z), ray.origin);
}

RayRows ray_rows(const WishedRays& wish, const Vec2& at, const Height& h, double length_scale) {
    RayRows rows =
        wish.lens() ? lens_rows(wish, at, h, length_scale) : mirror_rows(wish, at, h, length_scale);
    rows.residual = ray_residual(wish, at, h);
    return rows;
}

double ray_error(const WishedRays& wish, const Vec2& at, const Height& h) {
    constexpr double kDegrees = 57.29577951308232;
    const double chord = std::min(2.0, length(ray_residual(wish, at, h)));  // of unit directions
    return kDegrees * 2 * std::asin(chord / 2);
}

double slope_curl(const WishedRays& wish, const Vec3& place, double step) {
    const auto change = [&](const Vec3& by) {
        return (needed_slopes(wish, place + by).slopes - needed_slopes(wish, place - by).slopes) / (2 * step);
    };
    const Vec2 slopes = needed_slopes(wish, place).slopes;
    const Vec2 by_x = change({step, 0, 0}), by_y = change({0, step, 0}), by_z = change({0, 0, step});
    return (by_y.x + by_z.x * slopes.y) - (by_x.y + by_z.y * slopes.x);
}

}  // namespace trilens
