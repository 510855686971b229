// Writes results: one hit per sample, two samples of a vector at a time.
// Included once per instruction set.
#if defined(TRILENS_KERNEL_WRITE_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef TRILENS_KERNEL_WRITE_INL_H
#undef TRILENS_KERNEL_WRITE_INL_H
#else
#define TRILENS_KERNEL_WRITE_INL_H
#endif

#include <algorithm>
#include <bit>
#include <cstddef>

#include "projector/kernel/kernel_gather-inl.h"
#include "projector/kernel/kernel_scene.h"

HWY_BEFORE_NAMESPACE();
namespace trilens {
namespace HWY_NAMESPACE {

HWY_INLINE void set_lane(Placed& placed, std::size_t lane, const Hit& hit) {
    placed.triangle[lane] = hit.triangle;
    placed.t[lane] = hit.t;
    placed.second[lane] = hit.barycentric.x;
    placed.third[lane] = hit.barycentric.y;
}

/// Lane k alone.
HWY_INLINE void write_sample(const Placed& placed, std::size_t k, Hit& to) {
    to = {placed.triangle[k], placed.t[k], {placed.second[k], placed.third[k]}};
}

/// Lanes k and k + 1: each hit in two stores, so that few of them wait for the memory.
HWY_INLINE void write_two_samples(const Placed& placed, std::size_t k, Hit* const (&to)[2]) {
    static_assert(std::endian::native == std::endian::little);
    static_assert(sizeof(Hit) == 4 * sizeof(double) && offsetof(Hit, t) == sizeof(double) &&
                  offsetof(Hit, barycentric) == 2 * sizeof(double));
    const PairTag pair;
    const hn::Rebind<std::uint64_t, PairTag> word;
    const Pair id = hn::BitCast(pair, hn::PromoteTo(word, hn::LoadU(hn::Rebind<std::uint32_t, PairTag>(),
                                                                    placed.triangle + k))),
               t = hn::Load(pair, placed.t + k), second = hn::Load(pair, placed.second + k),
               third = hn::Load(pair, placed.third + k);
    double* const first[2] = {reinterpret_cast<double*>(to[0]), reinterpret_cast<double*>(to[1])};
    const auto put = [](const Pair& low, const Pair& high, double* at) HWY_ATTR {
#if HWY_MAX_BYTES >= 32
        const hn::FixedTag<double, 4> four;
        hn::StoreU(hn::Combine(four, high, low), four, at);
#else
        hn::StoreU(low, PairTag(), at);
        hn::StoreU(high, PairTag(), at + 2);
#endif
    };
    put(hn::InterleaveLower(pair, id, t), hn::InterleaveLower(pair, second, third), first[0]);
    put(hn::InterleaveUpper(pair, id, t), hn::InterleaveUpper(pair, second, third), first[1]);
}

/// What write_samples() will write of a vector.
HWY_INLINE void prefetch_hits(const KernelScene& scene, std::size_t vector) {
    const VectorSamples& samples = scene.tiles->samples[vector];
    for (std::size_t k = 0; k < kLanes; ++k) hwy::Prefetch(&scene.hits[samples.sample[k]]);
}

/// The hits of a vector's samples, in their places among all samples.
HWY_NOINLINE void write_samples(const KernelScene& scene, std::uint32_t vector, const Placed& placed) {
    constexpr std::size_t kAhead = 8;  // vectors, measured
    prefetch_hits(scene, std::min<std::size_t>(vector + kAhead, scene.tiles->samples.size() - 1));
    const VectorSamples& samples = scene.tiles->samples[vector];
    Hit* const hits = scene.hits.data();
    const std::size_t count = static_cast<std::size_t>(std::popcount(scene.tiles->valid[vector]));
    std::size_t k = 0;
    for (; k + 1 < count; k += 2)
        write_two_samples(placed, k, {hits + samples.sample[k], hits + samples.sample[k + 1]});
    if (k < count) write_sample(placed, k, hits[samples.sample[k]]);
}

/// A vector as floats: enough to tell which lanes are trusted.
struct PlacedFloats {
    Floats t, second, third;
    Words triangle;
};

HWY_INLINE PlacedFloats narrow(const Placed& placed) {
    return {narrow(load_doubles(placed.t)), narrow(load_doubles(placed.second)),
            narrow(load_doubles(placed.third)), load_words(placed.triangle)};
}

/// Lanes whose values place() gives too: trusted, and inside by more than doubles and floats round.
HWY_INLINE Mask sound(const PlacedFloats& placed) {
    constexpr float kInside = 1e-6f;
    const Floats least_weight =
        least(least(placed.second, placed.third), set(1.0f) - placed.second - placed.third);
    return (least_weight > set(kInside)) & (absolute(placed.t) < set(kNever));
}

}  // namespace HWY_NAMESPACE
}  // namespace trilens
HWY_AFTER_NAMESPACE();

#endif
