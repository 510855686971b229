// Adaptive sampling of an exact map on a lattice of pixels: a quadtree of Hermite patches (Coons patches
// whose edges are cubic), each checked at its middle, down to single pixels where the map is not smooth.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "base/math/vec.h"
#include "base/util/error.h"
#include "base/util/ids.h"

namespace trilens {

/// One value of a map at a place of its lattice: a position elsewhere, as of a world point's image on a film.
struct MapImage {
    Vec2 position{0};
    Mat2 jacobian{0};           // columns: how the position moves with the place's x, and with its y
    Vec3 weight{1};             // what goes with it and is interpolated linearly
    std::uint64_t history = 0;  // values continue one another only where these are equal
};
using MapImages = std::vector<MapImage>;

/// Exact values at places (pixels from the top left, centres at .5): images[i] gets those of places[i], none
/// where the map has none there. Called from one thread.
using EvaluateMap = std::function<void(std::span<const Vec2> places, std::span<MapImages> images)>;

struct MapLattice {
    int width = 1, height = 1;
    int cell = 8;             // pixels between the first nodes
    double tolerance = 0.01;  // that the positions of a patch may be off, in their own unit
};

/// What a map of one value at most is in the middle of every pixel, rows from the top, where that was asked
/// beforehand: histories, 0 where it has no value, and positions. The lattice then gives the derivatives.
struct KnownPixels {
    std::span<const float> x, y;
    std::span<const std::uint64_t> history;

    bool empty() const { return history.empty(); }
};

/// A cell whose nodes a patch joins, and the patch's images at a place in it.
struct CellImages {
    int x0 = 0, y0 = 0, x1 = 0, y1 = 0;  // pixels of its corners, inclusive
    std::function<void(const Vec2& place, MapImages& images)> at;
};

/// Whether a patch that is within the tolerance may stand, or is divided. Called from several threads.
using JudgePatch = std::function<bool(const CellImages& cell)>;

/// What else is known of a map than what is evaluated.
struct MapChecks {
    KnownPixels known = {};
    JudgePatch judge = {};  // none: all stand
};

/// A map known at every pixel centre of a lattice: exactly, or between exact ones to the tolerance (as found
/// at the middle of each patch, to half of it; the error of a patch falls with the fourth power of its size).
/// A patch that is off what its sides' places were found to be, where finer cells lie beside it, is divided,
/// too: what is found at one pixel is followed as far as it goes on from pixel to pixel. What is smaller than
/// a cell and shows at none of its corners nor in its middle is missed where no judge refuses the patch,
/// unless all pixels are known beforehand: a patch then has the histories of all its pixels, and is within
/// half of the tolerance (or as near as floats can tell) at each.
class SampledMap {
  public:
    /// Throws Interrupted once `progress` says so, and what `evaluate` throws. `checks` must
    /// outlive the call only.
    SampledMap(const MapLattice& lattice, const EvaluateMap& evaluate, const Progress& progress = {},
               const MapChecks& checks = {});

    int width() const { return lattice_.width; }
    int height() const { return lattice_.height; }
    std::size_t exact_count() const { return images_.size(); }  // places that were evaluated
    double worst_accepted() const { return worst_; }            // where patches were held against the map

    /// Calls use(x, y, images) once for every pixel, from several threads; the images in the order of the
    /// patch's first corner. The span is valid during the call only.
    void for_each_pixel(const std::function<void(int x, int y, std::span<const MapImage> images)>& use) const;

    /// The same, pixel by pixel of one map that has one value at most: `width * height`, rows from the top.
    struct Pixel {
        bool known = false;
        MapImage image;
    };
    std::vector<Pixel> pixels() const;

  private:
    struct Cell {  // nodes at its corners, inclusive
        int x0 = 0, y0 = 0, x1 = 0, y1 = 0;
        std::array<Id, 4> sample{kNone, kNone, kNone,
                                 kNone};  // of images_: (x0,y0), (x1,y0), (x0,y1), (x1,y1)
    };
    struct Patch;

    bool is_exact(const Cell& cell) const { return cell.x1 - cell.x0 <= 1 && cell.y1 - cell.y0 <= 1; }
    std::size_t pixel_at(int x, int y) const {
        return static_cast<std::size_t>(y) * static_cast<std::size_t>(lattice_.width) +
               static_cast<std::size_t>(x);
    }
    /// Squares of first cells: where something was evaluated since the cells were last held against it.
    std::size_t block_at(int x, int y) const {
        const int step = std::max(1, lattice_.cell);
        return static_cast<std::size_t>(y / step) * static_cast<std::size_t>(lattice_.width / step + 1) +
               static_cast<std::size_t>(x / step);
    }
    std::size_t block_count() const { return block_at(lattice_.width - 1, lattice_.height - 1) + 1; }

    void settle(std::vector<Cell> cells, const EvaluateMap& evaluate, const MapChecks& checks,
                const Progress& progress);
    static void divide(const Cell& cell, std::vector<Cell>& into);
    std::vector<Cell> take_contradicted();
    bool is_contradicted(const Cell& cell) const;
    void evaluate_level(std::vector<Cell>& cells, const EvaluateMap& evaluate, bool with_middles);
    double error_of(const Cell& cell, const MapChecks& checks) const;
    double error_at_middle(const Cell& cell) const;
    double error_of_pixels(const Cell& cell, const KnownPixels& known) const;

    MapLattice lattice_;
    std::vector<MapImages> images_;
    std::vector<Id> at_;  // per pixel: its entry in images_; emptied once the cells are settled
    std::vector<Cell> settled_;
    std::vector<unsigned char> fresh_;  // per block; emptied likewise
    double settled_pixels_ = 0;
    double worst_ = 0;
};

// Resolution of a map: the singular values of its derivative, per unit of what it maps from.

struct Resolution {
    double least = 0, most = 0;  // in the direction that is resolved worst, and best
};

/// The singular values of a 2 x 2 matrix.
inline Resolution singular_values(const Mat2& a) {
    const double squares = dot(a[0], a[0]) + dot(a[1], a[1]);
    const double determinant = a[0].x * a[1].y - a[1].x * a[0].y;
    const double root = std::sqrt(std::max(0.0, squares * squares - 4 * determinant * determinant));
    const double most = std::sqrt(0.5 * (squares + root));
    return {most > 0 ? std::fabs(determinant) / most : 0, most};
}

/// Of one image or more, the one whose derivative has the largest smaller singular value.
inline const MapImage& best_resolved(std::span<const MapImage> images) {
    const MapImage* best = &images[0];
    if (images.size() == 1) return *best;
    double most = singular_values(best->jacobian).least;
    for (const MapImage& image : images.subspan(1))
        if (const double least = singular_values(image.jacobian).least; least > most)
            best = &image, most = least;
    return *best;
}

/// Of a map with this jacobian per pixel, where a pixel's sides are the tangent vectors dx and dy: pixels of
/// the map's range per unit of length along the tangent plane. Zero where the sides are parallel.
inline Resolution resolution_of(const Mat2& jacobian, const Vec3& dx, const Vec3& dy) {
    const double r11 = length(dx);
    if (!(r11 > 0)) return {};
    const double r12 = dot(dx, dy) / r11, r22 = length(cross(dx, dy)) / r11;  // (dx dy) = Q R
    if (!(r22 > 0)) return {};
    const Vec2 first = jacobian[0] / r11;
    return singular_values(Mat2(first, (jacobian[1] - r12 * first) / r22));
}

}  // namespace trilens
