// Multisampling: visibility per sample, shading once per fragment, for a window of pixels.
// After: Akeley, RealityEngine Graphics, 1993.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "render/engines/engine.h"
#include "render/picture/fragment_shader.h"
#include "render/picture/pixel_filter.h"

namespace trilens {

/// How the samples of pixels were shaded.
struct FragmentCounts {
    std::size_t pixels = 0, fragments = 0;
    std::size_t by_sample = 0;         // rays of fragments that had to be shaded at each sample
    std::size_t pixels_by_sample = 0;  // that have such rays
};

/// The colours of all fragments in a window and the pixels around it that a filter reaches.
class FragmentColours {
  public:
    /// `window`: with the samples of a pixel that the film has, in any order. `viewer` has keys.
    FragmentColours(const World& world, Viewer& viewer, const SampleGrid& window, const PixelFilter& filter);

    /// The pixel of the window as the filter makes it. Pixels beyond the film have no samples: the weights of
    /// those that there are count as one.
    SampleColour colour(int x, int y) const;

    /// Fragments of that pixel.
    std::size_t count_at(int x, int y) const {
        const std::size_t pixel = pixel_at(x, y);
        return first_[pixel + 1] - first_[pixel];
    }

    const FragmentCounts& counts() const { return counts_; }

  private:
    struct Fragment {
        Id sample = kNone;  // of the lattice, where it is shaded; kNone: at the pixel's centre
        std::uint32_t first_member = 0;
        std::uint32_t members = 0;  // in members_; 0: all of the pixel's samples
    };
    struct PixelRow;

    void find_fragments();
    void split_pixel(std::size_t pixel, std::span<const FragmentKey> keys, PixelRow& row) const;
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
    SampleGrid grid_;  // in lattice order
    SampleViews centres_;
    std::vector<std::size_t> first_;  // per pixel of the grid, and one more: in fragments_
    std::vector<Fragment> fragments_;
    std::vector<std::uint16_t> members_;
    std::vector<ShadedFragment> shaded_;  // per fragment
    FragmentCounts counts_;
};

}  // namespace trilens
