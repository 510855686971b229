// What every sample shows, found by projection or by ray tracing: one record for all engines.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/util/overwritten.h"
#include "paths/trace/follow.h"
#include "shade/optic_weights.h"
#include "volume/volume_integral.h"

namespace trilens {

/// What one sample shows first, and where the ends of its paths over optics are.
struct SampleView {
    Ray ray;              // the camera's
    Hit hit;              // of World::objects; unset where an optic is nearer
    double depth = 1e30;  // t along `ray` of whatever is first; distance along the view axis

    Id camera_facet = kNone;  // of the camera's RayMesh; kNone: `ray` is no facet's
    Id optic = kNone;         // index into World::optics; then SampleViews::on_optic has more
    Id facet = kNone;         // of the optic's grid; limit truth: face of the surface
    Id around = kNone;        // what `ray` starts in, of SampleViews::around; kNone: air

    Id leaf = kNone;          // of its optic's OpticPaths; limit truth: none
    bool traced = false;      // its own paths were followed, those of no facet
    bool unsure = false;      // the exact surfaces may come in another order than the facets
    std::uint8_t level = 0;   // how often its facet was divided
    std::uint8_t nested = 0;  // nested optics that lie over its facet
};

/// More of a sample that shows an optic.
struct OpticView {
    Vec2 uv{0};            // in the facet's face
    Incidence incidence;   // of the camera's ray at the optic
    double way = 0;        // of a ray that does not start in air: its length to the optic, scene units
    double predicted = 0;  // displacement that its facet may have, pixels, where an error was asked for

    double bound = 0;  // the same as proven, where that was asked for; 0 of traced samples

    CutPaths cut;  // what was not followed: of projected samples the most of the whole optic, but for `faint`
    Vec3 deep{0};  // of its facet or its own path alone: light that would go on after the last optic

    std::size_t first_end = 0;  // of SampleViews::ends
    std::size_t end_count = 0;  // 0: no path from there has a ray
};

/// Colours of one sample, linear Rec.709; the three parts add up to the beauty.
struct SampleColour {
    Vec3 direct{0}, reflect{0}, refract{0};
    double coverage = 0;  // 1 where a mesh is seen, 0 on the background
};

/// What volumes and blended surfaces add to a sample.
struct SampleVolumes {
    VolumeLight first;  // between where the camera's ray starts and what the sample shows first
    // Emission along the paths' later legs, summed, in shares of the light that leaves the first optic.
    Vec3 reflect{0}, refract{0};
};

/// What the samples of a grid show.
struct SampleViews {
    std::vector<SampleView> samples;     // one per sample
    Overwritten<OpticView> of_optics;    // one per sample; where it shows no optic it holds anything
    std::vector<PathEnd> ends;           // of all samples, those of one side by side
    std::vector<Step> steps;             // of all ends; ends with one history may share theirs
    std::vector<Media> around;           // that rays of the camera start in
    std::vector<SampleVolumes> volumes;  // one per sample; empty: the world has neither
    std::size_t projected_facets = 0;    // facets and parts of facets that the optics have by now
    std::size_t crowded_out = 0;         // facets that are traced for want of room
    double outline_pixels =
        0;  // pixels that lie between optics' outlines and those of their facets, predicted
    double outline_error = 0;  // pixels: how far these may be off, where an error was asked for
    bool depth_by_length = false;  // depths are in lengths of rays' directions, which may be any (rayMesh)

    // `sample`: an element of samples.
    /// What it shows on its optic; not to be read where it shows none.
    OpticView& on_optic(const SampleView& sample) {
        return of_optics[static_cast<std::size_t>(&sample - samples.data())];
    }
    const OpticView& on_optic(const SampleView& sample) const {
        return of_optics[static_cast<std::size_t>(&sample - samples.data())];
    }
    std::span<const PathEnd> ends_of(const SampleView& sample) const {
        if (sample.optic == kNone) return {};
        const OpticView& shown = on_optic(sample);
        return {ends.data() + shown.first_end, shown.end_count};
    }
    std::span<const Step> steps_of(const PathEnd& end) const {
        return {steps.data() + end.first_step, end.step_count};
    }
    /// Its depth in scene units: along the view axis where the camera has one, else along the ray.
    double scene_depth(const SampleView& sample) const {
        return depth_by_length ? sample.depth * length(sample.ray.direction) : sample.depth;
    }
    /// Null where the world has no volumes.
    const SampleVolumes* volumes_of(const SampleView& sample) const {
        return volumes.empty() ? nullptr : &volumes[static_cast<std::size_t>(&sample - samples.data())];
    }
    Media around_of(const SampleView& sample) const {
        return sample.around == kNone ? Media() : around[sample.around];
    }
    /// The sample's principal end on this path; null where it has none.
    const PathEnd* find(const SampleView& sample, Path path) const;

    /// What that end sees; an unset hit where there is no such end.
    Hit hit(const SampleView& sample, Path path) const {
        const PathEnd* end = find(sample, path);
        return end ? end->hit : Hit();
    }

    /// `count` samples that show nothing.
    void reset(std::size_t count);
    /// The same but for the samples themselves, which hold anything until they are set.
    void restart(std::size_t count);
};

// Fragments: the samples of one pixel that see one triangle through one history, told by a hash.
// After: Carpenter, The A-buffer, an Antialiased Hidden Surface Method, 1984; Akeley, RealityEngine Graphics,
// 1993 (visibility per sample, shading once per pixel and primitive).

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
