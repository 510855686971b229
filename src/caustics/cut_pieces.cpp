// What a square cuts out of flat triangles: areas and centroids by Green's theorem along clamped edges, many
// triangles side by side.
#include "caustics/curved_beam.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "caustics/cut_pieces.cpp"
#include <hwy/foreach_target.h>
#include "base/math/double_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace trilens::piece_lanes {
namespace HWY_NAMESPACE {
using namespace lanes::HWY_NAMESPACE;
namespace hn = hwy::HWY_NAMESPACE;

static_assert(CutPieces::kMost % kWidth == 0);

struct Place {
    Number x, y;
};
HWY_INLINE Place minus(const Place& a, const Place& b) {
    return {hn::Sub(a.x, b.x), hn::Sub(a.y, b.y)};
}
HWY_INLINE Number cross(const Place& a, const Place& b) {
    return hn::Sub(hn::Mul(a.x, b.y), hn::Mul(a.y, b.x));
}
HWY_INLINE Number between(Number x, Number low, Number high) {
    return hn::Min(hn::Max(x, low), high);
}
/// a / b, 0 where b is.
HWY_INLINE Number ratio(Number a, Number b) {
    return hn::IfThenElseZero(hn::Ne(b, number(0)), hn::Div(a, b));
}

/// Integrals below a boundary: of 2, of 6 x and of 6 y over the area between it and y = 0.
struct Below {
    Number area, x, y;

