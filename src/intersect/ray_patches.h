// The facets that a ray is held against before the surface itself is asked, each with how far the surface
// strays from it; of a surface's parts they are made when a ray first comes near.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <utility>
#include <vector>

#include "base/math/box.h"
#include "base/raymesh/surface.h"
#include "intersect/patch_tree.h"

namespace trilens {

// How many times farther than at the samples the surface may stray from a facet. A quadratic patch strays 4/3
// as far inside a facet as at the middles of its edges; the rest is for terms of higher order.
inline constexpr double kRayStraySafety = 2;

/// A facet of the fine grid with the patch of surface that it stands for.
struct RayPatch {
    std::array<Vec3, 3> corner;
    double stray = 0;  // the surface lies within this distance of the facet
    double size = 0;   // longest edge
    std::array<Vec2, 3> uv;
    Id face = kNone;
    double reach = 0;  // largest extent in u or v
};

/// Of that facet of a grid of the surface, by samples of the surface.
RayPatch make_ray_patch(const Surface& surface, const SurfaceGrid& grid, std::size_t facet);

/// Holds the facet and what strays from it.
Box box_of(const RayPatch& patch);

/// The patches of all parts of a surface, each part's made when they are first asked for. Thread-safe.
class PartPatches {
  public:
    /// grid: of at most kMostOfPart facets; `surface` must live longer.
    PartPatches(const Surface& surface, std::size_t parts, std::function<SurfaceGrid(Id part)> grid)
        : surface_(surface), grid_(std::move(grid)), parts_(parts) {}
    PartPatches(const PartPatches&) = delete;
    PartPatches& operator=(const PartPatches&) = delete;
    ~PartPatches() {
        for (const auto& part : parts_) delete part.load();
    }

    static constexpr Id kMostOfPart = 64;
    struct Part {
        std::vector<RayPatch> patches;
        // A ball around each patch with its stray: all middles' x, all y, all z, all squares of radii.
        std::vector<double> balls;

        /// A bit per patch: whether the ray's line comes into its ball.
        std::uint64_t may_meet(const RayFrame& frame) const {
            // In two loops, so that the compiler makes vectors of the first.
            std::array<double, kMostOfPart> beyond;
            const std::size_t count = patches.size();
            const double *const middle_x = balls.data(), *const middle_y = middle_x + count,
                                *const middle_z = middle_y + count, *const square = middle_z + count;
            for (std::size_t i = 0; i < count; ++i) {
                const double a = middle_x[i] - frame.origin.x, b = middle_y[i] - frame.origin.y,
                             c = middle_z[i] - frame.origin.z;
                const double x = frame.x.x * a + frame.x.y * b + frame.x.z * c,
                             y = frame.y.x * a + frame.y.y * b + frame.y.z * c;
                beyond[i] = x * x + y * y - square[i];
            }
            std::uint64_t found = 0;
            for (std::size_t i = 0; i < count; ++i) found |= std::uint64_t{beyond[i] <= 0} << i;
            return found;
        }
    };

    const Part& of(Id part) const {
        const Part* const known = parts_[part].load(std::memory_order_acquire);
        return known ? *known : make(part);
    }

    /// Of the numbers of patches, which are those of a part and then those of the next: part and place in it.
    static Id number(Id part, std::size_t patch) { return part * kMostOfPart + static_cast<Id>(patch); }
    const RayPatch& patch(Id number) const { return of(number / kMostOfPart).patches[number % kMostOfPart]; }

  private:
    const Part& make(Id part) const;

    const Surface& surface_;
    std::function<SurfaceGrid(Id part)> grid_;
    mutable std::vector<std::atomic<const Part*>> parts_;
};

}  // namespace trilens
