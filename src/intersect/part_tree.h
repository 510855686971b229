// The parts of a surface in a tree of boxes, for segments side by side: which of them surely meet a part as a
// whole, and which may meet it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>
#include <vector>

#include "base/math/box.h"
#include "base/raymesh/segments.h"
#include "base/util/ids.h"
#include "intersect/ray_patches.h"

namespace trilens {

/// What is told of a segment does not depend on those beside it. Thread-safe to read.
class PartTree {
  public:
    /// Boxes are finite and not empty.
    explicit PartTree(std::span<const Box> boxes);

    /// A segment that may meet a part.
    struct Open {
        std::uint32_t segment;
        Id part;
    };
    struct Found {
        Segments::Bits met = 0;      // surely meet a part
        Segments::Bits unusual = 0;  // with steps whose squares no number holds: nothing is told of them
        std::vector<Open> open;      // of the others, all that may be met: few are not
    };
    /// For those of the segments that are asked. quad(part): of that part, whose box a segment meets.
    template <typename Quad>
    Found find(const Segments& segments, Segments::Bits asked, Quad&& quad) const {
        static_assert(std::is_invocable_r_v<const PartQuad&, Quad&, Id>);
        using Plain = std::remove_reference_t<Quad>;
        const QuadOf quad_of = [](void* state, Id part) -> const PartQuad& {
            return (*static_cast<Plain*>(state))(part);
        };
        return find_with(segments, asked, {quad_of, &quad});
    }

    /// In the frame of LocalSegments.
    struct Node {
        std::array<float, 3> low{}, high{};
        Id part = kNone;          // kNone: an inner node, whose left child is the next one
        std::uint32_t right = 0;  // its other child
        int axis = 0;             // along which the left child comes before the right one
    };
    struct View {
        std::span<const Node> nodes;
        Vec3 centre{0};
        double scale = 1;  // from the world to the nodes' frame
    };
    using QuadOf = const PartQuad& (*)(void* state, Id part);
    struct Quads {
        QuadOf of;
        void* state;
    };

  private:
    Found find_with(const Segments& segments, Segments::Bits asked, const Quads& quads) const;
    void add_node(std::span<const Box> boxes, std::span<Id> parts);

    std::vector<Node> nodes_;
    Vec3 centre_{0};
    double scale_ = 1;  // from the world to the nodes' frame
};

}  // namespace trilens
