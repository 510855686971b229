// The sample positions of a film, the same for projector and truth, and which facet owns each of them.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "base/math/vec.h"
#include "base/util/ids.h"

namespace trilens {

/// A window of pixels [x0, x1) x [y0, y1) of a film, each pixel with side x side samples at the centres of
/// a regular subpixel grid. Samples are numbered pixel by pixel in rows, and inside a pixel in rows.
struct SampleGrid {
    int x0 = 0, y0 = 0, x1 = 0, y1 = 0;  // pixels of the film
    int side = 1;                        // samples along a pixel's edge

    int width() const { return x1 - x0; }
    int height() const { return y1 - y0; }
    std::size_t pixels() const {
        return static_cast<std::size_t>(width()) * static_cast<std::size_t>(height());
    }
    int samples_per_pixel() const { return side * side; }
    std::size_t size() const { return pixels() * static_cast<std::size_t>(samples_per_pixel()); }

    /// The first sample of the pixel (x, y) of the film.
    std::size_t first_sample(int x, int y) const {
        return (static_cast<std::size_t>(y - y0) * static_cast<std::size_t>(width()) +
                static_cast<std::size_t>(x - x0)) *
               static_cast<std::size_t>(samples_per_pixel());
    }
    /// The number that a sample of this window has in `whole`, a grid around it with as many per pixel.
    std::size_t sample_in(const SampleGrid& whole, std::size_t sample) const {
        const std::size_t row =
            static_cast<std::size_t>(width()) * static_cast<std::size_t>(samples_per_pixel());
        return whole.first_sample(x0, y0 + static_cast<int>(sample / row)) + sample % row;
    }
    /// Position of a sample on the film, in pixels from its top left; a pixel's centre is at .5.
    Vec2 position(std::size_t sample) const {
        const std::size_t columns = static_cast<std::size_t>(width());
        if (side == 1)
            return {x0 + static_cast<double>(sample % columns) + 0.5,
                    y0 + static_cast<double>(sample / columns) + 0.5};
        const std::size_t per_pixel = static_cast<std::size_t>(samples_per_pixel());
        const std::size_t pixel = sample / per_pixel, inside = sample % per_pixel;
        const std::size_t s = static_cast<std::size_t>(side);
        return {x0 + static_cast<double>(pixel % columns) + (static_cast<double>(inside % s) + 0.5) / side,
                y0 + static_cast<double>(pixel / columns) + (static_cast<double>(inside / s) + 0.5) / side};
    }
};

/// Samples grouped by facet: those of facet f are sample[first[f]] .. sample[first[f + 1] - 1], ascending.
struct FacetSamples {
    std::vector<std::size_t> first;  // number of facets + 1 entries
    std::vector<Id> sample;          // indices into a SampleGrid

    std::span<const Id> of(std::size_t facet) const {
        return {sample.data() + first[facet], first[facet + 1] - first[facet]};
    }
};

/// Groups samples by owner. `owner`: per sample its facet, or kNone; every facet is below facet_count.
FacetSamples group_by_facet(std::span<const Id> owner, std::size_t facet_count);

}  // namespace trilens
