#include "inverse/design/best_sphere.h"

#include <cmath>
#include <limits>

#include "base/util/check.h"
#include "base/util/error.h"
#include "inverse/solve/cholesky.h"
#include "inverse/solve/levenberg_marquardt.h"

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

}  // namespace trilens
