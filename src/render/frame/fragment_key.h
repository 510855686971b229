// Fragments: the samples of one pixel that see one triangle through one history, told by a hash.
// After: Carpenter, The A-buffer, an Antialiased Hidden Surface Method, 1984; Akeley, RealityEngine Graphics,
// 1993 (visibility per sample, shading once per pixel and primitive).
#pragma once

#include <cstdint>

#include "render/frame/views.h"

namespace trilens {

/// What a sample shows: its first surface (an object's triangle, or an optic), and of each of its paths over
/// the optic the history and the triangle at its end. Samples of one pixel with one key show the same but for
/// where on it. A hash of 64 bits: two that differ have one key in 1 of 10^19 pairs.
using FragmentKey = std::uint64_t;

/// The sample stands for itself alone: only its own paths tell what it shows.
inline constexpr FragmentKey kAlone = 0;

/// The camera has no ray there.
inline constexpr FragmentKey kNoRay = 1;

/// `key`, and then these two. Not for kAlone.
inline FragmentKey joined(FragmentKey key, Id first, Id second) {
    // The finalizer of splitmix64 (Steele, Lea, Flood, Fast Splittable Pseudorandom Number Generators, 2014).
    std::uint64_t x = key * 0x9e3779b97f4a7c15u + (std::uint64_t{first} << 32 | second);
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
    x ^= x >> 31;
    return x > kNoRay ? x : x + 2;
}

/// Of a sample that shows an object itself; kNone: the background.
inline FragmentKey key_of_object(Id triangle) {
    return joined(2, kNone, triangle);
}

/// Of a sample that shows a face of an optic, before its paths are joined in the order of their histories.
inline FragmentKey key_of_optic(Id optic, Id face) {
    return joined(2, optic, face);
}

/// The key of a sample whose views are known; kAlone where its paths were traced or lead over nested optics.
/// `face`: of the optic's surface, where the sample shows one.
FragmentKey fragment_key(const SampleViews& views, const SampleView& view, Id face);

}  // namespace trilens
