// Rooms of radiosity's tests: squares cut into triangles, and closed forms of their form factors.
#pragma once

#include <cmath>
#include <memory>
#include <numbers>
#include <vector>

#include "radiosity/form_factors.h"

namespace trilens_test {

using namespace trilens;

/// Adds an n x n grid of quads, two triangles each; its front is along u x v.
inline void add_square(const Vec3& corner, const Vec3& u, const Vec3& v, int n, TriangleScene& scene) {
    const Id object = scene.object.empty() ? 0 : scene.object.back() + 1;
    const auto first = static_cast<Id>(scene.points.size());
    for (int j = 0; j <= n; ++j)
        for (int i = 0; i <= n; ++i) scene.points.push_back(corner + double(i) / n * u + double(j) / n * v);
    const auto point = [&](int i, int j) { return first + static_cast<Id>(j * (n + 1) + i); };
    Id primitive = 0;
    for (int j = 0; j < n; ++j)
        for (int i = 0; i < n; ++i)
            for (const IdTriple& triangle : {IdTriple{point(i, j), point(i + 1, j), point(i + 1, j + 1)},
                                             IdTriple{point(i, j), point(i + 1, j + 1), point(i, j + 1)}}) {
                scene.triangles.push_back(triangle);
                scene.object.push_back(object);
                scene.primitive.push_back(primitive++);
            }
}

/// The unit cube; its fronts look inward.
inline TriangleScene closed_cube(int n) {
    const Vec3 x(1, 0, 0), y(0, 1, 0), z(0, 0, 1), o(0);
    TriangleScene scene;
    add_square(o, x, y, n, scene);  // fronts: +z, -z, +y, -y, +x, -x
    add_square(z, y, x, n, scene);
    add_square(o, z, x, n, scene);
    add_square(y, x, z, n, scene);
    add_square(o, y, z, n, scene);
    add_square(x, z, y, n, scene);
    return scene;
}

/// Between unit squares that face each other a unit apart. Source: Howell, A Catalog of Radiation Heat
/// Transfer Configuration Factors, C-11.
inline double facing_squares() {
    const double s = std::sqrt(2.0);
    return 2 / std::numbers::pi *
           (std::log(std::sqrt(4.0 / 3)) + 2 * s * std::atan(1 / s) - 2 * std::atan(1.0));
}

/// Between unit squares at right angles with one edge in common. Source: the same, C-14.
inline double square_corner() {
    const double s = std::sqrt(2.0);
    return (2 * std::atan(1.0) - s * std::atan(1 / s) + 0.25 * std::log(0.75)) / std::numbers::pi;
}

/// From the fronts of the first `half` triangles to any side of the others, means by area.
inline double between_halves(const FormFactors& factors, const std::vector<double>& areas, Id half) {
    double exchange = 0, area = 0;
    for (Id t = 0; t < half; ++t) {
        area += areas[t];
        const FormFactorRow row = factors.row(side_of(t, false));
        for (std::size_t k = 0; k < row.side.size(); ++k)
            if (row.side[k] / 2 >= half) exchange += areas[t] * row.factor[k];
    }
    return exchange / area;
}

}  // namespace trilens_test
