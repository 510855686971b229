#include "measure/field/field_pyramid.h"

#include <bit>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "measure/field/pyramid_query.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace trilens::descent {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Tag = hn::CappedTag<float, 16>;
using Number = hn::Vec<Tag>;
using Truth = hn::Mask<Tag>;
constexpr Tag kTag;
constexpr std::size_t kWidth = hn::MaxLanes(kTag);
constexpr std::uint64_t kAll = (1ull << kWidth) - 1;
static_assert(FieldPointPacket::kPoints % kWidth == 0);

HWY_INLINE Number number(float x) {
    return hn::Set(kTag, x);
}
HWY_INLINE std::uint64_t bits_of(Truth truth) {
    std::uint8_t bytes[8] = {};
    hn::StoreMaskBits(kTag, truth, bytes);
    std::uint64_t bits = 0;
    for (std::size_t i = 0; i < (kWidth + 7) / 8; ++i) bits |= static_cast<std::uint64_t>(bytes[i]) << 8 * i;
    return bits;
}

/// Some lanes of a packet.
struct Points {
    Number point[3], column, row, most;
};
HWY_INLINE Points points_at(const FieldPointPacket& packet, std::size_t first) {
    const auto load = [&](const float* from) { return hn::Load(kTag, from + first); };
    return {{load(packet.point[0]), load(packet.point[1]), load(packet.point[2])},
            load(packet.pixel[0]),
            load(packet.pixel[1]),
            load(packet.most)};
}

/// A group of cells on the screen: its place, and whole pixels from (column, row) on.
struct Square {
    int level, column, row;
    std::uint64_t points;

    float x() const { return static_cast<float>((column << level) - 1); }
    float y() const { return static_cast<float>((row << level) - 1); }
    float size() const { return static_cast<float>(1 << level); }
};

/// How far outside first .. last, or 0.
HWY_INLINE Number away(Number at, float first, float last) {
    return hn::Max(hn::Max(hn::Sub(number(first), at), hn::Sub(at, number(last))), hn::Zero(kTag));
}

/// The lanes whose points the box holds, near enough to the square.
HWY_INLINE Truth held(const Points& points, const BoxQuad& quad, int child, const Square& square) {
    Truth inside = hn::FirstN(kTag, kWidth);
    for (int k = 0; k < 3; ++k)
        inside = hn::And(inside, hn::And(hn::Le(number(quad.low[k][child]), points.point[k]),
                                         hn::Le(points.point[k], number(quad.high[k][child]))));
    const Number dx = away(points.column, square.x(), square.x() + square.size()),
                 dy = away(points.row, square.y(), square.y() + square.size());
    return hn::And(inside, hn::Le(hn::Add(hn::Mul(dx, dx), hn::Mul(dy, dy)), points.most));
}

void find_cells_here(const FieldPyramid& index, const FieldPointPacket& packet,
                     std::vector<CellOfMany>& cells) {
    const std::uint64_t all = packet.count == FieldPointPacket::kPoints ? ~0ull : (1ull << packet.count) - 1;
    Square stack[4 * 32];  // four children per level, and fewer than 32 levels
    std::size_t count = 0;
    stack[count++] = {static_cast<int>(index.levels.size()), 0, 0, all};
    while (count > 0) {
        const Square from = stack[--count];
        if (from.level == 0) {
            cells.push_back({from.column - 1, from.row - 1, from.points});
            continue;
        }
        const BoxQuad& quad =
            index.levels[static_cast<std::size_t>(from.level - 1)].at(from.column, from.row);
        Square children[4];
        for (int child = 0; child < 4; ++child)
            children[child] = {from.level - 1, 2 * from.column + child % 2, 2 * from.row + child / 2, 0};
        for (std::size_t first = 0; first < packet.count; first += kWidth) {
            const std::uint64_t asked = from.points >> first & kAll;
            if (!asked) continue;
            const Points points = points_at(packet, first);
            for (int child = 0; child < 4; ++child)
                children[child].points |= (bits_of(held(points, quad, child, children[child])) & asked)
                                          << first;
        }
        for (const Square& child : children)
            if (child.points) stack[count++] = child;
    }
}

std::uint64_t held_by_here(const FieldCellBounds& reach, const FieldPointPacket& packet,
                           std::uint64_t asked) {
    // More than the products round by.
    const Number error_bound = number(4e-7F), least = number(1e-37F);
    std::uint64_t held = 0;
    for (std::size_t first = 0; first < packet.count; first += kWidth) {
        if (!(asked >> first & kAll)) continue;
        const Points points = points_at(packet, first);
        Truth inside = hn::FirstN(kTag, kWidth);
        for (int k = 0; k < 3; ++k)
            inside = hn::And(inside, hn::And(hn::Le(number(reach.low[k]), points.point[k]),
                                             hn::Le(points.point[k], number(reach.high[k]))));
        for (const FieldCellBounds::Slab& slab : reach.slabs) {
            const Number x = hn::Mul(number(slab.direction[0]), points.point[0]),
                         y = hn::Mul(number(slab.direction[1]), points.point[1]),
                         z = hn::Mul(number(slab.direction[2]), points.point[2]);
            const Number at = hn::Add(hn::Add(x, y), z),
                         size = hn::Add(hn::Add(hn::Abs(x), hn::Abs(y)), hn::Abs(z)),
                         margin = hn::Add(hn::Mul(error_bound, size), least);
            // What is no number is not outside.
            const Truth outside = hn::Or(hn::Lt(hn::Add(at, margin), number(slab.low)),
                                         hn::Gt(hn::Sub(at, margin), number(slab.high)));
            inside = hn::AndNot(outside, inside);
        }
        held |= bits_of(inside) << first;
    }
    return held & asked;
}

}  // namespace HWY_NAMESPACE
}  // namespace trilens::descent
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace trilens {
namespace descent {
HWY_EXPORT(find_cells_here);
HWY_EXPORT(held_by_here);
}  // namespace descent

void FieldPointPacket::add(const FieldSample& wanted, double squared_reach) {
    for (int k = 0; k < 3; ++k) point[k][count] = static_cast<float>(wanted.point[k]);
    pixel[0][count] = static_cast<float>(wanted.column);
    pixel[1][count] = static_cast<float>(wanted.row);
    // Squared distances as floats round by less.
    most[count] = static_cast<float>(squared_reach * (1 + 1e-6));
    ++count;
}

void find_cells(const FieldPyramid& index, const FieldPointPacket& packet, std::vector<CellOfMany>& cells) {
    using namespace descent;
    HWY_DYNAMIC_DISPATCH(find_cells_here)(index, packet, cells);
}

std::uint64_t held_by(const FieldCellBounds& reach, const FieldPointPacket& packet, std::uint64_t points) {
    using namespace descent;
    return HWY_DYNAMIC_DISPATCH(held_by_here)(reach, packet, points);
}

}  // namespace trilens
#endif
