// Shading once per fragment: light at one point, textures averaged over the fragment's footprint by its
// facet's map. After: Akeley, RealityEngine Graphics, 1993 (multisampling); Heckbert, Fundamentals of Texture
// Mapping and Image Warping, 1989 (footprints).
#pragma once

#include <cstdint>
#include <span>

#include "render/engines/engine.h"
#include "render/picture/sample_colour.h"

namespace trilens {

/// Samples of one pixel that see the same.
struct ShownFragment {
    const SampleView* view = nullptr;  // where it is shaded, an element of the views
    Vec2 pixel{0};                     // top left of the pixel on the film
    // The samples, numbered in rows inside the pixel; empty: all of them.
    std::span<const std::uint16_t> members = {};
};

/// What comes of a fragment.
struct ShadedFragment {
    SampleColour colour;
    std::uint32_t rays_by_sample = 0;  // of its rays, those that were shaded at each sample
};

/// What is needed to shade fragments.
struct FragmentShading {
    const World& world;
    const Viewer& viewer;
    const SampleViews& views;
    int side = 1;  // samples along a pixel's edge
};

/// Colours of fragments, the means over their samples. Where a sample stands is told by its facet's map,
/// drawn inside the triangle that all of them see.
/// - Light is asked for at the shaded point and at the outermost samples, at most four. Where other lights
///   reach those, or light differs by much, each sample is lit by itself; over a whole pixel it is else
///   the mean of the quadratic that goes through them all.
/// - Base colours, and the background's, are means over the parallelogram that has the mean and the second
///   moments of its samples, as the facet's map carries it to the texture.
/// - Weights (Fresnel, glass on the way) are those of the shaded point; the way through the last glass is
///   that of the centroid.
/// shaded.size() == fragments.size().
void shade_fragments(const FragmentShading& shading, std::span<const ShownFragment> fragments,
                     std::span<ShadedFragment> shaded);

}  // namespace trilens
