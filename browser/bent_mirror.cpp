#include "bent_mirror.h"

#include <cmath>

namespace trilens::browser {
namespace {

/// Bernstein's cubic polynomials at t, and their derivatives.
struct Cubics {
    std::array<double, 4> value, slope;
};

Cubics cubics_at(double t) {
    const double s = 1 - t;
    return {{s * s * s, 3 * s * s * t, 3 * s * t * t, t * t * t},
            {-3 * s * s, 3 * s * (s - 2 * t), 3 * t * (2 * s - t), 3 * t * t}};
}

}  // namespace

SurfacePoint eval(const BentMirror& mirror, const Vec2& uv) {
    const Cubics u = cubics_at(uv.x), v = cubics_at(uv.y);
    double bulge = 0, bulge_u = 0, bulge_v = 0;
    for (std::size_t j = 0; j < 4; ++j)
        for (std::size_t i = 0; i < 4; ++i) {
            const double control = mirror.bulge[4 * j + i];
            bulge += control * u.value[i] * v.value[j];
            bulge_u += control * u.slope[i] * v.value[j];
            bulge_v += control * u.value[i] * v.slope[j];
        }
    const double angle = glm::radians(mirror.turn);
    const Vec3 right(std::cos(angle), 0, -std::sin(angle)), up(0, 1, 0), front = cross(right, up);
    SurfacePoint point;
    point.position = mirror.middle + (uv.x - 0.5) * mirror.width * right + (uv.y - 0.5) * mirror.height * up +
                     bulge * front;
    point.du = mirror.width * right + bulge_u * front;
    point.dv = mirror.height * up + bulge_v * front;
    point.normal = normalize_or_zero(cross(point.du, point.dv));
    return point;
}

SurfaceGrid make_grid(const BentMirror& mirror, int n) {
    SurfaceGrid grid;
    for (int j = 0; j <= n; ++j)
        for (int i = 0; i <= n; ++i) {
            const SurfacePoint point = eval(mirror, {double(i) / n, double(j) / n});
            grid.corner_point.push_back(static_cast<Id>(grid.points.size()));
            grid.points.push_back(point.position);
            grid.corner_normal.push_back(point.normal);
        }
    const auto add = [&](std::array<std::array<int, 2>, 3> places) {
        IdTriple corners;
        std::array<Vec2, 3> uv;
        for (std::size_t k = 0; k < 3; ++k) {
            corners[k] = static_cast<Id>(places[k][1] * (n + 1) + places[k][0]);
            uv[k] = {double(places[k][0]) / n, double(places[k][1]) / n};
        }
        grid.facets.push_back(corners);
        grid.facet_uv.push_back(uv);
        grid.facet_face.push_back(0);
    };
    for (int j = 0; j < n; ++j)
        for (int i = 0; i < n; ++i) {
            add({{{i, j}, {i + 1, j}, {i + 1, j + 1}}});
            add({{{i, j}, {i + 1, j + 1}, {i, j + 1}}});
        }
    return grid;
}

}  // namespace trilens::browser
