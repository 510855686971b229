// SIMD wrappers: 16 floats, masks or words at once whatever the instruction set, and doubles and vectors of
// three of them, as many as a register holds. Included once per instruction set.
#if defined(TRILENS_KERNEL_SIMD_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef TRILENS_KERNEL_SIMD_INL_H
#undef TRILENS_KERNEL_SIMD_INL_H
#else
#define TRILENS_KERNEL_SIMD_INL_H
#endif

#include <hwy/cache_control.h>
#include <hwy/highway.h>

#include <bit>
#include <cstdint>
#include <cstring>

#include "projector/kernel/state.h"

HWY_BEFORE_NAMESPACE();
namespace trilens {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using FloatTag = hn::CappedTag<float, kLanes>;
using WordTag = hn::CappedTag<std::uint32_t, kLanes>;
inline constexpr FloatTag kFloat;
inline constexpr WordTag kWord;
inline constexpr std::size_t kPart = hn::MaxLanes(kFloat);
inline constexpr std::size_t kParts = kLanes / kPart;

/// 16 floats.
struct Floats {
    hn::Vec<FloatTag> part[kParts];
};
/// 16 truth values.
struct Mask {
    hn::Mask<FloatTag> part[kParts];
};
/// 16 indices.
struct Words {
    hn::Vec<WordTag> part[kParts];
};

#define TRILENS_EACH_PART for (std::size_t i = 0; i < kParts; ++i)

HWY_INLINE Floats set(float v) {
    Floats r;
    TRILENS_EACH_PART r.part[i] = hn::Set(kFloat, v);
    return r;
}
HWY_INLINE Floats load(const float* from) {
    Floats r;
    TRILENS_EACH_PART r.part[i] = hn::Load(kFloat, from + i * kPart);
    return r;
}
HWY_INLINE void store(const Floats& v, float* to) {
    TRILENS_EACH_PART hn::Store(v.part[i], kFloat, to + i * kPart);
}
HWY_INLINE void stream(const Floats& v, float* to) {
    TRILENS_EACH_PART hn::Stream(v.part[i], kFloat, to + i * kPart);
}
HWY_INLINE Words set_word(std::uint32_t v) {
    Words r;
    TRILENS_EACH_PART r.part[i] = hn::Set(kWord, v);
    return r;
}
HWY_INLINE Words load_words(const std::uint32_t* from) {
    Words r;
    TRILENS_EACH_PART r.part[i] = hn::Load(kWord, from + i * kPart);
    return r;
}
HWY_INLINE void store_words(const Words& v, std::uint32_t* to) {
    TRILENS_EACH_PART hn::Store(v.part[i], kWord, to + i * kPart);
}
HWY_INLINE void stream_words(const Words& v, std::uint32_t* to) {
    TRILENS_EACH_PART hn::Stream(v.part[i], kWord, to + i * kPart);
}

#define TRILENS_LANES_OPERATION(Result, name, Name, Argument)         \
    HWY_INLINE Result name(const Argument& a, const Argument& b) {    \
        Result r;                                                     \
        TRILENS_EACH_PART r.part[i] = hn::Name(a.part[i], b.part[i]); \
        return r;                                                     \
    }
TRILENS_LANES_OPERATION(Floats, operator+, Add, Floats)
TRILENS_LANES_OPERATION(Floats, operator-, Sub, Floats)
TRILENS_LANES_OPERATION(Floats, operator*, Mul, Floats)
TRILENS_LANES_OPERATION(Floats, operator/, Div, Floats)
TRILENS_LANES_OPERATION(Floats, least, Min, Floats)
TRILENS_LANES_OPERATION(Floats, largest, Max, Floats)
TRILENS_LANES_OPERATION(Floats, flip_signs, Xor, Floats)
// All are false where a lane is not a number.
TRILENS_LANES_OPERATION(Mask, operator<, Lt, Floats)
TRILENS_LANES_OPERATION(Mask, operator<=, Le, Floats)
TRILENS_LANES_OPERATION(Mask, operator>, Gt, Floats)
TRILENS_LANES_OPERATION(Mask, operator>=, Ge, Floats)
TRILENS_LANES_OPERATION(Mask, operator&, And, Mask)
TRILENS_LANES_OPERATION(Mask, operator|, Or, Mask)
#undef TRILENS_LANES_OPERATION
/// b and not a.
HWY_INLINE Mask without(const Mask& b, const Mask& a) {
    Mask r;
    TRILENS_EACH_PART r.part[i] = hn::AndNot(a.part[i], b.part[i]);
    return r;
}

#define TRILENS_LANES_FUNCTION(name, Name)                 \
    HWY_INLINE Floats name(const Floats& a) {              \
        Floats r;                                          \
        TRILENS_EACH_PART r.part[i] = hn::Name(a.part[i]); \
        return r;                                          \
    }
TRILENS_LANES_FUNCTION(absolute, Abs)
TRILENS_LANES_FUNCTION(round, Round)
TRILENS_LANES_FUNCTION(round_up, Ceil)
TRILENS_LANES_FUNCTION(round_down, Floor)
#undef TRILENS_LANES_FUNCTION

#define TRILENS_LANES_FUSED(name, Name)                                          \
    HWY_INLINE Floats name(const Floats& a, const Floats& b, const Floats& c) {  \
        Floats r;                                                                \
        TRILENS_EACH_PART r.part[i] = hn::Name(a.part[i], b.part[i], c.part[i]); \
        return r;                                                                \
    }
// Fused where the machine can: only for values whose rounding is bounded. a b + c, a b - c, c - a b.
TRILENS_LANES_FUSED(multiply_add, MulAdd)
TRILENS_LANES_FUSED(multiply_subtract, MulSub)
TRILENS_LANES_FUSED(subtract_product, NegMulAdd)
#undef TRILENS_LANES_FUSED
/// 1 / a to 2^-22.
HWY_INLINE Floats reciprocal(const Floats& a) {
    Floats r;
#if HWY_ARCH_X86
    // At least 11 bits, doubled by one step of Newton's method.
    TRILENS_EACH_PART {
        const auto guess = hn::ApproximateReciprocal(a.part[i]);
        r.part[i] = hn::Mul(guess, hn::NegMulAdd(a.part[i], guess, hn::Set(kFloat, 2.0f)));
    }
#else
    TRILENS_EACH_PART r.part[i] = hn::Div(hn::Set(kFloat, 1.0f), a.part[i]);
#endif
    return r;
}

HWY_INLINE Floats choose(const Mask& m, const Floats& yes, const Floats& no) {
    Floats r;
    TRILENS_EACH_PART r.part[i] = hn::IfThenElse(m.part[i], yes.part[i], no.part[i]);
    return r;
}
HWY_INLINE Words choose(const Mask& m, const Words& yes, const Words& no) {
    Words r;
    TRILENS_EACH_PART r.part[i] = hn::IfThenElse(hn::RebindMask(kWord, m.part[i]), yes.part[i], no.part[i]);
    return r;
}
HWY_INLINE Mask same(const Words& a, const Words& b) {
    Mask r;
    TRILENS_EACH_PART r.part[i] = hn::RebindMask(kFloat, hn::Eq(a.part[i], b.part[i]));
    return r;
}
/// Bit k is lane k.
HWY_INLINE std::uint32_t bits(const Mask& m) {
    std::uint32_t r = 0;
    TRILENS_EACH_PART {
        std::uint8_t bytes[8] = {};
        hn::StoreMaskBits(kFloat, m.part[i], bytes);
        std::uint16_t word;
        std::memcpy(&word, bytes, sizeof word);
        r |= static_cast<std::uint32_t>(word) << (i * kPart);
    }
    return r;
}
HWY_INLINE Mask mask_of(std::uint32_t lanes) {
    Mask r;
    TRILENS_EACH_PART {
        const std::uint32_t own = lanes >> (i * kPart);
        std::uint8_t bytes[8] = {};
        std::memcpy(bytes, &own, sizeof own);
        r.part[i] = hn::LoadMaskBits(kFloat, bytes);
    }
    return r;
}
HWY_INLINE float largest_lane(const Floats& a) {
    auto all = a.part[0];
    for (std::size_t i = 1; i < kParts; ++i) all = hn::Max(all, a.part[i]);
    return hn::GetLane(hn::MaxOfLanes(kFloat, all));
}
HWY_INLINE float least_lane(const Floats& a) {
    auto all = a.part[0];
    for (std::size_t i = 1; i < kParts; ++i) all = hn::Min(all, a.part[i]);
    return hn::GetLane(hn::MinOfLanes(kFloat, all));
}
HWY_INLINE float sum_of_lanes(const Floats& a) {
    auto all = a.part[0];
    for (std::size_t i = 1; i < kParts; ++i) all = hn::Add(all, a.part[i]);
    return hn::GetLane(hn::SumOfLanes(kFloat, all));
}
/// Writes kStep times the numbers of the lanes, plus `plus`, one after the other, and returns how many there
/// are. There is room for kLanes words.
template <std::uint32_t kStep = 1>
HWY_INLINE std::size_t list_lanes(const Mask& lanes, std::uint32_t plus, std::uint32_t* to) {
    static_assert(std::has_single_bit(kStep));
    // From memory: g++ 12 would put Iota() together lane by lane.
    alignas(64) static constexpr std::uint32_t kNumber[kLanes] = {0, 1, 2,  3,  4,  5,  6,  7,
                                                                  8, 9, 10, 11, 12, 13, 14, 15};
    std::size_t count = 0;
    TRILENS_EACH_PART {
        const auto number =
            hn::Add(hn::ShiftLeft<std::countr_zero(kStep)>(hn::Load(kWord, kNumber + i * kPart)),
                    hn::Set(kWord, plus));
        const auto own = hn::RebindMask(kWord, lanes.part[i]);
        // Not CompressStore: straight to memory it is slow on some machines.
        hn::StoreU(hn::Compress(number, own), kWord, to + count);
        count += hn::CountTrue(kWord, own);
    }
    return count;
}
/// Every lane's own bit, lowest first: for (Each lane(mask); lane; ++lane) use(*lane).
class Each {
  public:
    explicit Each(std::uint32_t lanes) : left_(lanes) {}
    explicit operator bool() const { return left_ != 0; }
    std::uint32_t operator*() const { return static_cast<std::uint32_t>(std::countr_zero(left_)); }
    Each& operator++() {
        left_ &= left_ - 1;
        return *this;
    }

  private:
    std::uint32_t left_;
};
HWY_INLINE std::uint32_t first_lanes(std::uint32_t count) {
    return count >= kLanes ? kAllLanes : (1u << count) - 1;
}

#undef TRILENS_EACH_PART

// Doubles and vectors of three of them, as many at once as a register holds, and 16 of them as floats.

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
HWY_INLINE Double dot(const Vector3& a, const Vector3& b) {
    return hn::MulAdd(a.x, b.x, hn::MulAdd(a.y, b.y, hn::Mul(a.z, b.z)));
}
HWY_INLINE Vector3 cross(const Vector3& a, const Vector3& b) {
    return {hn::MulSub(a.y, b.z, hn::Mul(a.z, b.y)), hn::MulSub(a.z, b.x, hn::Mul(a.x, b.z)),
            hn::MulSub(a.x, b.y, hn::Mul(a.y, b.x))};
}
HWY_INLINE Vector3 unit(const Vector3& a) {
    const Double square = hn::Max(dot(a, a), hn::Set(kDouble, 1e-300));
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
