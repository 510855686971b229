// Where samples' rays pass the triangles that they surely meet: what place() gives, bit for bit, in lanes.
// Included once per instruction set.
#if defined(TRILENS_KERNEL_PLACE_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef TRILENS_KERNEL_PLACE_INL_H
#undef TRILENS_KERNEL_PLACE_INL_H
#else
#define TRILENS_KERNEL_PLACE_INL_H
#endif

#include <algorithm>
#include <cstring>
#include <limits>

#include "projector/kernel_setup-inl.h"
#include "projector/place.h"

HWY_BEFORE_NAMESPACE();
namespace trilens {
namespace HWY_NAMESPACE {

// Every operation rounds as place() rounds it: no fused multiply-add.

HWY_INLINE Vector3 set3(const Vec3& v) {
    return {hn::Set(kDouble, v.x), hn::Set(kDouble, v.y), hn::Set(kDouble, v.z)};
}
HWY_INLINE Double exact_inner(const Vector3& a, const Vector3& b) {
    return hn::Add(hn::Add(hn::Mul(a.x, b.x), hn::Mul(a.y, b.y)), hn::Mul(a.z, b.z));
}
HWY_INLINE Vector3 exact_outer(const Vector3& a, const Vector3& b) {
    return {hn::Sub(hn::Mul(a.y, b.z), hn::Mul(b.y, a.z)), hn::Sub(hn::Mul(a.z, b.x), hn::Mul(b.z, a.x)),
            hn::Sub(hn::Mul(a.x, b.y), hn::Mul(b.x, a.y))};
}
HWY_INLINE Double largest_part(const Vector3& v) {
    return hn::Max(hn::Abs(v.x), hn::Max(hn::Abs(v.y), hn::Abs(v.z)));
}

/// PlaceForms of one triangle per lane.
struct FormLanes {
    Double above[3], along[3], second[6], third[6], size;
};

HWY_INLINE FormLanes broadcast(const CachedForms& forms) {
    FormLanes f;
    for (std::size_t k = 0; k < 3; ++k) {
        f.above[k] = hn::Set(kDouble, forms.above[k]);
        f.along[k] = hn::Set(kDouble, forms.along[k]);
    }
    for (std::size_t k = 0; k < 6; ++k) {
        f.second[k] = hn::Set(kDouble, forms.second[k]);
        f.third[k] = hn::Set(kDouble, forms.third[k]);
    }
    f.size = hn::Set(kDouble, forms.size);
    return f;
}

HWY_NOINLINE void set_facet(const FacetRays& facet, FacetCoefficients& to) {
    std::memset(&to, 0, sizeof to);
    for (int a = 0; a < 3; ++a) {
        for (std::size_t k = 0; k < 3; ++k) {
            to.origin[a][k] = facet.rays.origin[k][a];
            to.direction[a][k] = facet.rays.direction[k][a];
            to.weight[k] = facet.rays.weight[k];
        }
        for (std::size_t k = 0; k < 6; ++k) {
            to.line[a][k] = facet.line.direction[k][a];
            to.moment[a][k] = facet.line.moment[k][a];
        }
    }
}

HWY_INLINE Vector3 load8(const double (*from)[8], std::size_t at) {
    return {hn::Load(kDouble, from[0] + at), hn::Load(kDouble, from[1] + at),
            hn::Load(kDouble, from[2] + at)};
}

/// place_forms() for one triangle, lanes are coefficients.
HWY_INLINE void make_forms(const FacetCoefficients& facet, const Vec3* corner, CachedForms& forms) {
    const Vec3 e1 = corner[1] - corner[0], e2 = corner[2] - corner[0];
    const Vector3 first = set3(corner[0]), along_e1 = set3(e1), turned = set3(corner[0] - corner[2]),
                  normal = set3(cross(e1, e2));
    for (std::size_t at = 0; at < 8; at += kDoubles) {
        const Vector3 moment = minus(load8(facet.moment, at), exact_outer(first, load8(facet.line, at)));
        hn::Store(exact_inner(turned, moment), kDouble, forms.second + at);
        hn::Store(exact_inner(along_e1, moment), kDouble, forms.third + at);
        if (at >= 3) continue;
        const Vector3 from =
            minus(times(hn::Load(kDouble, facet.weight + at), first), load8(facet.origin, at));
        hn::Store(exact_inner(from, normal), kDouble, forms.above + at);
        hn::Store(exact_inner(load8(facet.direction, at), normal), kDouble, forms.along + at);
    }
    forms.size = trilens::largest_part(e1) * trilens::largest_part(e2);
}

/// place_forms() in lanes.
HWY_INLINE FormLanes forms_in_lanes(const FacetRays& facet, const Vector3 (&corner)[3]) {
    const Vector3 e1 = minus(corner[1], corner[0]), e2 = minus(corner[2], corner[0]),
                  turned = minus(corner[0], corner[2]);
    const Vector3 normal = exact_outer(e1, e2);
    FormLanes forms;
    for (std::size_t k = 0; k < 3; ++k) {
        forms.above[k] = exact_inner(
            minus(times(hn::Set(kDouble, facet.rays.weight[k]), corner[0]), set3(facet.rays.origin[k])),
            normal);
        forms.along[k] = exact_inner(set3(facet.rays.direction[k]), normal);
    }
    for (std::size_t k = 0; k < 6; ++k) {
        const Vector3 moment =
            minus(set3(facet.line.moment[k]), exact_outer(corner[0], set3(facet.line.direction[k])));
        forms.second[k] = exact_inner(turned, moment);
        forms.third[k] = exact_inner(e1, moment);
    }
    forms.size = hn::Mul(largest_part(e1), largest_part(e2));
    return forms;
}

/// Some samples of a facet, as offsets from its screen, and their weights.
struct SampleLanes {
    Double x, y, weight;
};

HWY_INLINE Double linear_at(const Double& c0, const Double& c1, const Double& c2, const Double& x,
                            const Double& y) {
    return hn::Add(hn::Add(c0, hn::Mul(x, c1)), hn::Mul(y, c2));
}
HWY_INLINE Double quadratic_at(const Double (&c)[6], const Double& x, const Double& y) {
    const Double across = hn::Add(hn::Add(c[1], hn::Mul(x, c[3])), hn::Mul(y, c[4]));
    const Double down = hn::Add(c[2], hn::Mul(y, c[5]));
    return hn::Add(hn::Add(c[0], hn::Mul(x, across)), hn::Mul(y, down));
}

HWY_INLINE SampleLanes sample_lanes(const FacetRays& facet, const Double& x, const Double& y) {
    const auto broadcast = [](double v) HWY_ATTR { return hn::Set(kDouble, v); };
    const std::array<double, 3>& w = facet.rays.weight;
    return {x, y, linear_at(broadcast(w[0]), broadcast(w[1]), broadcast(w[2]), x, y)};
}

/// What place() asks of its terms, bounded over a tile.
struct TileTrust {
    double least_along = 0;  // times PlaceForms::size: a larger denominator is trusted
    bool weight = false;     // every sample's is
};

HWY_INLINE TileTrust trust_of(const FacetRays& facet, const SampleTile& tile, const SampleGrid& grid) {
    const TileFrame frame = tile_frame(tile, grid);
    const Vec2 from = frame.centre - facet.screen;
    const double x = std::fabs(from.x) + frame.half.x + 1, y = std::fabs(from.y) + frame.half.y + 1;
    const std::array<double, 3>&w = facet.rays.weight, &v = facet.speed;
    const double terms = std::fabs(w[0]) + x * std::fabs(w[1]) + y * std::fabs(w[2]);
    return {1.001 * kLeastDeterminant * (v[0] + x * v[1] + y * v[2]),
            tile.low >= 1.001 * kLeastWeightShare * terms};
}

/// `good`: lanes in which place() gives this value. It may give one in others too.
struct PlacedLanes {
    Double t, first, second, third;  // weights of the sorted corners
    hn::Mask<DoubleTag> good;
};

HWY_INLINE PlacedLanes place_lanes(const FormLanes& f, const SampleLanes& s, const TileTrust& trust) {
    const Double one = hn::Set(kDouble, 1.0);
    const Double along = linear_at(f.along[0], f.along[1], f.along[2], s.x, s.y);
    const Double scale = hn::Div(one, hn::Mul(s.weight, along));
    PlacedLanes p;
    p.t = hn::Mul(linear_at(f.above[0], f.above[1], f.above[2], s.x, s.y), hn::Mul(s.weight, scale));
    p.second = hn::Mul(quadratic_at(f.second, s.x, s.y), scale);
    p.third = hn::Mul(quadratic_at(f.third, s.x, s.y), scale);
    p.first = hn::Sub(hn::Sub(one, p.second), p.third);
    // More than its rounding, so that second + third is at most 1.
    const Double inside = hn::Set(kDouble, 0x1p-50);
    const Double infinity = hn::Set(kDouble, std::numeric_limits<double>::infinity());
    const auto sound = hn::And(hn::Gt(hn::Abs(along), hn::Mul(hn::Set(kDouble, trust.least_along), f.size)),
                               hn::Lt(hn::Abs(p.t), infinity));
    p.good = hn::And(
        sound, hn::And(hn::Gt(p.first, inside), hn::And(hn::Gt(p.second, inside), hn::Gt(p.third, inside))));
    return p;
}

/// SampleGrid::position along one axis, from lines of samples counted from the window's corner.
HWY_INLINE Double position_of_line(const Double& line, int start, int side) {
    const Double half = hn::Set(kDouble, 0.5), from = hn::Set(kDouble, static_cast<double>(start));
    if (side == 1) return hn::Add(hn::Add(from, line), half);
    const Double n = hn::Set(kDouble, static_cast<double>(side));
    const Double pixel = hn::Floor(hn::Div(hn::Add(line, half), n));
    const Double inside = hn::Sub(line, hn::Mul(pixel, n));
    return hn::Add(hn::Add(from, pixel), hn::Div(hn::Add(inside, half), n));
}

/// Some lines of the window from 16 local coordinates: `at` and the kDoubles - 1 after it.
HWY_INLINE Double lines_of(const float* local, float half, float middle, int first) {
    const hn::Rebind<float, DoubleTag> some;
    const auto line =
        hn::Round(hn::MulAdd(hn::Load(some, local), hn::Set(some, half), hn::Set(some, middle)));
    return hn::Add(hn::PromoteTo(kDouble, line), hn::Set(kDouble, static_cast<double>(first)));
}

/// The samples of a vector, from `at` on.
HWY_INLINE SampleLanes samples_of(const SampleGrid& grid, const FacetRays& facet, const SampleTile& tile,
                                  const SampleVector& vector, std::size_t at) {
    const float middle_x = static_cast<float>(tile.width - 1) / 2, half_x = std::max(0.5f, middle_x);
    const float middle_y = static_cast<float>(tile.height - 1) / 2, half_y = std::max(0.5f, middle_y);
    const Double column = lines_of(vector.u + at, half_x, middle_x, tile.column),
                 row = lines_of(vector.v + at, half_y, middle_y, tile.row);
    return sample_lanes(
        facet, hn::Sub(position_of_line(column, grid.x0, grid.side), hn::Set(kDouble, facet.screen.x)),
        hn::Sub(position_of_line(row, grid.y0, grid.side), hn::Set(kDouble, facet.screen.y)));
}

}  // namespace HWY_NAMESPACE
}  // namespace trilens
HWY_AFTER_NAMESPACE();

#endif
