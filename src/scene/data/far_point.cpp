// Medians, which a few far points do not move.
#include "scene/data/far_point.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace trilens {
namespace {

double median(std::vector<double> values) {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

}  // namespace

std::optional<std::size_t> find_far_point(const Cage& cage) {
    std::vector<std::size_t> used(cage.face_vertex_indices.begin(), cage.face_vertex_indices.end());
    std::sort(used.begin(), used.end());
    used.erase(std::unique(used.begin(), used.end()), used.end());
    if (used.empty()) return std::nullopt;

    Vec3 middle;
    for (int k = 0; k < 3; ++k) {
        std::vector<double> values;
        for (const std::size_t i : used) values.push_back(cage.points[i][k]);
        middle[k] = median(std::move(values));
    }
    std::vector<double> distances;
    std::size_t farthest = 0;
    double largest = 0;
    for (const std::size_t i : used) {
        const Vec3 from_middle = glm::abs(cage.points[i] - middle);
        const double distance = std::max({from_middle.x, from_middle.y, from_middle.z});
        if (distance > 0) distances.push_back(distance);
        if (distance > largest) largest = distance, farthest = i;
    }
    if (distances.empty()) return std::nullopt;
    if (largest / median(std::move(distances)) > kFarthestPoint) return farthest;
    return std::nullopt;
}

}  // namespace trilens
