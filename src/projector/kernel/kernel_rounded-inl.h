// Vectors whose samples see one triangle or two, written as floats from quotients, two side by side: only
// where place()'s doubles must round to the same floats. Included once per instruction set.
#if defined(TRILENS_KERNEL_ROUNDED_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef TRILENS_KERNEL_ROUNDED_INL_H
#undef TRILENS_KERNEL_ROUNDED_INL_H
#else
#define TRILENS_KERNEL_ROUNDED_INL_H
#endif

#include <array>
#include <bit>

#include "projector/kernel/kernel_quotients-inl.h"

HWY_BEFORE_NAMESPACE();
namespace trilens {
namespace HWY_NAMESPACE {

/// Doubles of kVectors vectors, worked on side by side: one waits while the others are computed.
template <std::size_t kVectors>
struct Rows {
    Double part[kVectors * kHalves];
};

template <std::size_t kVectors>
HWY_INLINE void put_row(const Floats& v, std::size_t vector, Rows<kVectors>& to) {
    DoubleLanes own;
    widen(v, own);
    for (std::size_t i = 0; i < kHalves; ++i) to.part[vector * kHalves + i] = own.part[i];
}

template <std::size_t kVectors>
HWY_INLINE void narrow(const Rows<kVectors>& v, Floats (&to)[kVectors]) {
    for (std::size_t k = 0; k < kVectors; ++k) {
        DoubleLanes own;
        for (std::size_t i = 0; i < kHalves; ++i) own.part[i] = v.part[k * kHalves + i];
        to[k] = narrow(own);
    }
}

/// Both ends of values that are off by doubts and kQuotientRound of themselves, where they are positive.
template <std::size_t kVectors>
struct Ends {
    Floats low[kVectors], high[kVectors];
};
template <std::size_t kVectors>
HWY_INLINE void put_ends(const Rows<kVectors>& v, const double (&doubt)[kVectors], Ends<kVectors>& ends) {
    const Double more = hn::Set(kDouble, 1 + kQuotientRound), less = hn::Set(kDouble, 1 - kQuotientRound);
    Rows<kVectors> low, high;
    for (std::size_t r = 0; r < kVectors * kHalves; ++r) {
        const Double off = hn::Set(kDouble, doubt[r / kHalves]);
        low.part[r] = hn::MulSub(v.part[r], less, off);
        high.part[r] = hn::MulAdd(v.part[r], more, off);
    }
    narrow(low, ends.low);
    narrow(high, ends.high);
}

/// A vector all of whose samples are asked about one triangle.
struct QuotientRow {
    std::uint32_t vector;
    const Quotient* quotient;
};
/// What they see there: place()'s doubles as floats, in the lanes of `agreed`.
struct RoundedRow {
    PlacedFloats floats;
    Mask agreed;
};

/// Along axis a, in lines of samples from the tile's first.
template <std::size_t kVectors>
HWY_INLINE void lines_of(const TileSpots& spots, int a, const SampleVector* vectors,
                         const QuotientRow (&row)[kVectors], Rows<kVectors>& to) {
    for (std::size_t k = 0; k < kVectors; ++k) {
        const SampleVector& samples = vectors[row[k].vector];
        const Floats local = load(a == 0 ? samples.u : samples.v);
        put_row(round(multiply_add(local, set(spots.half[a]), set(spots.middle[a]))), k, to);
    }
}

/// The quotients' values at the rows' samples.
template <std::size_t kVectors>
struct QuotientValues {
    Rows<kVectors> t, second, third;
};

template <std::size_t kVectors>
HWY_INLINE QuotientValues<kVectors> quotients_at(const TilePlacing& tile, const RayParts& parts,
                                                 const QuotientRow (&row)[kVectors]) {
    constexpr std::size_t kRows = kVectors * kHalves;
    const SampleVector* const vectors = tile.scene.tiles->vectors.data();
    QuotientValues<kVectors> values;
    Rows<kVectors> x, y, weight, all;
    lines_of(tile.spots, 0, vectors, row, x);
    lines_of(tile.spots, 1, vectors, row, y);
    const auto linear = [&](std::size_t r, const double* c) HWY_ATTR {
        return hn::MulAdd(x.part[r], hn::Set(kDouble, c[1]),
                          hn::MulAdd(y.part[r], hn::Set(kDouble, c[2]), hn::Set(kDouble, c[0])));
    };
    for (std::size_t r = 0; r < kRows; ++r) {
        weight.part[r] = linear(r, parts.weight[1]);
        all.part[r] = hn::Mul(weight.part[r], linear(r, row[r / kHalves].quotient->along));
    }
    Floats guess[kVectors];
    narrow(all, guess);
    Rows<kVectors> scale;
    for (std::size_t k = 0; k < kVectors; ++k) put_row(reciprocal(guess[k]), k, scale);
    const auto quadratic = [&](std::size_t r, const double* c) HWY_ATTR {
        const auto at = [&](std::size_t k) HWY_ATTR { return hn::Set(kDouble, c[k]); };
        return hn::MulAdd(x.part[r], hn::MulAdd(x.part[r], at(3), hn::MulAdd(y.part[r], at(4), at(1))),
                          hn::MulAdd(y.part[r], hn::MulAdd(y.part[r], at(5), at(2)), at(0)));
    };
    for (std::size_t r = 0; r < kRows; ++r) {
        const Quotient& q = *row[r / kHalves].quotient;
        values.t.part[r] = hn::Mul(linear(r, q.above), weight.part[r]);
        values.second.part[r] = quadratic(r, q.second);
        values.third.part[r] = quadratic(r, q.third);
    }
    for (std::size_t r = 0; r < kRows; ++r) {
        const Double first = scale.part[r];
        scale.part[r] = hn::MulAdd(first, hn::NegMulAdd(all.part[r], first, hn::Set(kDouble, 1.0)), first);
    }
    for (std::size_t r = 0; r < kRows; ++r) {
        values.t.part[r] = hn::Mul(values.t.part[r], scale.part[r]);
        values.second.part[r] = hn::Mul(values.second.part[r], scale.part[r]);
        values.third.part[r] = hn::Mul(values.third.part[r], scale.part[r]);
    }
    return values;
}

template <std::size_t kVectors>
HWY_INLINE void round_quotients(const TilePlacing& tile, const RayParts& parts,
                                const QuotientRow (&row)[kVectors], RoundedRow (&rounded)[kVectors]) {
    const QuotientValues<kVectors> values = quotients_at(tile, parts, row);
    double time_doubt[kVectors], weight_doubt[kVectors];
    for (std::size_t k = 0; k < kVectors; ++k) {
        time_doubt[k] = row[k].quotient->time_doubt;
        weight_doubt[k] = row[k].quotient->weight_doubt;
    }
    Ends<kVectors> time, one, other;
    put_ends(values.t, time_doubt, time);
    put_ends(values.second, weight_doubt, one);
    put_ends(values.third, weight_doubt, other);
    for (std::size_t k = 0; k < kVectors; ++k) {
        const PlacedFloats floats{time.high[k], one.high[k], other.high[k],
                                  set_word(row[k].quotient->triangle)};
        rounded[k] = {floats, (time.low[k] >= time.high[k]) & (one.low[k] >= one.high[k]) &
                                  (other.low[k] >= other.high[k]) & (time.low[k] > set(0.0f)) &
                                  sound(floats)};
    }
}

HWY_INLINE PlacedFloats choose(const Mask& m, const PlacedFloats& yes, const PlacedFloats& no) {
    return {choose(m, yes.t, no.t), choose(m, yes.second, no.second), choose(m, yes.third, no.third),
            choose(m, yes.triangle, no.triangle)};
}

/// Writes what vectors without doubts see, or names those that place() must say as `left`.
class RoundedWriter {
  public:
    RoundedWriter(const TilePlacing& tile, KernelState& state) : tile_(tile), state_(state) {
        state.quotients.triangle.fill(kNone);
        put_ray_parts(tile, state.quotients.parts);
    }

