// Facets and their strays, by samples of the surface; a part's at once.
#include "intersect/ray_patches.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include "base/util/check.h"

namespace trilens {
namespace {

// How much wider balls around patches are than rounding needs.
constexpr double kBallRoom = 1.000001;

double largest_part(const Vec3& v) {
    return std::max({std::fabs(v.x), std::fabs(v.y), std::fabs(v.z)});
}

/// Holds the patch with its stray.
PointBall ball_of(const RayPatch& patch) {
    const Box box = box_of(patch);
    PointBall ball{0.5 * (box.low + box.high)};
    for (const Vec3& corner : patch.corner) ball.radius = std::max(ball.radius, length(corner - ball.middle));
    return {ball.middle, kBallRoom * (ball.radius + patch.stray)};
}

}  // namespace

RayPatch make_ray_patch(const Surface& surface, const SurfaceGrid& grid, std::size_t facet) {
    RayPatch patch;
    patch.face = grid.facet_face[facet];
    patch.uv = grid.facet_uv[facet];
    for (int k = 0; k < 3; ++k) patch.corner[k] = grid.points[grid.corner_point[grid.facets[facet][k]]];

    constexpr double third = 1.0 / 3;
    constexpr std::array<std::array<double, 3>, 4> samples{
        {{0.5, 0.5, 0}, {0, 0.5, 0.5}, {0.5, 0, 0.5}, {third, third, third}}};
    for (const auto& [a, b, c] : samples) {
        const Vec3 chord = a * patch.corner[0] + b * patch.corner[1] + c * patch.corner[2];
        const Vec2 uv = a * patch.uv[0] + b * patch.uv[1] + c * patch.uv[2];
        patch.stray =
            std::max(patch.stray, length(surface.eval_first_order(patch.face, uv).position - chord));
    }
    for (int k = 0; k < 3; ++k) {
        const Vec2 edge = glm::abs(patch.uv[k] - patch.uv[(k + 1) % 3]);
        patch.size = std::max(patch.size, length(patch.corner[k] - patch.corner[(k + 1) % 3]));
        patch.reach = std::max({patch.reach, edge.x, edge.y});
    }
    patch.stray = kRayStraySafety * patch.stray + kSurfaceResidual * largest_part(patch.corner[0]);
    return patch;
}

Box box_of(const RayPatch& patch) {
    const auto& [a, b, c] = patch.corner;
    return {glm::min(a, glm::min(b, c)) - patch.stray, glm::max(a, glm::max(b, c)) + patch.stray};
}

const PartPatches::Part& PartPatches::make(Id part) const {
    const SurfaceGrid grid = grid_(part);
    TRILENS_CHECK(grid.facets.size() <= kMostOfPart, "a part has few facets");
    auto made = std::make_unique<Part>();
    const std::size_t count = grid.facets.size();
    made->patches.reserve(count);
    made->balls = PatchBalls(count);
    for (std::size_t f = 0; f < count; ++f) {
        made->patches.push_back(make_ray_patch(surface_, grid, f));
        made->balls.set(f, ball_of(made->patches.back()));
    }
    // Another thread may have made the same meanwhile.
    const Part* known = nullptr;
    if (parts_[part].compare_exchange_strong(known, made.get())) return *made.release();
    return *known;
}

}  // namespace trilens
