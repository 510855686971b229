// Doubles and vectors of three of them, as many at once as a register holds, and 16 of them as floats.
// Included once per instruction set.
#if defined(TRILENS_KERNEL_DOUBLES_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef TRILENS_KERNEL_DOUBLES_INL_H
#undef TRILENS_KERNEL_DOUBLES_INL_H
#else
#define TRILENS_KERNEL_DOUBLES_INL_H
#endif

#include "projector/kernel/kernel_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace trilens {
namespace HWY_NAMESPACE {

using DoubleTag = hn::CappedTag<double, kLanes / 2>;
inline constexpr DoubleTag kDouble;
using Double = hn::Vec<DoubleTag>;
inline constexpr std::size_t kDoubles = hn::MaxLanes(kDouble);

/// Twice as many, worked on side by side: one waits while the other is computed.
struct Two {
    Double low, high;
};

#define TRILENS_DOUBLES_OPERATION(name, Name)                      \
    HWY_INLINE Double name(const Double& a, const Double& b) {     \
        return hn::Name(a, b);                                     \
    }                                                              \
    HWY_INLINE Two name(const Two& a, const Two& b) {              \
        return {hn::Name(a.low, b.low), hn::Name(a.high, b.high)}; \
    }                                                              \
    HWY_INLINE Two name(const Two& a, const Double& b) {           \
        return {hn::Name(a.low, b), hn::Name(a.high, b)};          \
    }
TRILENS_DOUBLES_OPERATION(plus, Add)
TRILENS_DOUBLES_OPERATION(minus, Sub)
TRILENS_DOUBLES_OPERATION(product, Mul)
#undef TRILENS_DOUBLES_OPERATION
HWY_INLINE Double inverse(const Double& a) {
    return hn::Div(hn::Set(kDouble, 1.0), a);
}
HWY_INLINE Two inverse(const Two& a) {
    return {inverse(a.low), inverse(a.high)};
}

/// Of Double or Two.
template <typename Number>
struct VectorOf {
    Number x, y, z;
};
using Vector3 = VectorOf<Double>;

HWY_INLINE Vector3 load3(const double (*from)[kLanes], std::size_t at) {
    return {hn::Load(kDouble, from[0] + at), hn::Load(kDouble, from[1] + at),
            hn::Load(kDouble, from[2] + at)};
}
HWY_INLINE void store3(const Vector3& v, double (*to)[kLanes], std::size_t at) {
    hn::Store(v.x, kDouble, to[0] + at);
    hn::Store(v.y, kDouble, to[1] + at);
    hn::Store(v.z, kDouble, to[2] + at);
}
template <typename A, typename B>
HWY_INLINE VectorOf<A> plus(const VectorOf<A>& a, const VectorOf<B>& b) {
    return {plus(a.x, b.x), plus(a.y, b.y), plus(a.z, b.z)};
}
template <typename A, typename B>
HWY_INLINE VectorOf<A> minus(const VectorOf<A>& a, const VectorOf<B>& b) {
    return {minus(a.x, b.x), minus(a.y, b.y), minus(a.z, b.z)};
}
template <typename A, typename B>
HWY_INLINE VectorOf<A> times(const A& s, const VectorOf<B>& a) {
    return {product(s, a.x), product(s, a.y), product(s, a.z)};
}
HWY_INLINE Double inner(const Vector3& a, const Vector3& b) {
    return hn::MulAdd(a.x, b.x, hn::MulAdd(a.y, b.y, hn::Mul(a.z, b.z)));
}
HWY_INLINE Vector3 outer(const Vector3& a, const Vector3& b) {
    return {hn::MulSub(a.y, b.z, hn::Mul(a.z, b.y)), hn::MulSub(a.z, b.x, hn::Mul(a.x, b.z)),
            hn::MulSub(a.x, b.y, hn::Mul(a.y, b.x))};
}
HWY_INLINE Vector3 unit(const Vector3& a) {
    const Double square = hn::Max(inner(a, a), hn::Set(kDouble, 1e-300));
    return times(hn::Div(hn::Set(kDouble, 1.0), hn::Sqrt(square)), a);
}

/// 16 doubles.
struct DoubleLanes {
    Double part[kLanes / kDoubles];
};

HWY_INLINE DoubleLanes load_doubles(const double* from) {
    DoubleLanes r;
    for (std::size_t i = 0; i < kLanes / kDoubles; ++i) r.part[i] = hn::Load(kDouble, from + i * kDoubles);
    return r;
}
HWY_INLINE void store_doubles(const DoubleLanes& v, double* to) {
    for (std::size_t i = 0; i < kLanes / kDoubles; ++i) hn::Store(v.part[i], kDouble, to + i * kDoubles);
}
HWY_INLINE Floats narrow(const DoubleLanes& v) {
    const hn::Rebind<float, DoubleTag> some;
    static_assert(kPart == 2 * kDoubles);
    Floats r;
    for (std::size_t i = 0; i < kParts; ++i)
        r.part[i] =
            hn::Combine(kFloat, hn::DemoteTo(some, v.part[2 * i + 1]), hn::DemoteTo(some, v.part[2 * i]));
    return r;
}

HWY_INLINE void widen(const Floats& v, DoubleLanes& to) {
    const hn::Rebind<float, DoubleTag> some;
    for (std::size_t i = 0; i < kParts; ++i) {
        to.part[2 * i] = hn::PromoteTo(kDouble, hn::LowerHalf(some, v.part[i]));
        to.part[2 * i + 1] = hn::PromoteTo(kDouble, hn::UpperHalf(some, v.part[i]));
    }
}

/// Three axes of 16 doubles.
struct DoubleLanes3 {
    DoubleLanes axis[3];

    HWY_INLINE Vector3 at(std::size_t i) const { return {axis[0].part[i], axis[1].part[i], axis[2].part[i]}; }
    HWY_INLINE void set(std::size_t i, const Vector3& v) {
        axis[0].part[i] = v.x;
        axis[1].part[i] = v.y;
        axis[2].part[i] = v.z;
    }
};

inline constexpr std::size_t kHalves = kLanes / kDoubles;

template <std::size_t kCoefficients>
HWY_INLINE Vector3 load_part(const double (*from)[kCoefficients][kLanes], int part, std::size_t at) {
    return {hn::Load(kDouble, from[0][part] + at), hn::Load(kDouble, from[1][part] + at),
            hn::Load(kDouble, from[2][part] + at)};
}
HWY_INLINE Vector3 absolute(const Vector3& a) {
    return {hn::Abs(a.x), hn::Abs(a.y), hn::Abs(a.z)};
}

/// As floats. Returns those.
HWY_INLINE Vector3 store_floats(const Vector3& v, float (*to)[kLanes], std::size_t at) {
    const hn::Rebind<float, DoubleTag> some;
    const auto x = hn::DemoteTo(some, v.x), y = hn::DemoteTo(some, v.y), z = hn::DemoteTo(some, v.z);
    hn::Store(x, some, to[0] + at);
    hn::Store(y, some, to[1] + at);
    hn::Store(z, some, to[2] + at);
    return {hn::PromoteTo(kDouble, x), hn::PromoteTo(kDouble, y), hn::PromoteTo(kDouble, z)};
}

}  // namespace HWY_NAMESPACE
}  // namespace trilens
HWY_AFTER_NAMESPACE();

#endif
