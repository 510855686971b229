// Light that comes over rough mirrors and glass, gathered over the microfacets that a sample sees.
// After: Cook, Porter, Carpenter, Distributed Ray Tracing, SIGGRAPH 1984; Heitz, Sampling the GGX
// Distribution of Visible Normals, JCGT 2018; Igehy, Tracing Ray Differentials, SIGGRAPH 1999 (footprints).
#pragma once

#include <cstddef>
#include <functional>
#include <optional>

#include "base/util/error.h"
#include "render/frame/request.h"
#include "render/picture/fragments.h"
#include "render/picture/sample_colour.h"

namespace trilens {

/// How it is gathered at one sample or fragment.
struct RoughGather {
    std::size_t ways = 1;   // of a path over rough optics, each with one microfacet at each of them
    std::size_t shift = 0;  // see RoughWay
    // Whether each way stands for its share of what the microfacets reflect, over which pictures are
    // averaged; else it is a ray.
    bool is_filtered = true;
    // Of the part of the film that the sample stands for: what it makes of the ray of one of the ends that
    // smooth optics would show, per unit of its direction as it is. Unset: nothing.
    std::function<std::optional<RayDifferential>(const PathEnd&)> differential = {};
    const std::atomic<bool>* cancel = nullptr;  // see Receiver
};

/// Whether the sample shows a rough optic, or one in which smooth optics would show it a rough one.
bool meets_rough_optic(const World& world, const SampleViews& views, const SampleView& view);

/// What moves the points of a pixel's microfacets: the pixel's place in a square of four by four, and the
/// sample's in the pixel.
std::size_t rough_shift(const Vec2& place, int side);

/// How many ways each sample of a film of side x side a pixel has: `traced`: of pictures that are traced,
/// which count them by pixels.
std::size_t rough_ways(const RenderSettings& settings, bool traced, int side);

/// The sample's colour with all light of its optics gathered: for each way the paths from the optic's exact
/// surface on, over optics as deep as the scene follows them, each turned by a microfacet at each rough
/// optic. None where the camera's ray misses the exact surface.
std::optional<SampleColour> rough_colour(const World& world, const SampleViews& views, const SampleView& view,
                                         const RoughGather& gather);

/// Sets the colour of a fragment that shows a rough optic. Returns false, and leaves it, where it shows none.
bool shade_rough(const FragmentShading& shading, const ShownFragment& fragment, SampleColour& colour);

/// Says what roughness is left out of.
void warn_of_roughness(const World& world, const FrameParams& frame, const EngineChoice& engine,
                       const Warn& warn);

}  // namespace trilens
