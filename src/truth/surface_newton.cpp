// Newton's method with a bounded step that must bring the surface nearer to the ray.
#include "truth/surface_newton.h"

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

/// The surface at parameters that may lie a little outside of the face, and how far off the ray that is.
struct Trial {
    Vec2 uv{0};
    SurfacePoint point;
    Vec3 local{0};  // in the ray's frame
    double miss = 0;
};

Trial eval_trial(const Surface& surface, const RayFrame& ray, const SurfaceGuess& guess, const Vec2& uv) {
    const Vec2 inside = clamp_to_domain(surface.domain(guess.face), uv);
    Trial trial{uv, surface.eval(guess.face, inside), {}, 0};

    // Outside the face its Taylor expansion goes on.
    if (inside != uv) {
        const Vec2 d = glm::clamp(uv - inside, -guess.reach, guess.reach);
        trial.uv = inside + d;
        SurfacePoint& p = trial.point;
        p.position +=
            d.x * p.du + d.y * p.dv + 0.5 * d.x * d.x * p.duu + d.x * d.y * p.duv + 0.5 * d.y * d.y * p.dvv;
        p.du += d.x * p.duu + d.y * p.duv;
        p.dv += d.x * p.duv + d.y * p.dvv;
    }
    trial.local = ray.from_world(trial.point.position);
    trial.miss = std::hypot(trial.local.x, trial.local.y);
    return trial;
}

// The step in (u, v) that brings the tangent plane's point onto the ray; none where the ray lies in that
// plane.
std::optional<Vec2> newton_step(const RayFrame& ray, const Trial& at, double reach) {
    const Mat2 jacobian(dot(ray.x, at.point.du), dot(ray.y, at.point.du), dot(ray.x, at.point.dv),
                        dot(ray.y, at.point.dv));
    const double determinant = glm::determinant(jacobian);
    const Vec2 step = Vec2(jacobian[1][0] * at.local.y - jacobian[1][1] * at.local.x,
                           jacobian[0][1] * at.local.x - jacobian[0][0] * at.local.y) /
                      determinant;
    const double size = std::max(std::fabs(step.x), std::fabs(step.y));
    if (!std::isfinite(size)) return std::nullopt;
    return size > reach ? step * (reach / size) : step;
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
    for (int i = 0; i < kMaxSteps && best.miss > 0; ++i) {
        const std::optional<Vec2> step = newton_step(ray, best, guess.reach);
        if (!step) break;

        // Take the longest of 1, 1/2, 1/4 .. of the step that helps; where none does, rounding is all that is
        // left.
        Trial next = eval_trial(surface, ray, guess, best.uv + *step);
        for (int k = 1; k <= kMaxHalvings && !(next.miss < best.miss); ++k) {
            if (best.miss <= kSurfaceResidual * scale) break;
            next = eval_trial(surface, ray, guess, best.uv + std::ldexp(1.0, -k) * *step);
        }
        if (!(next.miss < best.miss)) break;
        best = next;
        if (best.miss <= 2 * std::numeric_limits<double>::epsilon() * scale) break;
    }

    // Back onto the face: what strays from the ray by more than rounding was no hit of this face.
    const Vec2 inside = clamp_to_domain(surface.domain(guess.face), best.uv);
    if (inside != best.uv) best = eval_trial(surface, ray, guess, inside);
    if (!(best.miss <= kSurfaceResidual * scale)) return std::nullopt;
    return SurfaceHit{guess.face, best.uv, best.local.z / ray.speed, best.point};
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
