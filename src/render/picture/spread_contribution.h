// What the samples of a fragment see, told by its facet's map, and what textures show over them.
// After: Heckbert, Fundamentals of Texture Mapping and Image Warping, 1989 (footprints).
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "render/picture/fragments.h"
#include "render/picture/sample_colour.h"

namespace trilens {

/// What is seen at one place of a fragment.
struct SeenThere {
    Hit hit;
    Ray ray;
};

/// One contribution to a fragment, with what its samples see.
class SpreadContribution {
  public:
    static constexpr std::size_t kCorners = 4;

    /// A part of a fragment that is lit by itself: where light is asked for, and what pictures show over it.
    struct Part {
        SeenThere there;
        MapTexels texels;
        std::size_t corner = kCorners;  // that it is, in corners(); kCorners: none
    };

    SpreadContribution(const FragmentShading& shading, const ShownFragment& fragment,
                       const Contribution& contribution);

    std::size_t sample_count() const {
        const std::size_t side = static_cast<std::size_t>(shading_.side);
        return fragment_.members.empty() ? side * side : fragment_.members.size();
    }
    /// Place of one of its samples on the film.
    Vec2 place(std::size_t sample) const {
        const int inside = fragment_.members.empty() ? static_cast<int>(sample) : fragment_.members[sample];
        return fragment_.pixel +
               Vec2(inside % shading_.side + 0.5, inside / shading_.side + 0.5) / double(shading_.side);
    }
    std::optional<SeenThere> at(const Vec2& place) const;
    const Contribution& contribution() const { return contribution_; }
    bool is_whole_pixel() const { return fragment_.members.empty(); }
    /// What its outermost samples see, each once: few samples are outermost in several ways.
    std::span<const SeenThere> corners() const { return {corners_.data(), corner_count_}; }
    /// The corners, as numbers in corners(); fewer than kCorners where some see nothing by its map, or it has
    /// one sample.
    std::span<const std::uint8_t> corner_numbers() const { return {numbers_.data(), number_count_}; }
    /// What pictures show in the mean over its samples; none: what they do at the shaded point.
    std::optional<MapTexels> mean_texels() const;
    /// The same over one sample's part of the pixel, of what at() there shows.
    MapTexels sample_texels(const SeenThere& there, const Vec2& place) const {
        return texels_over(there, square(1), map_.differential(place));
    }
    /// The place of a corner.
    const Vec2& corner_place(std::size_t corner) const { return corner_places_[corner]; }
    /// Its samples, each by itself; with a `step` of 2, of a whole pixel whose side is even, blocks of 2 x 2
    /// of them, light at one of the four. Those that see nothing by its map are left out. `plain`: what a
    /// material without pictures shows.
    std::vector<Part> parts(int step, const MapTexels& plain) const;
    /// Sides of the parallelogram on the surface that its samples stand for; null where it is not known.
    const std::array<Vec3, 2>* footprint() const { return footprint_ ? &*footprint_ : nullptr; }

  private:
    MapTexels texels_over(const SeenThere& there, const std::array<Vec2, 2>& sides,
                          const RayDifferential& by_pixel) const;
    bool is_parallelogram(const SeenThere& middle) const;
    void set_means_of_samples(MapTexels& texels) const;
    /// Sides of what so many samples in a row, and as many rows, stand for.
    std::array<Vec2, 2> square(int samples) const {
        const double side = double(samples) / shading_.side;
        return {Vec2(side, 0), Vec2(0, side)};
    }
    void find_footprint();
    void find_corners();
    void find_spread();
    /// Of the way through the last medium, to first order: that at the centroid of the samples.
    void find_mean_length();
    const FragmentShading& shading_;
    const ShownFragment& fragment_;
    Contribution contribution_;
    FacetMap map_;
    // The parallelogram that has the samples' mean and second moments: over a pixel, the pixel.
    Vec2 centroid_{0};
    std::array<Vec2, 2> spread_{Vec2(1, 0), Vec2(0, 1)};  // its sides
    std::array<SeenThere, kCorners> corners_;
    std::array<Vec2, kCorners> corner_places_;
    std::array<std::uint8_t, kCorners> numbers_;
    std::size_t corner_count_ = 0, number_count_ = 0;
    std::optional<std::array<Vec3, 2>> footprint_;
};

}  // namespace trilens
