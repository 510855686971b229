// Where samples' rays pass the triangles that they surely meet: what place() gives, bit for bit, in lanes.
// Included once per instruction set.
#if defined(TRILENS_KERNEL_PLACE_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef TRILENS_KERNEL_PLACE_INL_H
#undef TRILENS_KERNEL_PLACE_INL_H
#else
#define TRILENS_KERNEL_PLACE_INL_H
#endif

#include <algorithm>
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

HWY_INLINE FormLanes broadcast(const PlaceForms& forms) {
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

/// Some samples of a facet, as offsets from its screen, and what does not depend on triangles.
struct SampleLanes {
    Double x, y, weight, speed;
    hn::Mask<DoubleTag> good;  // the weight is trusted
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
    const std::array<double, 3>&w = facet.rays.weight, &v = facet.speed;
    const Double far_x = hn::Abs(x), far_y = hn::Abs(y);
    const Double weight = linear_at(broadcast(w[0]), broadcast(w[1]), broadcast(w[2]), x, y);
    const Double terms = linear_at(broadcast(std::fabs(w[0])), broadcast(std::fabs(w[1])),
                                   broadcast(std::fabs(w[2])), far_x, far_y);
    return {x, y, weight, linear_at(broadcast(v[0]), broadcast(v[1]), broadcast(v[2]), far_x, far_y),
            hn::Ge(hn::Abs(weight), hn::Mul(broadcast(kLeastWeightShare), terms))};
}

/// `good`: lanes in which place() gives a value.
struct PlacedLanes {
    Double t, first, second, third;  // weights of the sorted corners
    hn::Mask<DoubleTag> good;
};

HWY_INLINE PlacedLanes place_lanes(const FormLanes& f, const SampleLanes& s) {
    const Double one = hn::Set(kDouble, 1.0), zero = hn::Zero(kDouble);
    const Double along = linear_at(f.along[0], f.along[1], f.along[2], s.x, s.y);
    const Double scale = hn::Div(one, hn::Mul(s.weight, along));
    PlacedLanes p;
    p.t = hn::Mul(linear_at(f.above[0], f.above[1], f.above[2], s.x, s.y), hn::Mul(s.weight, scale));
    p.second = hn::Mul(quadratic_at(f.second, s.x, s.y), scale);
    p.third = hn::Mul(quadratic_at(f.third, s.x, s.y), scale);
    p.first = hn::Max(zero, hn::Sub(hn::Sub(one, p.second), p.third));
    const Double least_along = hn::Mul(hn::Set(kDouble, kLeastDeterminant), hn::Mul(s.speed, f.size));
    const Double infinity = hn::Set(kDouble, std::numeric_limits<double>::infinity());
    const auto inside =
        hn::And(hn::Ge(hn::Min(p.second, p.third), zero), hn::Le(hn::Add(p.second, p.third), one));
    const auto sound = hn::And(hn::Ge(hn::Abs(along), least_along), hn::Lt(hn::Abs(p.t), infinity));
    p.good = hn::And(s.good, hn::And(sound, inside));
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