    /// A vector that `nearest` is of. False: not here.
    HWY_INLINE bool write(std::uint32_t vector, const Nearest& nearest) {
        const Words seen = load_words(nearest.triangle);
        const Id first = nearest.triangle[0];
        const std::uint32_t others = kAllLanes & ~bits(same(seen, set_word(first)));
        if (first == kNone) return false;
        if (others == 0) return write_all(vector, first);
        const Id second = nearest.triangle[std::countr_zero(others)];
        const Mask own = same(seen, set_word(second));
        return bits(own) == others && second != kNone && write_both(vector, {first, second}, own);
    }

    /// All samples of the vector see the triangle. False: not here.
    HWY_INLINE bool write_all(std::uint32_t vector, Id triangle) {
        if (waiting_slot_is_of(triangle)) keep_waiting();
        const Quotient* const quotient = find(triangle);
        if (!quotient->holds) return false;
        if (waiting_ == nullptr) {
            waiting_ = quotient;
            waiting_vector_ = vector;
            waiting_triangle_ = triangle;
            return true;
        }
        RoundedRow rounded[2];
        round_quotients<2>(tile_, state_.quotients.parts, {{waiting_vector_, waiting_}, {vector, quotient}},
                           rounded);
        put(waiting_vector_, rounded[0]);
        put(vector, rounded[1]);
        waiting_ = nullptr;
        return true;
    }