    /// The boundary goes straight from one place to another.
    HWY_INLINE void add(const Place& from, const Place& to) {
        const Number wide = hn::Sub(to.x, from.x), sum = hn::Add(from.y, to.y);
        area = hn::Add(area, hn::Mul(wide, sum));
        const Number along =
            hn::Add(hn::Mul(from.x, hn::Add(from.y, sum)), hn::Mul(to.x, hn::Add(to.y, sum)));
        x = hn::Add(x, hn::Mul(wide, along));
        const Number squares = hn::Add(hn::Mul(from.y, sum), hn::Mul(to.y, to.y));
        y = hn::Add(y, hn::Mul(wide, squares));
    }
};

struct Square {
    Place low, high;
};

/// The length of {y : below it} that lies in the square is y clamped to it, over x clamped to it: the edge
/// becomes three, of which the first and the last run along the square's sides.
HWY_INLINE void add_edge(const Place& a, const Place& b, const Square& square, Below& below) {
    const Place way = minus(b, a);
    const Number slope = ratio(way.y, way.x);
    Place from{between(a.x, square.low.x, square.high.x), a.y},
        to{between(b.x, square.low.x, square.high.x), b.y};
    from.y = hn::Add(a.y, hn::Mul(hn::Sub(from.x, a.x), slope));
    to.y = hn::Add(b.y, hn::Mul(hn::Sub(to.x, b.x), slope));
    const Number per_rise = ratio(hn::Sub(to.x, from.x), hn::Sub(to.y, from.y));
    const Number left = hn::Min(from.x, to.x), right = hn::Max(from.x, to.x);
    const Place first{from.x, between(from.y, square.low.y, square.high.y)},
        last{to.x, between(to.y, square.low.y, square.high.y)};
    const Place enters{between(hn::Add(from.x, hn::Mul(hn::Sub(first.y, from.y), per_rise)), left, right),
                       first.y},
        leaves{between(hn::Add(to.x, hn::Mul(hn::Sub(last.y, to.y), per_rise)), left, right), last.y};
    below.add(first, enters);
    below.add(enters, leaves);
    below.add(leaves, last);
}

/// Whether a line along one of its sides, or of the square's, parts a triangle from the square of that half
/// side.
HWY_INLINE Truth are_apart(const Place (&at)[3], Number half) {
    const auto all = [&](const auto& is_beyond) {
        return hn::And(hn::And(is_beyond(at[0]), is_beyond(at[1])), is_beyond(at[2]));
    };
    const Number other = hn::Neg(half);
    Truth apart = hn::Or(hn::Or(all([&](const Place& p) { return hn::Gt(p.x, half); }),
                                all([&](const Place& p) { return hn::Lt(p.x, other); })),
                         hn::Or(all([&](const Place& p) { return hn::Gt(p.y, half); }),
                                all([&](const Place& p) { return hn::Lt(p.y, other); })));
    for (int k = 0; k < 3; ++k) {
        const Place &a = at[k], &b = at[(k + 1) % 3], &c = at[(k + 2) % 3];
        const Place side = minus(b, a);
        const Number reach = hn::Mul(half, hn::Add(hn::Abs(side.x), hn::Abs(side.y)));
        const Number on = cross(side, a), across = cross(side, c);
        apart = hn::Or(
            apart, hn::Or(hn::Gt(hn::Min(on, across), reach), hn::Lt(hn::Max(on, across), hn::Neg(reach))));
    }
    return apart;
}

HWY_INLINE Number share_of_one(Number x) {
    return between(x, number(0), number(1));
}

void cut_here(const std::array<Vec2, 6>& curve, const PieceGrid& grid, CutPieces& cut) {
    const Number half = number(0.5), zero = number(0), one = number(1);
    for (std::size_t first = 0; first < grid.pieces; first += kWidth) {
        Place at[3];
        for (std::size_t k = 0; k < 3; ++k) {
            at[k] = {zero, zero};
            for (std::size_t c = 0; c < 6; ++c) {
                const Number weight = hn::Load(kTag, grid.of_piece[k][c] + first);
                at[k].x = hn::Add(at[k].x, hn::Mul(weight, number(curve[c].x)));
                at[k].y = hn::Add(at[k].y, hn::Mul(weight, number(curve[c].y)));
            }
        }
        const Truth apart = are_apart(at, half);
        if (hn::AllTrue(kTag, apart)) {
            hn::Store(zero, kTag, cut.share + first);
            continue;
        }
        Truth inside = hn::Le(hn::Abs(at[0].x), half);
        for (const Place& place : at)
            inside = hn::And(inside, hn::And(hn::Le(hn::Abs(place.x), half), hn::Le(hn::Abs(place.y), half)));

        // About a place of the square as near to the triangle as its first corner, so that what is small
        // keeps its digits.
        const Place about{between(at[0].x, hn::Neg(half), half), between(at[0].y, hn::Neg(half), half)};
        const Square square{{hn::Sub(hn::Neg(half), about.x), hn::Sub(hn::Neg(half), about.y)},
                            {hn::Sub(half, about.x), hn::Sub(half, about.y)}};
        Place off[3];
        for (int k = 0; k < 3; ++k) off[k] = minus(at[k], about);
        Below below{zero, zero, zero};
        for (int k = 0; k < 3; ++k) add_edge(off[k], off[(k + 1) % 3], square, below);
        const Number twice_area = cross(minus(at[1], at[0]), minus(at[2], at[0]));
        const Number share = hn::Div(hn::Neg(below.area), twice_area);
        const Truth meets = hn::AndNot(apart, hn::Gt(share, zero));
        const Number thrice = hn::Mul(number(3), below.area);
        const Place middle{hn::Div(below.x, thrice), hn::Div(below.y, thrice)};

        const Number third = number(1.0 / 3);
        hn::Store(hn::IfThenElse(inside, one, hn::IfThenElseZero(meets, hn::Min(share, one))), kTag,
                  cut.share + first);
        for (std::size_t k = 0; k < 3; ++k) {
            const Place b = minus(off[(k + 1) % 3], middle), c = minus(off[(k + 2) % 3], middle);
            const Number weight = share_of_one(hn::Div(cross(b, c), twice_area));
            hn::Store(hn::IfThenElse(inside, third, weight), kTag, cut.weight[k] + first);
        }
    }
}

}  // namespace HWY_NAMESPACE
}  // namespace trilens::piece_lanes
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace trilens {
namespace piece_lanes {
HWY_EXPORT(cut_here);
}  // namespace piece_lanes

void cut_pieces(const std::array<Vec2, 6>& at, int sides, CutPieces& cut) {
    using namespace piece_lanes;
    const PieceGrid& grid = PieceGrid::of(sides);
    cut.count = grid.pieces;
    HWY_DYNAMIC_DISPATCH(cut_here)(at, grid, cut);
}

}  // namespace trilens
#endif
