// One image of a point on a curved surface: Levenberg-Marquardt on the law that Fermat's principle gives.
#include "specular/specular_point.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "base/util/check.h"

namespace trilens {
namespace {

constexpr int kMaxIterations = 100;
constexpr double kFirstDamping = 1e-3;  // of the normal matrix's mean diagonal
constexpr double kLastDamping = 1e12;   // steps are then shorter than rounding
constexpr double kAngleTolerance =
    1e-13;  // residual of a solution, per n1 + n2: some hundred rounding errors
constexpr double kRoundingErrors =
    64;  // coordinates carry this many units of rounding through the evaluation
// A remaining step that counts as none: an image on the rim between two faces then belongs to both, and is
// one by distinct_images.
constexpr double kParameterTolerance = 1e-9;
// A law that is missed by more is not kept, whatever rounding and steps are: at a cone's apex a parameter
// stands still, and curvature has no bound.
constexpr double kMostAtRest = 1e-3;
constexpr double kLastStep = 1e-6;        // in (u, v): Newton's error after it is below rounding
constexpr double kLeastStep = 1e-14;      // in (u, v): of the size of rounding itself
constexpr double kDifferenceStep = 1e-5;  // cube root of the rounding unit, for central differences in (u, v)

/// The two tangents that the law is tested along.
std::array<Vec3, 2> tangents(const SpecularQuery& query, const SurfacePoint& point) {
    if (query.own_normals) return {point.du, point.dv};
    const Vec3& n = point.normal;
    return {point.du - dot(point.du, n) * n, point.dv - dot(point.dv, n) * n};
}

Vec2 gradient(const SpecularQuery& query, const SpecularPath& path, const SurfacePoint& point) {
    const std::array<Vec3, 2> along = tangents(query, point);
    return {dot(path.bend, along[0]), dot(path.bend, along[1])};
}

Vec2 gradient(const SpecularQuery& query, const SurfacePoint& point) {
    return gradient(query, specular_path(query, point.position), point);
}

/// One iterate: the law's two equations and their Jacobian, in an orthonormal frame of the tangent plane.
struct Iterate {
    SurfaceParameter at;
    SurfacePoint point;
    SpecularPath path;
    bool regular = false;  // du and dv span the tangent plane
    Mat2 metric_root{0};   // L, lower: L L^T = (du, dv)^T (du, dv)
    Vec2 law{0};           // L^-1 gradient: h along the surface
    double residual = std::numeric_limits<double>::infinity();
};

Iterate evaluate_at(const SurfaceParameter& at, const SurfacePoint& point, const SpecularQuery& query) {
    Iterate result{at, point, specular_path(query, point.position)};
    const Vec3 &du = result.point.du, &dv = result.point.dv;

    // Cholesky's root of the first fundamental form; the second pivot is the height of dv over du.
    const double size_u = length(du);
    if (!(size_u > 0)) return result;
    const double shear = dot(du, dv) / size_u;
    const double height = length(cross(du, dv)) / size_u;
    if (!(height > 1e-12 * length(dv)) || result.point.normal == Vec3(0)) return result;
    result.regular = true;
    result.metric_root = Mat2(Vec2(size_u, shear), Vec2(0, height));

    const Vec2 g = gradient(query, result.path, result.point);
    const double first = g.x / size_u;
    result.law = {first, (g.y - shear * first) / height};
    const double residual = length(result.law);
    if (std::isfinite(residual)) result.residual = residual;
    return result;
}

Iterate evaluate(const Surface& surface, const SurfaceParameter& at, const SpecularQuery& query) {
    return evaluate_at(at, surface.eval(at.face, at.uv), query);
}

/// The gradient's derivatives by central differences, one-sided at the domain's border.
Mat2 difference_jacobian(const Surface& surface, const SurfaceParameter& at, const SpecularQuery& query) {
    const FaceDomain domain = surface.domain(at.face);
    Mat2 jacobian(0);
    for (int k = 0; k < 2; ++k) {
        Vec2 step(0);
        step[k] = kDifferenceStep;
        Vec2 low = clamped_to(domain, at.uv - step), high = at.uv + step;
        if (clamped_to(domain, high) != high)
            high = at.uv;  // at a triangle's long side clamping would move both parameters
        const Vec2 change =
            gradient(query, surface.eval(at.face, high)) - gradient(query, surface.eval(at.face, low));
        jacobian[k] = change / (high[k] - low[k]);
    }
    return jacobian;
}

/// L^-1 J L^-T: the Jacobian per length along the surface.
Mat2 metric_jacobian(const Surface& surface, const Iterate& iterate, const SpecularQuery& query) {
    const Mat2 plain = query.own_normals ? path_hessian(query, iterate.path, iterate.point)
                                         : difference_jacobian(surface, iterate.at, query);
    const Mat2 inverse_root = glm::inverse(iterate.metric_root);
    return inverse_root * plain * glm::transpose(inverse_root);
}

double squared_size(const Mat2& m) {
    return dot(m[0], m[0]) + dot(m[1], m[1]);
}

/// The step in (u, v) that minimises |law + J s|^2 + damping |s|^2, s measured along the surface.
Vec2 damped_step(const Iterate& iterate, const Mat2& jacobian, double damping) {
    const Mat2 transposed = glm::transpose(jacobian);
    Mat2 normal = transposed * jacobian;
    normal[0][0] += damping;
    normal[1][1] += damping;
    const double determinant = glm::determinant(normal);
    if (!(determinant > 0)) return Vec2(0);
    const Vec2 right = -(transposed * iterate.law);
    const Vec2 along(normal[1][1] * right.x - normal[1][0] * right.y,
                     normal[0][0] * right.y - normal[0][1] * right.x);
    return glm::transpose(glm::inverse(iterate.metric_root)) * (along / determinant);
}

/// The residual that rounding leaves: of the directions, and of coordinates that moved by their last bits.
double rounding_floor(const Iterate& iterate, const Mat2& jacobian, const SpecularQuery& query) {
    const Vec3 &p = iterate.point.position, &x = query.point;
    const double coordinate = std::max({std::fabs(p.x), std::fabs(p.y), std::fabs(p.z), std::fabs(x.x),
                                        std::fabs(x.y), std::fabs(x.z), length(query.camera.eye)});
    const double moved = kRoundingErrors * std::numeric_limits<double>::epsilon() * coordinate;
    const PathIndices n = path_indices(query);
    return kAngleTolerance * (n.eye + n.point) + moved * std::sqrt(squared_size(jacobian));
}

/// Where the damped iteration comes to rest.
struct Rest {
    Iterate iterate;
    bool solved = false;
    int iterations = 0;
};

double largest(const Vec2& v) {
    return std::max(std::fabs(v.x), std::fabs(v.y));
}

/// One last undamped step, which brings grazing images from the tolerance down to rounding. Longer steps than
/// kLastStep come from a singular Jacobian (a point on a caustic) and are not taken, shorter ones than
/// kLeastStep change nothing.
void polish(const Surface& surface, const SpecularQuery& query, const Mat2& jacobian, Iterate& iterate) {
    const Vec2 step = damped_step(iterate, jacobian, 0);
    if (largest(step) > kLastStep || largest(step) < kLeastStep) return;
    const Vec2 uv = clamped_to(surface.domain(iterate.at.face), iterate.at.uv + step);
    const Iterate next = evaluate(surface, {iterate.at.face, uv}, query);
    if (next.residual < iterate.residual) iterate = next;
}

Rest solve_law(const Surface& surface, const Iterate& start, const SpecularQuery& query) {
    const FaceDomain domain = surface.domain(start.at.face);
    Rest rest{start};
    Iterate& now = rest.iterate;
    double damping = kFirstDamping;
    while (now.regular && std::isfinite(now.residual)) {
        const Mat2 jacobian = metric_jacobian(surface, now, query);
        const double scale = 0.5 * squared_size(jacobian);
        rest.solved = now.residual <= std::min(rounding_floor(now, jacobian, query), kMostAtRest);
        if (rest.solved) {
            polish(surface, query, jacobian, now);
            break;
        }

        // Shorten the step until the residual falls.
        bool fell = false;
        for (; rest.iterations < kMaxIterations && damping < kLastDamping && !fell; ++rest.iterations) {
            const Vec2 step = damped_step(now, jacobian, damping * scale);
            const Iterate next =
                evaluate(surface, {now.at.face, clamped_to(domain, now.at.uv + step)}, query);
            fell = next.regular && next.residual < now.residual;
            if (fell) now = next;
            damping = fell ? 0.03 * damping : std::max(16 * damping, kFirstDamping);
        }
        if (fell) continue;

        const Vec2 left = damped_step(now, jacobian, 0);
        rest.solved = left != Vec2(0) && largest(left) <= kParameterTolerance && now.residual <= kMostAtRest;
        break;
    }
    return rest;
}

std::optional<SpecularPoint> refine_from(const Surface& surface, const Iterate& start,
                                         const SpecularQuery& query) {
    const Rest rest = solve_law(surface, start, query);
    if (!rest.solved) return std::nullopt;

    const SurfacePoint& point = rest.iterate.point;
    const SpecularPath& path = rest.iterate.path;
    const Vec3 screen = screen_from_world(query.camera, point.position);
    if (!sides_fit(query, path, point.normal) || !(screen.z > 0)) return std::nullopt;

    SpecularPoint image;
    image.at = rest.iterate.at;
    image.position = point.position;
    image.normal = point.normal;
    image.pixel = Vec2(screen.x, screen.y) / screen.z;
    image.distance = path.point_distance;
    image.t = path.point_distance / length(incident_direction(query.camera, point.position));
    image.front = dot(path.from_eye, point.normal) < 0;
    image.residual = rest.iterate.residual;
    image.iterations = rest.iterations;
    return image;
}

}  // namespace

std::optional<SpecularPoint> refine_specular_point(const Surface& surface, const SurfaceParameter& start,
                                                   const SpecularQuery& query) {
    TRILENS_CHECK(query.eye_index > 0 && query.point_index > 0, "a refractive index is positive");
    const Vec2 uv = clamped_to(surface.domain(start.face), start.uv);
    return refine_from(surface, evaluate(surface, {start.face, uv}, query), query);
}

std::optional<SpecularPoint> refine_specular_point(const Surface& surface, const SurfaceParameter& start,
                                                   const SurfacePoint& point, const SpecularQuery& query) {
    TRILENS_CHECK(clamped_to(surface.domain(start.face), start.uv) == start.uv,
                  "the start lies in the domain");
    return refine_from(surface, evaluate_at(start, point, query), query);
}

PathIndices path_indices(const SpecularQuery& query) {
    if (query.event == SpecularEvent::kReflect) return {1, 1};
    return {query.eye_index, query.point_index};
}

SpecularPath specular_path(const SpecularQuery& query, const Vec3& position) {
    SpecularPath path;
    const Vec3 incident = incident_direction(query.camera, position), back = position - query.point;
    path.from_eye = normalize_or_zero(incident);
    path.from_point = normalize_or_zero(back);
    path.eye_distance = query.camera.parallel ? std::numeric_limits<double>::infinity() : length(incident);
    path.point_distance = length(back);
    const PathIndices n = path_indices(query);
    path.bend = n.eye * path.from_eye + n.point * path.from_point;
    return path;
}

namespace {

/// How the unit direction to P from a fixed point changes as P moves by `step`.
Vec3 turn(const Vec3& direction, double distance, const Vec3& step) {
    return (step - dot(direction, step) * direction) / distance;
}

}  // namespace

Mat2 path_hessian(const SpecularQuery& query, const SurfacePoint& point) {
    return path_hessian(query, specular_path(query, point.position), point);
}

Mat2 path_hessian(const SpecularQuery& query, const SpecularPath& path, const SurfacePoint& point) {
    const PathIndices n = path_indices(query);
    auto bend_change = [&](const Vec3& step) {
        return n.eye * turn(path.from_eye, path.eye_distance, step) +
               n.point * turn(path.from_point, path.point_distance, step);
    };
    const Vec3 change_u = bend_change(point.du), change_v = bend_change(point.dv);
    const double uu = dot(change_u, point.du) + dot(path.bend, point.duu);
    const double uv = dot(change_u, point.dv) + dot(path.bend, point.duv);
    const double vv = dot(change_v, point.dv) + dot(path.bend, point.dvv);
    return {Vec2(uu, uv), Vec2(uv, vv)};
}

bool sides_fit(const SpecularQuery& query, const SpecularPath& path, const Vec3& normal) {
    const double sides = dot(path.from_eye, normal) * dot(path.from_point, normal);
    const bool front = dot(path.from_eye, normal) < 0;
    if (query.viewed != ViewedSide::kEither && front != (query.viewed == ViewedSide::kFront)) return false;
    return query.event == SpecularEvent::kReflect ? sides > 0 : sides < 0;
}

std::vector<SpecularPoint> specular_points(const Surface& surface, std::span<const SurfaceParameter> starts,
                                           const SpecularQuery& query) {
    std::vector<SpecularPoint> images;
    for (const SurfaceParameter& start : starts) {
        if (const auto image = refine_specular_point(surface, start, query)) images.push_back(*image);
    }
    return distinct_images(std::move(images));
}

void append_regular_starts(const Surface& surface, Id face, int n, std::vector<SurfaceParameter>& starts) {
    TRILENS_CHECK(n > 0, "a domain is divided into one cell at least");
    const bool triangle = surface.domain(face) == FaceDomain::kTriangle;
    const double middle = triangle ? 1.0 / 3 : 0.5;
    for (int row = 0; row < n; ++row)
        for (int column = 0; column < (triangle ? n - row : n); ++column)
            starts.push_back({face, (Vec2(column, row) + middle) / static_cast<double>(n)});
}

std::vector<SurfaceParameter> regular_starts(const Surface& surface, int n) {
    std::vector<SurfaceParameter> starts;
    for (Id face = 0; face < surface.face_count(); ++face) append_regular_starts(surface, face, n, starts);
    return starts;
}

std::vector<SpecularPoint> distinct_images(std::vector<SpecularPoint> images) {
    if (images.size() < 2) return images;
    std::stable_sort(images.begin(), images.end(),
                     [](const SpecularPoint& a, const SpecularPoint& b) { return a.residual < b.residual; });
    auto same = [](const SpecularPoint& a, const SpecularPoint& b) {
        return a.front == b.front && length(a.pixel - b.pixel) < kSamePixels &&
               length(a.position - b.position) <= kSameCrossing * a.distance;
    };
    std::vector<SpecularPoint> distinct;
    for (const SpecularPoint& image : images) {
        const bool known = std::any_of(distinct.begin(), distinct.end(),
                                       [&](const SpecularPoint& other) { return same(other, image); });
        if (!known) distinct.push_back(image);
    }
    std::stable_sort(distinct.begin(), distinct.end(),
                     [](const SpecularPoint& a, const SpecularPoint& b) { return a.t < b.t; });
    return distinct;
}

}  // namespace trilens
