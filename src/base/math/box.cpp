#include "base/math/box.h"

#include <algorithm>
#include <utility>

#include "base/util/check.h"

namespace trilens {
namespace {

std::pair<Vec3, Vec3> box_around(std::span<const Vec3> points, std::span<const std::size_t> some) {
    TRILENS_CHECK(!some.empty(), "no points have no box");
    std::pair<Vec3, Vec3> box{points[some.front()], points[some.front()]};
    for (const std::size_t p : some) {
        box.first = glm::min(box.first, points[p]);
        box.second = glm::max(box.second, points[p]);
    }
    return box;
}

}  // namespace

PointBall ball_around(std::span<const Vec3> points, std::span<const std::size_t> some) {
    const auto [low, high] = box_around(points, some);
    // What rounding takes away is given back by the share.
    const Vec3 middle = low + 0.5 * (high - low);
    return {middle, length(glm::max(high - middle, middle - low)) * (1 + 1e-14)};
}

std::size_t spatial_split(std::span<const Vec3> points, std::span<std::size_t> some, std::size_t unit) {
    TRILENS_CHECK(unit > 0 && some.size() > unit, "there is a first half and a second");
    const auto [low, high] = box_around(points, some);
    const Vec3 size = high - low;
    const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    const int next = (axis + 1) % 3, last = (axis + 2) % 3;
    const auto is_before = [&](std::size_t a, std::size_t b) {
        const Vec3 &p = points[a], &q = points[b];
        if (p[axis] != q[axis]) return p[axis] < q[axis];
        return p[next] != q[next] ? p[next] < q[next] : p[last] < q[last];
    };
    const std::size_t half = std::max(some.size() / 2 / unit, std::size_t{1}) * unit;
    std::nth_element(some.begin(), some.begin() + static_cast<std::ptrdiff_t>(half), some.end(), is_before);
    return half;
}

}  // namespace trilens
