// The sample positions of a film, the same for projector and truth, and which facet owns each of them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "base/math/vec.h"
#include "base/raymesh/ray_mesh.h"
#include "base/raymesh/triangle_scene.h"
#include "base/util/ids.h"

namespace trilens {

/// How the samples of a grid are numbered: pixel by pixel in rows, and inside a pixel in rows; or in rows of
/// the lattice that the samples of all pixels make.
enum class SampleOrder : std::uint8_t { kPixels, kLattice };

/// A window of pixels [x0, x1) x [y0, y1) of a film, each pixel with side x side samples at the centres of
/// a regular subpixel grid.
struct SampleGrid {
    int x0 = 0, y0 = 0, x1 = 0, y1 = 0;  // pixels of the film
    int side = 1;                        // samples along a pixel's edge
    SampleOrder order = SampleOrder::kPixels;
    // Of kLattice: the only samples that there are, ascending numbers of the lattice; the grid's own numbers
    // are places in this list, which must live longer. Empty: all.
    std::span<const Id> chosen = {};

    int width() const { return x1 - x0; }
    int height() const { return y1 - y0; }
    std::size_t pixels() const {
        return static_cast<std::size_t>(width()) * static_cast<std::size_t>(height());
    }
    int samples_per_pixel() const { return side * side; }
    std::size_t size() const {
        return chosen.empty() ? pixels() * static_cast<std::size_t>(samples_per_pixel()) : chosen.size();
    }

    /// Whether numbers count on along the rows of the lattice.
    bool in_rows() const { return (side == 1 || order == SampleOrder::kLattice) && chosen.empty(); }
    /// Samples in a row of the lattice, and its rows.
    std::size_t columns() const { return static_cast<std::size_t>(width() * side); }
    std::size_t rows() const { return static_cast<std::size_t>(height() * side); }
    /// The grid's samples as so many runs of numbers, all of one length, each within one row of pixels.
    std::size_t runs() const {
        return !chosen.empty()                  ? 1
               : order == SampleOrder::kLattice ? rows()
                                                : static_cast<std::size_t>(height());
    }

    /// The number of a place of the lattice; not of a grid with chosen samples.
    std::size_t sample_at(std::size_t column, std::size_t row) const {
        if (in_rows()) return row * columns() + column;
        const std::size_t s = static_cast<std::size_t>(side);
        return (row / s * static_cast<std::size_t>(width()) + column / s) * s * s + row % s * s + column % s;
    }
    /// The first sample of the pixel (x, y) of the film; not of a grid with chosen samples.
    std::size_t first_sample(int x, int y) const {
        return sample_at(static_cast<std::size_t>((x - x0) * side),
                         static_cast<std::size_t>((y - y0) * side));
    }
    /// The number that a sample of this window has in `whole`, a grid around it with as many per pixel in the
    /// same order, and with the same samples where they are chosen.
    std::size_t sample_in(const SampleGrid& whole, std::size_t sample) const {
        if (!chosen.empty()) return sample;
        const std::size_t row = size() / runs();
        const std::size_t first = static_cast<std::size_t>((x0 - whole.x0) * (side));
        const std::size_t pixel_rows = static_cast<std::size_t>(y0 - whole.y0);
        if (order == SampleOrder::kLattice)
            return (pixel_rows * static_cast<std::size_t>(side) + sample / row) * whole.columns() + first +
                   sample % row;
        return (pixel_rows + sample / row) * whole.columns() * static_cast<std::size_t>(side) +
               first * static_cast<std::size_t>(side) + sample % row;
    }
    /// Position of a sample on the film, in pixels from its top left; a pixel's centre is at .5.
    Vec2 position(std::size_t sample) const {
        if (side == 1 && chosen.empty())
            return {x0 + static_cast<double>(sample % columns()) + 0.5,
                    y0 + static_cast<double>(sample / columns()) + 0.5};
        const std::size_t s = static_cast<std::size_t>(side);
        if (order == SampleOrder::kLattice) {
            const std::size_t number = chosen.empty() ? sample : chosen[sample];
            const std::size_t column = number % columns(), row = number / columns();
            return {x0 + static_cast<double>(column / s) + (static_cast<double>(column % s) + 0.5) / side,
                    y0 + static_cast<double>(row / s) + (static_cast<double>(row % s) + 0.5) / side};
        }
        const std::size_t per_pixel = s * s, across = static_cast<std::size_t>(width());
        const std::size_t pixel = sample / per_pixel, inside = sample % per_pixel;
        return {x0 + static_cast<double>(pixel % across) + (static_cast<double>(inside % s) + 0.5) / side,
                y0 + static_cast<double>(pixel / across) + (static_cast<double>(inside / s) + 0.5) / side};
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

// What callers hand in, looked at before it is used: sample grids, RayMeshes, triangles.

/// Numbers beyond this are taken for mistakes: products of four still fit in a double. As kLargestCoordinate
/// of scenes.
inline constexpr double kLargestNumber = 1e30;

/// Whether all three are numbers within kLargestNumber.
inline bool is_coordinate(const Vec3& v) {
    return glm::abs(v.x) <= kLargestNumber && glm::abs(v.y) <= kLargestNumber &&
           glm::abs(v.z) <= kLargestNumber;
}

/// What one SampleGrid may have at most: samples are counted with whole numbers of 31 bits.
inline constexpr std::size_t kMostSamples = 2147483647;
inline constexpr int kFarthestPixel = 1 << 30;  // from the film's top left, either way

/// Throws InputError (place "grid") unless the grid has samples, at most kMostSamples, of pixels within
/// kFarthestPixel.
void check_sample_grid(const SampleGrid& grid);

/// Throws InputError with the place of the first thing that makes it no RayMesh: "screen" where there is not
/// one entry per ray, "rays/3", "screen/3" for what is not finite or beyond kLargestNumber (of a screen
/// position also where it is not zero, but all of it within 1 / kLargestNumber), "facets/3" for a corner that
/// there is not.
void check_ray_mesh(const RayMesh& mesh);

/// Throws InputError (place "facets/3", "screen") unless all corners of its facets with rays are there,
/// whatever numbers they have.
void check_facet_corners(const RayMesh& mesh);

/// Throws InputError with the place of the first thing that makes them no scene: "object", "primitive" where
/// there is not one entry per triangle, "points/3" for what is not finite or beyond kLargestNumber,
/// "triangles/3" for a corner that is no point.
void check_triangle_scene(const TriangleScene& scene);

}  // namespace trilens