    /// Writes what waits.
    HWY_INLINE void finish() { keep_waiting(); }

  private:
    const Quotient* find(Id triangle) {
        return &cached_quotient(tile_, triangle, state_.cache, state_.quotients);
    }
    /// Whether finding the triangle would overwrite the quotient that waits.
    bool waiting_slot_is_of(Id triangle) const {
        return waiting_ != nullptr && triangle != waiting_triangle_ &&
               triangle % kCachedFrames == waiting_triangle_ % kCachedFrames;
    }
    void keep_waiting() {
        if (waiting_ != nullptr) state_.quotients.left.push_back(waiting_vector_);
        waiting_ = nullptr;
    }
    HWY_INLINE void put(std::uint32_t vector, const RoundedRow& row) {
        if (HWY_LIKELY(bits(row.agreed) == kAllLanes))
            stream_hits(row.floats, tile_.scene.vector_hits[vector]);
        else
            state_.quotients.left.push_back(vector);
    }
    HWY_INLINE bool write_both(std::uint32_t vector, const std::array<Id, 2>& triangle, const Mask& second) {
        if (triangle[0] % kCachedFrames == triangle[1] % kCachedFrames) return false;
        if (waiting_slot_is_of(triangle[0]) || waiting_slot_is_of(triangle[1])) keep_waiting();
        const Quotient *const a = find(triangle[0]), *const b = find(triangle[1]);
        if (!a->holds || !b->holds) return false;
        RoundedRow rounded[2];
        round_quotients<2>(tile_, state_.quotients.parts, {{vector, a}, {vector, b}}, rounded);
        put(vector, {choose(second, rounded[1].floats, rounded[0].floats),
                     without(rounded[0].agreed, second) | (rounded[1].agreed & second)});
        return true;
    }

    const TilePlacing& tile_;
    KernelState& state_;
    const Quotient* waiting_ = nullptr;
    std::uint32_t waiting_vector_ = 0;
    Id waiting_triangle_ = kNone;
};

/// Whether the vectors of a tile see no more than `most` triangles, about: by their first samples.
HWY_INLINE bool sees_few(const Nearest* nearest, std::uint32_t vectors, std::uint32_t most) {
    std::array<Id, kCachedFrames> kept;
    kept.fill(kNone);
    std::uint32_t count = 0;
    for (std::uint32_t i = 0; i < vectors && count <= most; ++i) {
        const Id triangle = nearest[i].triangle[0];
        Id& own = kept[triangle % kCachedFrames];
        count += own != triangle;
        own = triangle;
    }
    return count <= most;
}

/// Writes the vectors of a tile, but those that it names as `left`. False: none, they are all faster
/// otherwise. `whole`: what all samples see, or kNone. `next`: the first doubt that may be of the tile.
HWY_NOINLINE bool round_tile(const TilePlacing& tile, const SampleTile& samples, Id whole, std::size_t next,
                             KernelState& state) {
    constexpr std::uint32_t kVectorsPerQuotient = 7;  // measured: their making is not worth fewer
    const std::uint32_t most = samples.vectors / kVectorsPerQuotient;
    if (!tile.scene.hits.empty() || most == 0) return false;
    const Nearest* const nearest = &state.nearest[samples.first_vector - state.first_vector];
    if (whole == kNone && !sees_few(nearest, samples.vectors, most)) return false;
    RoundedWriter writer(tile, state);
    std::vector<std::uint32_t>& left = state.quotients.left;
    left.clear();
    for (std::uint32_t i = 0; i < samples.vectors; ++i) {
        const std::uint32_t vector = samples.first_vector + i, in_group = vector - state.first_vector;
        while (next < state.doubts.size() && state.doubts[next].vector < in_group) ++next;
        const bool doubtful = next < state.doubts.size() && state.doubts[next].vector == in_group;
        if (doubtful ||
            !(whole != kNone ? writer.write_all(vector, whole) : writer.write(vector, nearest[i])))
            left.push_back(vector);
    }
    writer.finish();
    return true;
}

}  // namespace HWY_NAMESPACE
}  // namespace trilens
HWY_AFTER_NAMESPACE();

#endif
