// Noise of images near folds, to second order by Gauss-Hermite quadrature.
#include <array>
#include <cmath>
#include <functional>
#include <optional>

#include "inverse/fit/fit_problem.h"

namespace trilens {

double normal_mean_square(const std::function<std::optional<double>(double, double)>& f) {
    const std::array<double, 3> nodes{-std::sqrt(3.0), 0, std::sqrt(3.0)}, weights{1.0 / 6, 2.0 / 3, 1.0 / 6};
    double sum = 0, all = 0;
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t k = 0; k < 3; ++k)
            if (const std::optional<double> value = f(nodes[i], nodes[k])) {
                sum += weights[i] * weights[k] * *value * *value;
                all += weights[i] * weights[k];
            }
    return all > 0 ? sum / all : 0;
}

FastestMotion fastest_motion(const std::array<Vec3, 2>& slope) {
    // The larger eigenvector of slope slope^T, at half the angle of (xx - yy, 2 xy).
    const double xx = dot(slope[0], slope[0]), yy = dot(slope[1], slope[1]), xy = dot(slope[0], slope[1]);
    const double angle = std::atan2(2 * xy, xx - yy) / 2;
    const Vec2 along(std::cos(angle), std::sin(angle));
    return {along, length(along.x * slope[0] + along.y * slope[1])};
}

}  // namespace trilens
