// Which of many boxes a ray may meet: Embree's tree and traversal, with what is inside the boxes left to the
// caller.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <type_traits>

#include "base/math/box.h"
#include "base/raymesh/segments.h"
#include "base/util/ids.h"

namespace trilens {

/// Embree's trees over boxes. Embree works in float; here the scene is moved to the origin and scaled to
/// order one, every ray is brought to the scene in double before it is rounded, and boxes are widened by
/// kBoxMargin, so that no box that the double ray meets is missed. Boxes far beyond most others (more than
/// kGroupSpan times as far from the middle of all as half of the boxes are) go into trees of their own, one
/// for each factor of kGroupSpan, so that the margin of the others stays theirs. Thread-safe to read.
class BoxTree {
  public:
    /// `isa`: Embree's instruction set ("sse2" .. "avx512"), or empty for the best.
    /// Boxes are finite and not empty. Throws UsageError on another name, ComputationError where Embree
    /// fails.
    explicit BoxTree(std::span<const Box> boxes, const std::string& isa = "");
    ~BoxTree();
    BoxTree(BoxTree&&) noexcept;
    BoxTree& operator=(BoxTree&&) noexcept;

    /// Calls visitor(box) for every box that the ray meets within [t_min, t_max], some that it just misses,
    /// roughly from near to far in each tree but in no promised order, each once. The visitor returns the t
    /// beyond which boxes no longer matter (minus infinity to stop); what it throws ends the visit and is
    /// thrown on. A ray that is not finite, or has no direction, meets nothing.
    template <typename Visitor>
    void visit(const Ray& ray, double t_min, double t_max, Visitor&& visitor) const {
        static_assert(std::is_invocable_r_v<double, Visitor&, Id>);
        using Plain = std::remove_reference_t<Visitor>;
        const Callback callback = [](void* state, Id box) { return (*static_cast<Plain*>(state))(box); };
        visit_with(ray, {t_min, t_max}, callback, &visitor);
    }

    /// Calls visitor(segment, box) for the boxes that each segment may meet, as above, with the segment's
    /// number, until it returns true: the segments for which it did. What it throws is thrown on.
    template <typename Visitor>
    Segments::Bits find(const Segments& segments, Visitor&& visitor) const {
        static_assert(std::is_invocable_r_v<bool, Visitor&, std::size_t, Id>);
        using Plain = std::remove_reference_t<Visitor>;
        const SegmentCallback callback = [](void* state, std::size_t segment, Id box) -> bool {
            return (*static_cast<Plain*>(state))(segment, box);
        };
        return find_with(segments, callback, &visitor);
    }

  private:
    struct Data;
    struct Interval {
        double t_min, t_max;
    };
    using SegmentCallback = bool (*)(void* state, std::size_t segment, Id box);
    Segments::Bits find_with(const Segments& segments, SegmentCallback callback, void* state) const;
    using Callback = double (*)(void* state, Id box);
    void visit_with(const Ray& ray, const Interval& interval, Callback callback, void* state) const;

    std::unique_ptr<Data> data_;
};

inline constexpr double kGroupSpan = 1024;

/// How much wider boxes are on each side than asked for, as a share of the half diagonal of all boxes of
/// their tree together. A ray rounded to float strays from the double one by at most 2^-25 per component at
/// its start and as much again along its way of at most 2; Embree's own box test adds a few units in the last
/// place: together below 2^-22.
inline constexpr double kBoxMargin = 1.0 / (1 << 20);

// Segments made ready for a tree in float, many side by side.

/// Segments as Embree gets them: local frame, unit direction, started where they reach the scene.
struct LocalSegments {
    alignas(64) float origin[3][Segments::kMost], direction[3][Segments::kMost];
    alignas(64) float length[Segments::kMost];  // not below the true one
    Segments::Bits meets = 0;                   // those that reach the ball around the scene
    Segments::Bits unusual = 0;                 // those with steps whose squares no number holds: left alone
};

/// Brings segments into the frame whose origin is `centre` and whose unit is 1 / scale, where everything lies
/// in a ball of radius 1 about the origin. Good to the roundings that kBoxMargin has room for.
LocalSegments make_local_segments(const Segments& segments, const Vec3& centre, double scale);

/// Segments that may meet the box: all that do, and few that do not. A box that rounding must not cost
/// anything is wider by a few units in the last place of the segments' coordinates.
Segments::Bits may_meet(const Segments& segments, const Box& box);

}  // namespace trilens
