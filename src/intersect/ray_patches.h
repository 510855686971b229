// The facets that a ray is held against before the surface itself is asked, each with how far the surface
// strays from it; of a surface's parts they are made when a ray first comes near.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <span>
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
    float bend = 0;    // the surface lies within this share of the size of the facet's plane
    double reach = 0;  // largest extent in u or v
};

/// Of that facet of a grid of the surface, by samples of the surface.
RayPatch make_ray_patch(const Surface& surface, const SurfaceGrid& grid, std::size_t facet);

/// Of the facet, unit; zero where it has none.
Vec3 chord_normal(const RayPatch& patch);

/// Holds the facet and what strays from it.
Box box_of(const RayPatch& patch);
/// Of a surface, by the bounds of its faces' parts; all of space where it has none.
Box box_of(const Surface& surface);

/// A ball around each of some patches with its stray, many side by side: the middles' x, y and z, and the
/// squares of radii. Rows are as long as lanes need; beyond the last ball squares are below zero.
class PatchBalls {
  public:
    static constexpr std::size_t kMost = 64, kWidest = 8;

    PatchBalls() = default;
    explicit PatchBalls(std::size_t count)
        : count_(count), stride_((count + kWidest - 1) / kWidest * kWidest), rows_(kRows * stride_, -1.0) {}

    void set(std::size_t number, const PointBall& ball) {
        for (int k = 0; k < 3; ++k) rows_[static_cast<std::size_t>(k) * stride_ + number] = ball.middle[k];
        rows_[3 * stride_ + number] = ball.radius * ball.radius;
    }
    std::size_t count() const { return count_; }
    const double* row(std::size_t number) const { return rows_.data() + number * stride_; }

  private:
    static constexpr std::size_t kRows = 4;
    std::size_t count_ = 0, stride_ = 0;
    std::vector<double> rows_;
};

// A part of a face as a whole: the quad between its corners, its outline, and how far it strays from both.

/// Of a rectangle of a face's parameters. Infinite strays say nothing.
struct PartQuad {
    static constexpr std::size_t kSides = 4;

    std::array<Vec3, kSides> corner{};  // in turn; side k runs from corner k to the next
    std::array<double, kSides> side{};  // lengths
    // Each side of the part's border lies within this distance of the quad's.
    double border = std::numeric_limits<double>::infinity();
    // The part lies within this distance of the corners' hull.
    double stray = std::numeric_limits<double>::infinity();

    std::vector<Vec3> outline;  // the border's corners of facets, in turn; none where nothing is known
    double outline_stray = 0;   // the border lies within this distance of the outline
};

/// Of all of its facets; says nothing where they are no whole rectangle of one face's parameters.
PartQuad make_part_quad(std::span<const RayPatch> patches);

/// Whether the part is surely met, and nowhere but between these distances along the ray: its outline goes
/// around the ray, and farther from it than the border strays.
bool surely_meets(const PartQuad& quad, const RayFrame& frame, double from, double to);

/// A stretch of a ray, by distances along it.
struct RayStretch {
    Vec3 origin{0}, direction{0};  // unit
    double from = 0, to = 0;
};

/// A bit per ball: whether the stretch comes into it.
std::uint64_t balls_met(const PatchBalls& balls, const RayStretch& ray);

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

    static constexpr Id kMostOfPart = PatchBalls::kMost;
    struct Part {
        std::vector<RayPatch> patches;
        PatchBalls balls;
        PartQuad quad;
    };

    const Part& of(Id part) const {
        const Part* const known = parts_[part].load(std::memory_order_acquire);
        return known ? *known : make(part);
    }

    /// Of the numbers of patches, which are those of a part and then those of the next: part and place in it.
    static Id number(Id part, std::size_t patch) { return part * kMostOfPart + static_cast<Id>(patch); }
    static Id part_of(Id number) { return number / kMostOfPart; }
    const RayPatch& patch(Id number) const { return of(part_of(number)).patches[number % kMostOfPart]; }

  private:
    const Part& make(Id part) const;

    const Surface& surface_;
    std::function<SurfaceGrid(Id part)> grid_;
    mutable std::vector<std::atomic<const Part*>> parts_;
};

}  // namespace trilens
