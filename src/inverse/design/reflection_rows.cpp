#include "inverse/design/reflection_rows.h"

#include <algorithm>
#include <cmath>

#include "reflect/reflection.h"

namespace trilens {

std::vector<Vec2> patch_samples(const Vec2& size, const std::array<int, 2>& counts) {
    std::vector<Vec2> samples;
    for (int row = 0; row < counts[1]; ++row)
        for (int column = 0; column < counts[0]; ++column)
            samples.push_back((Vec2(column + 0.5, row + 0.5) / Vec2(counts[0], counts[1]) - 0.5) * size);
    return samples;
}

NeededSlopes needed_slopes(const WishedRays& wish, const Vec3& place) {
    const Vec3 normal = normalize(wish.eye() - place) + wish.wanted(place);
    if (!(normal.z > 1e-6)) return {Vec2(0), false};
    return {Vec2(-normal.x, -normal.y) / normal.z, true};
}

Vec3 ray_residual(const WishedRays& wish, const Vec2& at, const Height& h) {
    const Vec3 place(at, h.z), normal = normalize(Vec3(-h.x, -h.y, 1));
    return mirrored(normalize(place - wish.eye()), normal) - wish.wanted(place);
}

RayRows ray_rows(const WishedRays& wish, const Vec2& at, const Height& h, double length_scale) {
    const Vec3 place(at, h.z), up(-h.x, -h.y, 1), u = normalize(up), from_eye = place - wish.eye();
    const Vec3 d = normalize(from_eye);
    RayRows rows;
    rows.residual = ray_residual(wish, at, h);
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
