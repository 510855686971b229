#include "intersect/part_tree.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "intersect/box_tree.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "intersect/part_tree.cpp"
#include <hwy/foreach_target.h>
#include "base/math/double_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace trilens::part_lanes {
namespace HWY_NAMESPACE {
using namespace lanes::HWY_NAMESPACE;
namespace hn = hwy::HWY_NAMESPACE;
using Bits = Segments::Bits;

static_assert(Segments::kMost % kWidth == 0);

using FloatTag = hn::CappedTag<float, 16>;
using Float = hn::Vec<FloatTag>;
inline constexpr FloatTag kFloatTag;
inline constexpr std::size_t kFloats = hn::MaxLanes(kFloatTag);
static_assert(Segments::kMost % kFloats == 0);

/// Segments by unit directions and lengths, and once more as the tree's boxes see them.
struct Ways {
    alignas(64) double origin[3][Segments::kMost], direction[3][Segments::kMost];
    alignas(64) double length[Segments::kMost];
    LocalSegments local;
    alignas(64) float inverse[3][Segments::kMost];  // of the local directions
};

HWY_INLINE Vector load_rows(const double (&from)[3][Segments::kMost], std::size_t first) {
    return vector_at(from[0] + first, from[1] + first, from[2] + first);
}
HWY_INLINE void store_rows(const Vector& v, double (&to)[3][Segments::kMost], std::size_t first) {
    hn::Store(v.x, kTag, to[0] + first);
    hn::Store(v.y, kTag, to[1] + first);
    hn::Store(v.z, kTag, to[2] + first);
}
void set_ways(const Segments& segments, Ways& ways) {
    for (std::size_t first = 0; first < segments.count; first += kWidth) {
        const Vector step = load_rows(segments.step, first), from = load_rows(segments.from, first);
        const Number length = hn::Sqrt(dot(step, step));
        store_rows(from, ways.origin, first);
        store_rows(over(step, length), ways.direction, first);
        hn::Store(length, kTag, ways.length + first);
    }
    // Of a number without an inverse, one that is large.
    const Float tiny = hn::Set(kFloatTag, 1e-30f), one = hn::Set(kFloatTag, 1.0f);
    for (std::size_t k = 0; k < 3; ++k)
        for (std::size_t first = 0; first < segments.count; first += kFloats) {
            const Float x = hn::Load(kFloatTag, ways.local.direction[k] + first);
            const Float usual = hn::IfThenElse(hn::Lt(hn::Abs(x), tiny), hn::CopySign(tiny, x), x);
            hn::Store(hn::Div(one, usual), kFloatTag, ways.inverse[k] + first);
        }
}

/// Those of the lanes that come into the box.
HWY_INLINE Bits in_box(const Ways& ways, const PartTree::Node& node, Bits lanes) {
    constexpr Bits kAll = (Bits{1} << kFloats) - 1;
    Bits met = 0;
    for (std::size_t first = 0; first < Segments::kMost; first += kFloats) {
        if ((lanes >> first & kAll) == 0) continue;
        Float enter = hn::Zero(kFloatTag), leave = hn::Load(kFloatTag, ways.local.length + first);
        for (std::size_t k = 0; k < 3; ++k) {
            const Float origin = hn::Load(kFloatTag, ways.local.origin[k] + first),
                        inverse = hn::Load(kFloatTag, ways.inverse[k] + first);
            const Float low = hn::Mul(hn::Sub(hn::Set(kFloatTag, node.low[k]), origin), inverse),
                        high = hn::Mul(hn::Sub(hn::Set(kFloatTag, node.high[k]), origin), inverse);
            enter = hn::Max(enter, hn::Min(low, high));
            leave = hn::Min(leave, hn::Max(low, high));
        }
        std::uint8_t bytes[8] = {};
        hn::StoreMaskBits(kFloatTag, hn::Le(enter, leave), bytes);
        met |= ((bytes[0] | Bits{bytes[1]} << 8) & kAll) << first;
    }
    return met & lanes;
}

struct QuadBits {
    Bits met = 0, missed = 0;  // surely
};

/// A segment's line seen as a point: areas of triangles from it to the quad's sides and diagonals say on
/// which side of each it lies, and how far, in sides' lengths.
HWY_INLINE QuadBits meet_quad_at(const Ways& ways, const PartQuad& quad, std::size_t first) {
    constexpr double kRounding = 1e-14;
    const Vector origin = load_rows(ways.origin, first), way = load_rows(ways.direction, first);
    Vector q[4];
    Number along[4], squares = number(0);
    for (std::size_t k = 0; k < 4; ++k) {
        q[k] = minus(vector(quad.corner[k]), origin);
        along[k] = dot(way, q[k]);
        squares = hn::Add(squares, dot(q[k], q[k]));
    }
    const Number rounding = hn::Mul(number(kRounding), squares);
    Number side[4];
    for (std::size_t k = 0; k < 4; ++k) side[k] = dot(way, cross(q[k], q[(k + 1) % 4]));
    const Number ac = dot(way, cross(q[0], q[2])), bd = dot(way, cross(q[1], q[3]));
    // Twice the areas of the triangle of all corners but one.
    const Number without[4] = {hn::Sub(hn::Add(side[1], side[2]), bd), hn::Add(hn::Add(side[2], side[3]), ac),
                               hn::Add(hn::Add(side[0], side[3]), bd),
                               hn::Sub(hn::Add(side[0], side[1]), ac)};

    Truth left = hn::FirstN(kTag, kWidth), right = left, missed = hn::Not(left);
    for (std::size_t k = 0; k < 4; ++k) {
        const Number inside = hn::Add(number(quad.border * quad.side[k]), rounding),
                     outside = hn::Add(number(quad.stray * quad.side[k]), rounding);
        left = hn::And(left, hn::Gt(side[k], inside));
        right = hn::And(right, hn::Lt(side[k], hn::Neg(inside)));
        // The other two corners lie on one side of side k's line, the segment on the other.
        const Number third = without[(k + 3) % 4], fourth = without[(k + 2) % 4];
        const Truth before = hn::And(hn::Ge(third, rounding), hn::Ge(fourth, rounding)),
                    behind = hn::And(hn::Le(third, hn::Neg(rounding)), hn::Le(fourth, hn::Neg(rounding)));
        missed = hn::Or(missed, hn::And(before, hn::Lt(side[k], hn::Neg(outside))));
        missed = hn::Or(missed, hn::And(behind, hn::Gt(side[k], outside)));
    }
    const Number nearest = hn::Min(hn::Min(along[0], along[1]), hn::Min(along[2], along[3])),
                 farthest = hn::Max(hn::Max(along[0], along[1]), hn::Max(along[2], along[3])),
                 stray = number(quad.stray);
    const Truth on_way = hn::And(hn::Gt(nearest, stray),
                                 hn::Lt(hn::Add(farthest, stray), hn::Load(kTag, ways.length + first)));
    return {bits_of(hn::And(on_way, hn::Or(left, right))), bits_of(missed)};
}

/// Which lanes of a segment's packet are on their way down the tree.
struct Waiting {
    std::size_t node;
    Bits lanes;
};

void find_here(const PartTree::View& tree, const Segments& segments, Bits asked, const PartTree::Quads& quads,
               PartTree::Found& found) {
    Ways ways;
    ways.local = make_local_segments(segments, tree.centre, tree.scale);
    set_ways(segments, ways);
    found.unusual = ways.local.unusual & asked;
    const std::span<const PartTree::Node> nodes = tree.nodes;
    std::array<Waiting, 64> stack;
    std::size_t waiting = 0;
    stack[waiting++] = {0, asked & ways.local.meets};
    while (waiting > 0) {
        const auto [at, before] = stack[--waiting];
        const Bits lanes = in_box(ways, nodes[at], before & ~found.met);
        if (lanes == 0) continue;
        const PartTree::Node& node = nodes[at];
        if (node.part == kNone) {
            const auto lane = static_cast<std::size_t>(std::countr_zero(lanes));
            const bool forward = ways.direction[node.axis][lane] >= 0;
            stack[waiting++] = {forward ? node.right : at + 1, lanes};
            stack[waiting++] = {forward ? at + 1 : node.right, lanes};
            continue;
        }
        const PartQuad& quad = quads.of(quads.state, node.part);
        Bits missed = 0;
        for (std::size_t first = 0; first < Segments::kMost; first += kWidth) {
            if ((lanes >> first & ((1u << kWidth) - 1u)) == 0) continue;
            const QuadBits bits = meet_quad_at(ways, quad, first);
            found.met |= bits.met << first & lanes;
            missed |= bits.missed << first;
        }
        for_each_of(lanes & ~(found.met | missed), [&](std::size_t i) {
            found.open.push_back({static_cast<std::uint32_t>(i), node.part});
        });
    }
}

}  // namespace HWY_NAMESPACE
}  // namespace trilens::part_lanes
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace trilens {
namespace part_lanes {
HWY_EXPORT(find_here);
}  // namespace part_lanes

PartTree::PartTree(std::span<const Box> boxes) {
    if (boxes.empty()) return;
    std::vector<Id> parts(boxes.size());
    Box all;
    for (std::size_t p = 0; p < parts.size(); ++p) parts[p] = static_cast<Id>(p), all.include(boxes[p]);
    const Vec3 half = 0.5 * all.high - 0.5 * all.low;
    const double radius = length(half);
    centre_ = all.low + half;
    if (radius > 0 && std::isfinite(radius)) scale_ = 1 / radius;
    nodes_.reserve(2 * parts.size() - 1);
    add_node(boxes, parts);
}

void PartTree::add_node(std::span<const Box> boxes, std::span<Id> parts) {
    const std::size_t at = nodes_.size();
    nodes_.emplace_back();
    Box box;
    for (const Id part : parts) box.include(boxes[part]);
    for (int k = 0; k < 3; ++k) {
        const auto side = static_cast<std::size_t>(k);
        nodes_[at].low[side] = static_cast<float>((box.low[k] - centre_[k]) * scale_ - kBoxMargin);
        nodes_[at].high[side] = static_cast<float>((box.high[k] - centre_[k]) * scale_ + kBoxMargin);
    }
    if (parts.size() == 1) {
        nodes_[at].part = parts[0];
        return;
    }
    const Vec3 side = box.size();
    const int axis = side.x >= side.y && side.x >= side.z ? 0 : side.y >= side.z ? 1 : 2;
    const auto place = [&](Id part) { return boxes[part].low[axis] + boxes[part].high[axis]; };
    const std::size_t half = parts.size() / 2;
    std::nth_element(parts.begin(), parts.begin() + static_cast<std::ptrdiff_t>(half), parts.end(),
                     [&](Id a, Id b) { return place(a) != place(b) ? place(a) < place(b) : a < b; });
    nodes_[at].axis = axis;
    add_node(boxes, parts.first(half));
    nodes_[at].right = static_cast<std::uint32_t>(nodes_.size());
    add_node(boxes, parts.subspan(half));
}

PartTree::Found PartTree::find_with(const Segments& segments, Segments::Bits asked,
                                    const Quads& quads) const {
    Found found;
    if (nodes_.empty() || asked == 0) return found;
    using namespace part_lanes;
    HWY_DYNAMIC_DISPATCH(find_here)({nodes_, centre_, scale_}, segments, asked, quads, found);
    return found;
}

}  // namespace trilens
#endif
