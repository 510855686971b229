// Doubles and vectors of three of them, as many side by side as a register holds, eight at most. Sums and
// products are never fused, so that every instruction set rounds alike. Included once per instruction set.
#if defined(TRILENS_DOUBLE_LANES_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef TRILENS_DOUBLE_LANES_INL_H
#undef TRILENS_DOUBLE_LANES_INL_H
#else
#define TRILENS_DOUBLE_LANES_INL_H
#endif

#include <hwy/highway.h>

#include <cstdint>

#include "base/math/vec.h"

HWY_BEFORE_NAMESPACE();
namespace trilens::lanes {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Tag = hn::CappedTag<double, 8>;
using Number = hn::Vec<Tag>;
using Truth = hn::Mask<Tag>;
inline constexpr Tag kTag;
inline constexpr std::size_t kWidth = hn::MaxLanes(kTag);

HWY_INLINE Number number(double x) {
    return hn::Set(kTag, x);
}
/// As std::max and std::min, also of what is no number.
HWY_INLINE Number larger(Number a, Number b) {
    return hn::IfThenElse(hn::Lt(a, b), b, a);
}
HWY_INLINE Number smaller(Number a, Number b) {
    return hn::IfThenElse(hn::Lt(b, a), b, a);
}

struct Vector {
    Number x, y, z;
};
HWY_INLINE Vector vector(const Vec3& v) {
    return {number(v.x), number(v.y), number(v.z)};
}
HWY_INLINE Vector vector_at(const double* x, const double* y, const double* z) {
    return {hn::Load(kTag, x), hn::Load(kTag, y), hn::Load(kTag, z)};
}
/// Of a structure of arrays x, y and z, aligned: its elements from `first`, a multiple of kWidth, on.
template <typename Arrays>
HWY_INLINE Vector load(const Arrays& from, std::size_t first) {
    return vector_at(from.x + first, from.y + first, from.z + first);
}
template <typename Arrays>
HWY_INLINE void store(const Vector& v, Arrays& to, std::size_t first) {
    hn::Store(v.x, kTag, to.x + first);
    hn::Store(v.y, kTag, to.y + first);
    hn::Store(v.z, kTag, to.z + first);
}
HWY_INLINE Vector plus(const Vector& a, const Vector& b) {
    return {hn::Add(a.x, b.x), hn::Add(a.y, b.y), hn::Add(a.z, b.z)};
}
HWY_INLINE Vector minus(const Vector& a, const Vector& b) {
    return {hn::Sub(a.x, b.x), hn::Sub(a.y, b.y), hn::Sub(a.z, b.z)};
}
HWY_INLINE Vector times(Number s, const Vector& a) {
    return {hn::Mul(s, a.x), hn::Mul(s, a.y), hn::Mul(s, a.z)};
}
HWY_INLINE Vector over(const Vector& a, Number s) {
    return {hn::Div(a.x, s), hn::Div(a.y, s), hn::Div(a.z, s)};
}
HWY_INLINE Vector opposite(const Vector& a) {
    return {hn::Neg(a.x), hn::Neg(a.y), hn::Neg(a.z)};
}
HWY_INLINE Number dot(const Vector& a, const Vector& b) {
    return hn::Add(hn::Add(hn::Mul(a.x, b.x), hn::Mul(a.y, b.y)), hn::Mul(a.z, b.z));
}
HWY_INLINE Vector cross(const Vector& a, const Vector& b) {
    return {hn::Sub(hn::Mul(a.y, b.z), hn::Mul(b.y, a.z)), hn::Sub(hn::Mul(a.z, b.x), hn::Mul(b.z, a.x)),
            hn::Sub(hn::Mul(a.x, b.y), hn::Mul(b.x, a.y))};
}
HWY_INLINE Vector either(Truth which, const Vector& a, const Vector& b) {
    return {hn::IfThenElse(which, a.x, b.x), hn::IfThenElse(which, a.y, b.y),
            hn::IfThenElse(which, a.z, b.z)};
}

/// As normalize_or_zero.
HWY_INLINE Vector unit_or_zero(const Vector& v) {
    const Number largest = larger(larger(hn::Abs(v.x), hn::Abs(v.y)), hn::Abs(v.z));
    const Truth usual = hn::AndNot(hn::Gt(largest, number(1.7e308)), hn::Gt(largest, number(0)));
    const Vector scaled = over(v, largest);
    const Vector unit = over(scaled, hn::Sqrt(dot(scaled, scaled)));
    return either(usual, unit, vector(Vec3(0)));
}

/// Bit i: lane i.
HWY_INLINE std::uint32_t bits_of(Truth truth) {
    std::uint8_t bytes[8] = {};
    hn::StoreMaskBits(kTag, truth, bytes);
    return bytes[0] & ((1u << kWidth) - 1u);
}
HWY_INLINE Truth truth_of(std::uint32_t bits) {
    const std::uint8_t bytes[8] = {static_cast<std::uint8_t>(bits)};
    return hn::LoadMaskBits(kTag, bytes);
}

}  // namespace HWY_NAMESPACE
}  // namespace trilens::lanes
HWY_AFTER_NAMESPACE();

#endif
