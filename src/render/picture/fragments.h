// Shading once per fragment: light at one point, textures averaged over the fragment's footprint by its
// facet's map. After: Akeley, RealityEngine Graphics, 1993 (multisampling); Heckbert, Fundamentals of Texture
// Mapping and Image Warping, 1989 (footprints).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/util/error.h"
#include "base/util/parallel.h"
#include "render/engines/engine.h"
#include "render/picture/channels.h"
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
    int side = 1;                               // samples along a pixel's edge
    const std::atomic<bool>* cancel = nullptr;  // see Receiver
};

/// Colours of fragments, the means over their samples. Where a sample stands is told by its facet's map,
/// drawn inside the triangle that all of them see.
/// - Fragments of up to five samples are lit at each, where no light comes over optics. Of the others light
///   is asked for at the shaded point and at the outermost samples, at most four. Where other lights of one
///   sample reach those, or light differs by much, each sample is lit by itself, with what its textures show
///   there; where it differs by less, blocks of 2 x 2 samples are. Over a whole pixel it is else the mean of
///   the quadratic that goes through them all.
/// - Base colours, and the background's, are means over the parallelogram that the facet's map carries a
///   pixel to; where that bends, or the fragment is a part of a pixel, the mean of its samples' squares.
/// - Weights (Fresnel, glass on the way) are those of the shaded point; the way through the last glass is
///   that of the centroid.
/// shaded.size() == fragments.size().
void shade_fragments(const FragmentShading& shading, std::span<const ShownFragment> fragments,
                     std::span<ShadedFragment> shaded);

// Multisampling: visibility per sample, shading once per fragment, for a window of pixels.
// After: Akeley, RealityEngine Graphics, 1993.

/// How the samples of pixels were shaded.
struct FragmentCounts {
    std::size_t pixels = 0, fragments = 0;
    std::size_t by_sample = 0;         // rays of fragments that had to be shaded at each sample
    std::size_t pixels_by_sample = 0;  // that have such rays
};

/// Where it is told that pixels are shaded.
struct ShadedPixels {
    LoopProgress* progress = nullptr;  // null: nobody is told
    double of_pixel = 0;               // what a pixel counts there

    void add(double pixels) const {
        if (progress) progress->add(of_pixel * pixels);
    }
};

/// What pixels are made of. What is made of them throws Interrupted soon after the progress is cancelled.
struct PixelSource {
    const World& world;
    Viewer& viewer;
    const PixelFilter& filter;
    const Progress& progress;
    ShadedPixels shaded = {};
};

/// The colours of all fragments in a window and the pixels around it that a filter reaches.
class FragmentColours {
  public:
    /// `window`: with the samples of a pixel that the film has, in any order. The source's viewer has keys;
    /// all of the source must outlive this.
    FragmentColours(const PixelSource& source, const SampleGrid& window);

    /// The pixel of the window as the filter makes it. Pixels beyond the film have no samples: the weights of
    /// those that there are count as one.
    SampleColour colour(int x, int y) const;

    /// Fragments of that pixel.
    std::size_t count_at(int x, int y) const {
        const std::size_t pixel = pixel_at(x, y);
        return first_[pixel + 1] - first_[pixel];
    }

    const FragmentCounts& counts() const { return counts_; }

    /// What the middles of the pixels show: of the window where the filter reaches no other pixel.
    const SampleViews& centres() const { return centres_; }

  private:
    struct Fragment {
        Id sample = kNone;  // of the lattice, where it is shaded; kNone: at the pixel's centre
        std::uint32_t first_member = 0;
        std::uint32_t members = 0;  // in members_; 0: all of the pixel's samples
    };
    struct PixelRow;
    class OpenPixels;

    void find_fragments(const OpenPixels& open);
    void split_pixel(std::size_t pixel, PixelRow& row) const;
    void shade_centres();
    void shade_samples();
    std::span<const std::uint16_t> members_of(const Fragment& fragment) const {
        return {members_.data() + fragment.first_member, fragment.members};
    }
    Vec2 pixel_corner(std::size_t pixel) const;
    std::size_t pixel_at(int x, int y) const {
        return static_cast<std::size_t>(y - grid_.y0) * static_cast<std::size_t>(grid_.width()) +
               static_cast<std::size_t>(x - grid_.x0);
    }
    void count_rays_by_sample();
    std::size_t lattice_sample(std::size_t pixel, int inside) const;

    const World& world_;
    Viewer& viewer_;
    const PixelFilter& filter_;
    const Progress& progress_;
    ShadedPixels progress_shaded_;
    double pixels_per_fragment_ = 0;
    SampleGrid grid_;  // in lattice order
    SampleViews centres_;
    std::vector<std::size_t> first_;  // per pixel of the grid, and one more: in fragments_
    std::vector<Fragment> fragments_;
    std::vector<std::uint16_t> members_;
    std::vector<ShadedFragment> shaded_;  // per fragment
    FragmentCounts counts_;
};

}  // namespace trilens
