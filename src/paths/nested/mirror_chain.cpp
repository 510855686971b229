// A ray carries its derivatives from mirror to mirror. Source: Igehy, Tracing Ray Differentials, SIGGRAPH
// 1999.
#include "paths/nested/mirror_chain.h"

#include <cmath>

#include "base/util/check.h"
#include "paths/probe/path_probe.h"
#include "reflect/reflection.h"

namespace trilens {
namespace {

constexpr double kFaceStep = 1e-5;  // of a face's parameters, for the normal's differences
constexpr double kWayDone = 1e-11;  // of the way to the point: a miss below this is none
constexpr double kMostTurn = 0.2;   // radians that one step may go
constexpr double kBehind = -1e-9;   // of the way: a point on the last mirror itself counts as before it
constexpr int kMostNewtonSteps = 16, kMostHalvings = 4;

/// How the normal turns along u and along v at a hit: of n = (du x dv) / |du x dv|.
std::array<Vec3, 2> own_normal_along(const SurfacePoint& at) {
    const Vec3 across = cross(at.du, at.dv), &n = at.normal;
    const double area = dot(across, n);  // signed: the normal may be turned
    const Vec3 u = cross(at.duu, at.dv) + cross(at.du, at.duv),
               v = cross(at.duv, at.dv) + cross(at.du, at.dvv);
    return {(u - dot(u, n) * n) / area, (v - dot(v, n) * n) / area};
}

std::array<Vec3, 2> normal_along(const ChainMirror& mirror, const SurfaceHit& hit) {
    const Surface& surface = *mirror.surface;
    if (mirror.own_normals && dot(cross(hit.point.du, hit.point.dv), hit.point.normal) != 0) {
        SurfacePoint at = hit.point;
        if (!surface.has_closed_form()) {
            const SurfacePoint full = surface.eval(hit.face, hit.uv);
            at.duu = full.duu, at.duv = full.duv, at.dvv = full.dvv;
        }
        return own_normal_along(at);
    }
    std::array<Vec3, 2> along{};
    for (int axis = 0; axis < 2; ++axis) {
        const double most = surface.domain(hit.face) == FaceDomain::kTriangle ? 1 - hit.uv[1 - axis] : 1.0;
        const double step = hit.uv[axis] + kFaceStep > most ? -kFaceStep : kFaceStep;
        Vec2 uv = hit.uv;
        uv[axis] += step;
        along[static_cast<std::size_t>(axis)] =
            (surface.eval_first_order(hit.face, uv).normal - hit.point.normal) / step;
    }
    return along;
}

/// `along` in the surface's tangents at the hit, least squares; zero where they are parallel.
Vec2 in_tangents(const SurfacePoint& at, const Vec3& along) {
    const double uu = dot(at.du, at.du), uv = dot(at.du, at.dv), vv = dot(at.dv, at.dv);
    const double determinant = uu * vv - uv * uv;
    if (!(determinant > 1e-14 * uu * vv)) return Vec2(0);
    const double a = dot(at.du, along), b = dot(at.dv, along);
    return Vec2(vv * a - uv * b, uu * b - uv * a) / determinant;
}

/// Mirrors the ray where it meets the surface.
void mirror_at(const ChainMirror& mirror, const SurfaceHit& hit, ChainRay& of) {
    const Vec3 u = of.ray.direction, &normal = hit.point.normal;
    const double facing = dot(u, normal);
    const std::array<Vec3, 2> turning = normal_along(mirror, hit);
    for (std::size_t k = 0; k < 2; ++k) {
        const Vec3 carried = of.origin_along[k] + hit.t * of.direction_along[k];
        const Vec3 moved = carried - (dot(carried, normal) / facing) * u;
        const Vec2 uv = in_tangents(hit.point, moved);
        const Vec3 turned = uv.x * turning[0] + uv.y * turning[1];
        const Vec3& before = of.direction_along[k];
        of.origin_along[k] = moved;
        of.direction_along[k] =
            before - 2.0 * ((dot(before, normal) + dot(u, turned)) * normal + facing * turned);
    }
    of.way += hit.t;
    of.ray = {hit.point.position, mirrored(u, normal)};
}

/// The point's distance from the ray, at right angles to it.
Vec3 miss_of(const ChainRay& of, const Vec3& point) {
    const Vec3 to = point - of.ray.origin;
    return to - dot(to, of.ray.direction) * of.ray.direction;
}

/// The turns of the eye's direction that take the miss away, to first order; none at a fold.
std::optional<Vec2> step_against(const ChainRay& of, const Vec3& point) {
    const Vec3& u = of.ray.direction;
    const Vec3 x = unit_across(u), y = cross(u, x);
    const Vec3 miss = miss_of(of, point);
    const double far = dot(point - of.ray.origin, u);
    const Vec3 a = of.origin_along[0] + far * of.direction_along[0];
    const Vec3 b = of.origin_along[1] + far * of.direction_along[1];
    const double ax = dot(a, x), ay = dot(a, y), bx = dot(b, x), by = dot(b, y);
    const double determinant = ax * by - bx * ay;
    if (!(std::fabs(determinant) > 1e-14 * (std::fabs(ax * by) + std::fabs(bx * ay)))) return std::nullopt;
    const double mx = dot(miss, x), my = dot(miss, y);
    Vec2 step = Vec2(by * mx - bx * my, ax * my - ay * mx) / determinant;
    const double size = length(step);
    if (!std::isfinite(size)) return std::nullopt;
    if (size > kMostTurn) step *= kMostTurn / size;
    return step;
}

}  // namespace

double ChainRay::ray_scale() const {
    return ray_scale_of(1, std::fabs(triple(ray.direction, direction_along[0], direction_along[1])));
}

std::optional<ChainRay> chain_ray(const MirrorChain& chain, const Vec3& eye_direction) {
    TRILENS_CHECK(!chain.mirrors.empty(), "a chain has a mirror");
    ChainRay of;
    of.eye_direction = normalize_or_zero(eye_direction);
    if (of.eye_direction == Vec3(0)) return std::nullopt;
    of.turn[0] = unit_across(of.eye_direction);
    of.turn[1] = cross(of.eye_direction, of.turn[0]);
    of.direction_along = of.turn;
    of.ray = {chain.eye, of.eye_direction};
    for (std::size_t i = 0; i < chain.mirrors.size(); ++i) {
        const std::optional<SurfaceHit> hit = chain.mirrors[i].tracer->first_hit(of.ray);
        if (!hit || hit->point.normal == Vec3(0) || dot(of.ray.direction, hit->point.normal) == 0)
            return std::nullopt;
        mirror_at(chain.mirrors[i], *hit, of);
        if (i > 0) continue;
        of.first = of.ray.origin;
        of.first_way = of.way;
    }
    return of;
}

std::optional<ChainRay> image_over(const MirrorChain& chain, const Vec3& point, const Vec3& start) {
    std::optional<ChainRay> at = chain_ray(chain, start);
    if (!at) return std::nullopt;
    double miss = length(miss_of(*at, point));
    const auto whole_way = [&] { return at->way + length(point - at->ray.origin); };
    for (int i = 0; i < kMostNewtonSteps && miss > kWayDone * whole_way(); ++i) {
        std::optional<Vec2> step = step_against(*at, point);
        if (!step) return std::nullopt;
        bool nearer = false;
        for (int h = 0; h < kMostHalvings && !nearer; ++h, *step *= 0.5) {
            const auto next =
                chain_ray(chain, at->eye_direction + step->x * at->turn[0] + step->y * at->turn[1]);
            if (!next) continue;
            const double next_miss = length(miss_of(*next, point));
            if (!(next_miss < miss)) continue;
            at = next;
            miss = next_miss;
            nearer = true;
        }
        if (!nearer) break;
    }
    // Rounding ends the search where a bundle is stretched.
    if (!(miss <= 1e3 * kWayDone * whole_way())) return std::nullopt;
    if (dot(point - at->ray.origin, at->ray.direction) < kBehind * whole_way()) return std::nullopt;
    return at;
}

}  // namespace trilens
