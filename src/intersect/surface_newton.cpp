// Newton's method with a bounded step that must bring the surface nearer to the ray.
#include "intersect/surface_newton.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace trilens {
namespace {

constexpr int kMaxSteps = 24;  // quadratic convergence takes 4 or 5; a silhouette halves the error per step
constexpr int kMaxHalvings = 4;

Vec2 clamp_to_domain(FaceDomain domain, Vec2 uv) {
    if (domain == FaceDomain::kSquare) return glm::clamp(uv, 0.0, 1.0);
    const double over = uv.x + uv.y - 1;
    if (over > 0) uv -= 0.5 * over;
    if (uv.x < 0) return {0, std::clamp(uv.y, 0.0, 1.0)};
    if (uv.y < 0) return {std::clamp(uv.x, 0.0, 1.0), 0};
    return uv;
}

/// A point of the face, how far off the ray it is, and where to go from it.
struct Trial {
    Vec2 uv{0};
    SurfacePoint point;
    double z = 0;              // along the ray
    double miss = 0;           // distance from the ray's line
    std::optional<Vec2> step;  // in (u, v); none where the tangent plane gives none
};

// The step that brings the tangent plane's point onto the ray; none where the ray lies in that plane, or
// there is none.
std::optional<Vec2> newton_step(const RayFrame& ray, const SurfacePoint& point, const Vec3& local) {
    const Vec2 du(dot(ray.x, point.du), dot(ray.y, point.du)), dv(dot(ray.x, point.dv), dot(ray.y, point.dv));
    const double determinant = du.x * dv.y - dv.x * du.y;
    const Vec2 step = Vec2(dv.x * local.y - dv.y * local.x, du.y * local.x - du.x * local.y) / determinant;
    if (!std::isfinite(step.x) || !std::isfinite(step.y)) return std::nullopt;
    return step;
}

Trial eval_trial(const Surface& surface, const RayFrame& ray, const SurfaceGuess& guess, const Vec2& uv) {
    Trial trial;
    trial.uv = clamp_to_domain(surface.domain(guess.face), uv);
    trial.point = surface.eval_first_order(guess.face, trial.uv);
    const Vec3 local = ray.from_world(trial.point.position);
    trial.z = local.z;
    trial.miss = std::hypot(local.x, local.y);
    trial.step = newton_step(ray, trial.point, local);
    if (!trial.step) return trial;
    const double size = std::max(std::fabs(trial.step->x), std::fabs(trial.step->y));
    if (size > guess.reach) *trial.step *= guess.reach / size;
    return trial;
}

}  // namespace

std::optional<RayFrame> make_ray_frame(const Ray& ray) {
    RayFrame frame{ray.origin, {}, {}, normalize_or_zero(ray.direction), 0};
    frame.speed = dot(frame.z, ray.direction);
    if (!(frame.speed > 0) || !std::isfinite(frame.speed) || !std::isfinite(dot(ray.origin, Vec3(1)))) {
        return std::nullopt;
    }
    const Vec3 size = glm::abs(frame.z);
    const Vec3 least = size.x <= size.y && size.x <= size.z ? Vec3(1, 0, 0)
                       : size.y <= size.z                   ? Vec3(0, 1, 0)
                                                            : Vec3(0, 0, 1);
    frame.x = normalize(cross(least, frame.z));
    frame.y = cross(frame.z, frame.x);
    return frame;
}

std::optional<SurfaceHit> solve_surface_hit(const Surface& surface, const RayFrame& ray,
                                            const SurfaceGuess& guess) {
    Trial best = eval_trial(surface, ray, guess, guess.uv);
    const double scale = length(best.point.position) + length(ray.origin);
    const double good_enough = kSurfaceResidual * scale, best_possible = 1e-3 * good_enough;
    const auto improves = [&](const Trial& next) {
        return next.miss < best.miss && (next.step || next.miss <= good_enough);
    };
    for (int i = 0; i < kMaxSteps && best.miss > best_possible && best.step; ++i) {
        // Take the longest of 1, 1/2, 1/4 .. of the step that brings the point nearer to the ray, and not
        // into a dead end. Steps end at the face's border: behind it derivatives say nothing where the
        // surface is pinched.
        Trial next = eval_trial(surface, ray, guess, best.uv + *best.step);
        const int halvings = best.miss <= good_enough ? 0 : kMaxHalvings;
        for (int k = 1; k <= halvings && !improves(next); ++k) {
            next = eval_trial(surface, ray, guess, best.uv + std::ldexp(1.0, -k) * *best.step);
        }
        if (!improves(next)) break;
        best = next;
    }
    if (!(best.miss <= good_enough)) return std::nullopt;
    return SurfaceHit{guess.face, best.uv, best.z / ray.speed, best.point};
}

std::optional<SecondHit> predict_second_hit(const SurfaceHit& hit, const Vec3& direction) {
    // The direction in the tangent plane, as a rate of (u, v) per unit of t.
    const SurfacePoint& p = hit.point;
    const double uu = dot(p.du, p.du), uv = dot(p.du, p.dv), vv = dot(p.dv, p.dv);
    const double along_u = dot(direction, p.du), along_v = dot(direction, p.dv);
    const double determinant = uu * vv - uv * uv;
    const Vec2 rate = Vec2(vv * along_u - uv * along_v, uu * along_v - uv * along_u) / determinant;

    // Height over the tangent plane: t (n . d) of the ray, t^2 K / 2 of the surface.
    const Vec3 bend = rate.x * rate.x * p.duu + 2 * rate.x * rate.y * p.duv + rate.y * rate.y * p.dvv;
    const double t_step = 2 * dot(p.normal, direction) / dot(p.normal, bend);
    if (!std::isfinite(t_step) || t_step == 0) return std::nullopt;
    return SecondHit{hit.uv + t_step * rate, t_step};
}

}  // namespace trilens
