// 16 floats or bits at once, whatever the instruction set: one AVX-512 register, two of AVX2, four of SSE or
// NEON. Included once per instruction set.
#if defined(TRILENS_KERNEL_LANES_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef TRILENS_KERNEL_LANES_INL_H
#undef TRILENS_KERNEL_LANES_INL_H
#else
#define TRILENS_KERNEL_LANES_INL_H
#endif

#include <hwy/cache_control.h>
#include <hwy/highway.h>

#include <bit>
#include <cstdint>
#include <cstring>

#include "projector/kernel_state.h"

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

#define TRILENS_LANES_OPERATION(name, Name)                           \
    HWY_INLINE Floats name(const Floats& a, const Floats& b) {        \
        Floats r;                                                     \
        TRILENS_EACH_PART r.part[i] = hn::Name(a.part[i], b.part[i]); \
        return r;                                                     \
    }
TRILENS_LANES_OPERATION(operator+, Add)
TRILENS_LANES_OPERATION(operator-, Sub)
TRILENS_LANES_OPERATION(operator*, Mul)
TRILENS_LANES_OPERATION(least, Min)
TRILENS_LANES_OPERATION(largest, Max)
TRILENS_LANES_OPERATION(flip_signs, Xor)
#undef TRILENS_LANES_OPERATION

#define TRILENS_LANES_COMPARISON(name, Name)                          \
    HWY_INLINE Mask name(const Floats& a, const Floats& b) {          \
        Mask r;                                                       \
        TRILENS_EACH_PART r.part[i] = hn::Name(a.part[i], b.part[i]); \
        return r;                                                     \
    }
// All are false where a lane is not a number.
TRILENS_LANES_COMPARISON(operator<, Lt)
TRILENS_LANES_COMPARISON(operator<=, Le)
TRILENS_LANES_COMPARISON(operator>, Gt)
TRILENS_LANES_COMPARISON(operator>=, Ge)
#undef TRILENS_LANES_COMPARISON

/// a b + c, fused where the machine can: only for values whose rounding is bounded.
HWY_INLINE Floats multiply_add(const Floats& a, const Floats& b, const Floats& c) {
    Floats r;
    TRILENS_EACH_PART r.part[i] = hn::MulAdd(a.part[i], b.part[i], c.part[i]);
    return r;
}
/// a b - c.
HWY_INLINE Floats multiply_subtract(const Floats& a, const Floats& b, const Floats& c) {
    Floats r;
    TRILENS_EACH_PART r.part[i] = hn::MulSub(a.part[i], b.part[i], c.part[i]);
    return r;
}
/// c - a b.
HWY_INLINE Floats subtract_product(const Floats& a, const Floats& b, const Floats& c) {
    Floats r;
    TRILENS_EACH_PART r.part[i] = hn::NegMulAdd(a.part[i], b.part[i], c.part[i]);
    return r;
}
HWY_INLINE Floats absolute(const Floats& a) {
    Floats r;
    TRILENS_EACH_PART r.part[i] = hn::Abs(a.part[i]);
    return r;
}
HWY_INLINE Floats round_up(const Floats& a) {
    Floats r;
    TRILENS_EACH_PART r.part[i] = hn::Ceil(a.part[i]);
    return r;
}
HWY_INLINE Floats round_down(const Floats& a) {
    Floats r;
    TRILENS_EACH_PART r.part[i] = hn::Floor(a.part[i]);
    return r;
}
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

HWY_INLINE Mask operator&(const Mask& a, const Mask& b) {
    Mask r;
    TRILENS_EACH_PART r.part[i] = hn::And(a.part[i], b.part[i]);
    return r;
}
HWY_INLINE Mask operator|(const Mask& a, const Mask& b) {
    Mask r;
    TRILENS_EACH_PART r.part[i] = hn::Or(a.part[i], b.part[i]);
    return r;
}
/// a and not b.
HWY_INLINE Mask without(const Mask& a, const Mask& b) {
    Mask r;
    TRILENS_EACH_PART r.part[i] = hn::AndNot(b.part[i], a.part[i]);
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
/// Writes the numbers of the lanes, plus `plus`, one after the other, and returns how many there are. There
/// is room for kLanes words.
HWY_INLINE std::size_t list_lanes(const Mask& lanes, std::uint32_t plus, std::uint32_t* to) {
    std::size_t count = 0;
    TRILENS_EACH_PART {
        const auto number = hn::Iota(kWord, plus + static_cast<std::uint32_t>(i * kPart));
        count += hn::CompressStore(number, hn::RebindMask(kWord, lanes.part[i]), kWord, to + count);
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

}  // namespace HWY_NAMESPACE
}  // namespace trilens
HWY_AFTER_NAMESPACE();

#endif
