// Highway, and after it WebAssembly's own instructions for what the kernel asks most of Highway's plain
// vectors: overloads of the same names for the same types, which the compiler prefers to Highway's templates;
// from those it makes scalars, and branches in Min and Max.
#pragma once

#pragma clang diagnostic push
#pragma clang diagnostic ignored "-Wgnu-include-next"
#include_next <hwy/highway.h>
#pragma clang diagnostic pop
#include <wasm_simd128.h>

#include <bit>

HWY_BEFORE_NAMESPACE();
namespace hwy {
namespace HWY_NAMESPACE {

using Floats4 = Vec128<float, 4>;
using FloatMask4 = Mask128<float, 4>;
using Words4 = Vec128<std::uint32_t, 4>;
using WordMask4 = Mask128<std::uint32_t, 4>;
using Doubles2 = Vec128<double, 2>;

template <typename From>
HWY_INLINE v128_t wasm(const From& from) {
    return __builtin_bit_cast(v128_t, from);
}
template <typename To>
HWY_INLINE To as(v128_t from) {
    return __builtin_bit_cast(To, from);
}

#define TRILENS_BINARY(Result, Name, Argument, instruction)      \
    HWY_INLINE Result Name(const Argument a, const Argument b) { \
        return as<Result>(instruction(wasm(a), wasm(b)));        \
    }
// Min and Max give the second argument where one of them is not a number, as x86 does.
#define TRILENS_ARITHMETIC(Type, shape)                                   \
    TRILENS_BINARY(Type, Add, Type, wasm_##shape##_add)                   \
    TRILENS_BINARY(Type, operator+, Type, wasm_##shape##_add)             \
    TRILENS_BINARY(Type, Sub, Type, wasm_##shape##_sub)                   \
    TRILENS_BINARY(Type, operator-, Type, wasm_##shape##_sub)             \
    TRILENS_BINARY(Type, Mul, Type, wasm_##shape##_mul)                   \
    TRILENS_BINARY(Type, operator*, Type, wasm_##shape##_mul)             \
    TRILENS_BINARY(Type, Div, Type, wasm_##shape##_div)                   \
    TRILENS_BINARY(Type, operator/, Type, wasm_##shape##_div)             \
    HWY_INLINE Type MulAdd(const Type a, const Type b, const Type c) {    \
        return Add(Mul(a, b), c);                                         \
    }                                                                     \
    HWY_INLINE Type MulSub(const Type a, const Type b, const Type c) {    \
        return Sub(Mul(a, b), c);                                         \
    }                                                                     \
    HWY_INLINE Type NegMulAdd(const Type a, const Type b, const Type c) { \
        return Sub(c, Mul(a, b));                                         \
    }                                                                     \
    HWY_INLINE Type Sqrt(const Type a) {                                  \
        return as<Type>(wasm_##shape##_sqrt(wasm(a)));                    \
    }                                                                     \
    HWY_INLINE Type Abs(const Type a) {                                   \
        return as<Type>(wasm_##shape##_abs(wasm(a)));                     \
    }                                                                     \
    HWY_INLINE Type Max(const Type a, const Type b) {                     \
        return as<Type>(wasm_##shape##_pmax(wasm(b), wasm(a)));           \
    }                                                                     \
    HWY_INLINE Type Min(const Type a, const Type b) {                     \
        return as<Type>(wasm_##shape##_pmin(wasm(b), wasm(a)));           \
    }
TRILENS_ARITHMETIC(Floats4, f32x4)
TRILENS_ARITHMETIC(Doubles2, f64x2)
TRILENS_BINARY(FloatMask4, Lt, Floats4, wasm_f32x4_lt)
TRILENS_BINARY(FloatMask4, Le, Floats4, wasm_f32x4_le)
TRILENS_BINARY(FloatMask4, Gt, Floats4, wasm_f32x4_gt)
TRILENS_BINARY(FloatMask4, Ge, Floats4, wasm_f32x4_ge)
TRILENS_BINARY(FloatMask4, And, FloatMask4, wasm_v128_and)
TRILENS_BINARY(FloatMask4, Or, FloatMask4, wasm_v128_or)
TRILENS_BINARY(Floats4, And, Floats4, wasm_v128_and)
TRILENS_BINARY(Floats4, Or, Floats4, wasm_v128_or)
TRILENS_BINARY(Floats4, Xor, Floats4, wasm_v128_xor)
TRILENS_BINARY(Words4, Add, Words4, wasm_i32x4_add)
TRILENS_BINARY(WordMask4, Eq, Words4, wasm_i32x4_eq)
HWY_INLINE FloatMask4 AndNot(const FloatMask4 a, const FloatMask4 b) {
    return as<FloatMask4>(wasm_v128_andnot(wasm(b), wasm(a)));
}
HWY_INLINE Floats4 IfThenElse(const FloatMask4 m, const Floats4 yes, const Floats4 no) {
    return as<Floats4>(wasm_v128_bitselect(wasm(yes), wasm(no), wasm(m)));
}
HWY_INLINE Words4 IfThenElse(const WordMask4 m, const Words4 yes, const Words4 no) {
    return as<Words4>(wasm_v128_bitselect(wasm(yes), wasm(no), wasm(m)));
}
HWY_INLINE Floats4 Round(const Floats4 a) {
    return as<Floats4>(wasm_f32x4_nearest(wasm(a)));
}
HWY_INLINE Floats4 Ceil(const Floats4 a) {
    return as<Floats4>(wasm_f32x4_ceil(wasm(a)));
}
HWY_INLINE Floats4 Floor(const Floats4 a) {
    return as<Floats4>(wasm_f32x4_floor(wasm(a)));
}
HWY_INLINE size_t StoreMaskBits(Simd<float, 4, 0>, const FloatMask4 mask, std::uint8_t* bits) {
    bits[0] = static_cast<std::uint8_t>(wasm_i32x4_bitmask(wasm(mask)));
    return 1;
}
HWY_INLINE FloatMask4 LoadMaskBits(Simd<float, 4, 0>, const std::uint8_t* bits) {
    const v128_t own = wasm_i32x4_make(1, 2, 4, 8);
    return as<FloatMask4>(wasm_i32x4_eq(wasm_v128_and(wasm_i32x4_splat(bits[0]), own), own));
}
HWY_INLINE size_t CountTrue(Simd<std::uint32_t, 4, 0>, const WordMask4 mask) {
    return static_cast<size_t>(std::popcount(static_cast<unsigned>(wasm_i32x4_bitmask(wasm(mask)))));
}
#undef TRILENS_ARITHMETIC
#undef TRILENS_BINARY

}  // namespace HWY_NAMESPACE
}  // namespace hwy
HWY_AFTER_NAMESPACE();
