// The samples of a grid as one lattice of columns and rows, whatever the number of samples in a pixel.
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "base/raymesh/ray_mesh.h"
#include "base/raymesh/sample_grid.h"
#include "base/util/ids.h"
#include "projector/exact/exact_hit.h"
#include "projector/scene/bvh.h"

namespace trilens {

/// Where a sample stands, from the window's corner.
struct LatticeSample {
    int column = 0, row = 0;
};

/// A rectangle of the lattice, first and last line each way.
struct LatticeExtent {
    int x0 = INT32_MAX, x1 = 0, y0 = INT32_MAX, y1 = 0;

    void include(const LatticeSample& s) {
        x0 = std::min(x0, s.column), x1 = std::max(x1, s.column);
        y0 = std::min(y0, s.row), y1 = std::max(y1, s.row);
    }
};

/// Finds samples that come in ascending order: neighbours in a row without a division.
class LatticeWalk {
  public:
    explicit LatticeWalk(const SampleGrid& grid)
        : width_(static_cast<Id>(
              grid.order == SampleOrder::kLattice ? grid.columns() : static_cast<std::size_t>(grid.width()))),
          side_(static_cast<Id>(grid.order == SampleOrder::kLattice ? 1 : grid.side)),
          per_pixel_(side_ * side_),
          chosen_(grid.chosen) {}

    LatticeSample at(Id sample) {
        if (!chosen_.empty()) sample = chosen_[sample];
        if (side_ == 1) {
            move_to_row_of(sample);
            return {static_cast<int>(sample - row_start_), static_cast<int>(row_)};
        }
        const Id pixel = sample / per_pixel_, inside = sample % per_pixel_;
        move_to_row_of(pixel);
        return {static_cast<int>((pixel - row_start_) * side_ + inside % side_),
                static_cast<int>(row_ * side_ + inside / side_)};
    }

  private:
    void move_to_row_of(Id pixel) {
        if (pixel - row_start_ < width_) return;
        row_ = pixel / width_;
        row_start_ = row_ * width_;
    }

    Id width_, side_, per_pixel_;
    std::span<const Id> chosen_;
    Id row_ = 0, row_start_ = 0;  // of pixels; the row's first pixel
};

/// Neighbours in a row: `sample` at `first`, and the count - 1 after it.
struct LatticeRun {
    LatticeSample first;
    int count = 1;
    Id sample = 0;

    LatticeSample last() const { return {first.column + count - 1, first.row}; }
};

/// Calls body for runs of all the samples, which ascend. Where numbers count on along rows and the samples
/// are many, the runs are as long as they can be, and found by their ends; else each sample is one.
template <typename Body>
void for_each_run(const SampleGrid& grid, std::span<const Id> samples, const Body& body) {
    constexpr std::size_t kMany = 100;  // measured
    LatticeWalk walk(grid);
    const bool long_runs = grid.in_rows() && samples.size() >= kMany;
    std::size_t count = 1;
    for (std::size_t i = 0; i < samples.size(); i += count) {
        LatticeRun run{walk.at(samples[i]), 1, samples[i]};
        if (long_runs) {
            const std::size_t most =
                std::min(samples.size() - i, grid.columns() - static_cast<std::size_t>(run.first.column));
            const auto follow = [&](std::size_t n) { return samples[i + n - 1] - samples[i] == n - 1; };
            // A row is about as long as the one before.
            count = std::min(count, most);
            while (!follow(count)) --count;
            while (count < most && follow(count + 1)) ++count;
            run.count = static_cast<int>(count);
        } else if (!grid.chosen.empty()) {
            // Chosen samples ascend: neighbours in a row have numbers that follow each other in both ways.
            const std::size_t left = std::min(
                samples.size() - i, grid.columns() - static_cast<std::size_t>(run.first.column));
            const Id place = grid.chosen[samples[i]];
            for (count = 1; count < left && samples[i + count] - samples[i] == count &&
                            grid.chosen[samples[i + count]] - place == count;)
                ++count;
            run.count = static_cast<int>(count);
        }
        body(run);
    }
}

// The samples of a RayMesh as the vector engine wants them: tiles of one facet's samples, each in vectors of
// 16 neighbours, and groups of neighbouring tiles that walk the tree together.

/// 16 samples of one tile, in its local coordinates: u, v over [-1, 1]^2 of the tile's rectangle. Lanes that
/// hold no sample repeat the last one.
struct alignas(64) SampleVector {
    float u[kLanes], v[kLanes];
};

/// Which samples a vector holds.
struct alignas(64) VectorSamples {
    Id sample[kLanes];
};

/// Rectangles, in local coordinates, of 16 consecutive vectors of a tile; lanes without a vector are far
/// away.
struct alignas(64) VectorBoxes {
    float centre_u[kLanes], centre_v[kLanes], half_u[kLanes], half_v[kLanes];
};

/// A rectangle of the lattice of samples, and those of one facet in it.
struct SampleTile {
    Id rays = 0;  // of its facet, in SampleTiles::rays
    Id facet = 0;
    std::uint32_t first_vector = 0, vectors = 0, first_boxes = 0, samples = 0;
    int column = 0, row = 0, width = 0, height = 0;  // of the rectangle, in samples from the window's corner
    std::size_t first_slot = 0;                      // of the rectangle's cells in `slot`
    bool whole_facet = false;                        // all of the facet's samples are here
    // Where lanes are pixels: how far their samples reach from the middle, in local coordinates.
    float reach_u = 0, reach_v = 0;
    double least_weight = 0;  // the smallest weight of a corner at any sample
    double low = 0,
           high = 0;  // of the weights' sum (FacetRays' weight) at the samples; not a number: not positive
};

struct TileGroup {
    std::uint32_t first = 0, count = 0;  // tiles, at most kLanes
};

/// Neighbouring samples of several facets, of which each has so few that a tile for each would waste lanes:
/// vectors whose lanes have facets of their own. The bounds are over all samples, with rays scaled to weight
/// 1 and positions from `centre`.
struct MixedGroup {
    std::uint32_t first_vector = 0, vectors = 0;  // at most kLanes
    std::uint32_t first_lanes = 0;                // of its first vector, in SampleTiles::lanes
    std::uint32_t first_rays = 0, facets = 0;     // in SampleTiles::rays
    Vec3 centre{0};                               // world frame
    double origin_terms = 0, direction_terms = 0, weight_terms = 0;  // sums of absolute terms
};

/// The facets of a mixed vector's samples, in SampleTiles::rays.
struct alignas(64) LaneFacets {
    Id rays[kLanes];
};

struct SampleTiles {
    std::vector<FacetRays> rays;  // of the facets that have samples here, some several times
    std::vector<SampleTile> tiles;
    std::vector<TileGroup> groups;   // of all tiles, in order
    std::vector<TileGroup> batches;  // of groups: consecutive ones with at most kLanes tiles in all
    std::vector<MixedGroup> mixed;
    std::vector<LaneFacets> lanes;       // by vector of a mixed group
    std::vector<SampleVector> vectors;   // of mixed groups: columns and rows from the window's corner
    std::vector<VectorSamples> samples;  // by vector
    std::vector<std::uint16_t> valid;    // likewise, bit k: lane k holds a sample; those are the first lanes
    std::vector<VectorBoxes> boxes;
    std::vector<std::uint16_t> slot;  // by cell: 16 vector + lane inside the tile, or kNoSlot
};

inline constexpr std::uint16_t kNoSlot = 65535;

struct TileParams {
    std::uint32_t group_samples = 1000;  // groups grow up to this
    std::uint32_t group_tiles = kLanes;
    int tile_side = 64;              // samples
    std::uint32_t mixed_below = 20;  // facets of fewer samples share vectors
    std::uint32_t together = 24;     // samples of a facet that stay together there; more, and it is spread
};

/// What draws a scene of so many triangles fastest (measured): a tile pays by the triangles that each cover
/// many of its samples.
TileParams tile_params(std::size_t triangles);

inline constexpr int kLargestTile = 240;  // whose slots fit 16 bits

inline constexpr std::size_t kMixedSamples = kLanes * kLanes;  // of a group

/// A tile before its vectors are made: the samples, ascending, and what they span.
struct RoughTile {
    FacetOnScreen facet;
    std::span<const Id> samples;
    LatticeExtent extent;
    bool whole_facet = false;
};

/// A sample of a facet that shares vectors.
struct MixedSample {
    Id sample = 0;
    std::uint32_t facet = 0;  // in TilePlan::mixed_facets
};

/// What must be known of all samples before any is drawn. Refers to the mesh and its samples.
struct TilePlan {
    std::vector<RoughTile> tiles;            // in the groups' order
    std::vector<TileGroup> groups, batches;  // as in SampleTiles
    std::vector<std::vector<Id>> binned;     // what tiles of facets in several tiles refer to
    std::vector<FacetOnScreen> mixed_facets;
    std::vector<MixedSample> mixed;       // neighbours on the film together
    std::vector<TileGroup> mixed_groups;  // of these samples
};

/// Of all samples that `owned` gives to facets with rays and an area on the screen.
TilePlan plan_tiles(const RayMesh& mesh, const FacetSamples& owned, const SampleGrid& grid,
                    const TileParams& params);

/// A facet's samples in a mixed group: where they lie, and the smallest weight (FacetRays') of any.
struct MixedExtent {
    LatticeExtent extent;
    double least_weight = std::numeric_limits<double>::infinity();
};

/// Makes the tiles of one batch after the other, with tables of its own that are kept in between.
class TileMaker {
  public:
    /// `pixel_side`: 0, or what the grid's samples stand for: pixels of so many samples along each side. Then
    /// lanes are pixels, and tiles count columns and rows of their samples.
    explicit TileMaker(const SampleGrid& grid, int pixel_side = 0) : grid_(&grid), pixel_side_(pixel_side) {}

    /// Appends the plan's batch to `tiles`.
    void add_batch(const TilePlan& plan, std::size_t batch, SampleTiles& tiles);
    /// Appends one of the plan's mixed groups.
    void add_mixed(const TilePlan& plan, std::size_t group, SampleTiles& tiles);

  private:
    void number_mixed_facets(std::span<const MixedSample> samples);
    void add_tile(const RoughTile& rough, SampleTiles& tiles);
    void add_pixels(const RoughTile& rough, SampleTiles& tiles);
    void add_pixel_vector(const SampleTile& tile, std::size_t first, std::size_t count, SampleTiles& tiles);
    bool place_rows(const RoughTile& rough, const SampleTile& tile);
    void begin_list(std::size_t samples);
    void list_rows(const SampleTile& tile);
    void list_cells(const RoughTile& rough, const SampleTile& tile);
    void add_vector(const SampleTile& tile, std::size_t first, std::size_t count, SampleTiles& tiles);

    const SampleGrid* grid_;
    int pixel_side_ = 0;
    std::vector<Id> cells_;  // samples by band, column and row
    std::vector<std::uint32_t> band_ends_;
    std::vector<int> first_column_, last_column_;  // by row of the tile, and of three empty rows after it
    std::vector<Id> row_sample_;                   // likewise: at column 0, if every row is one run
    std::vector<std::uint8_t> column_, row_;       // of the tile, in the order of vectors
    std::vector<Id> sample_;                       // likewise
    std::vector<std::uint32_t> mixed_facets_;      // of a group, in TilePlan::mixed_facets, as they come
    std::vector<std::uint16_t> mixed_places_;      // by sample of the group: its facet's, there
    std::vector<MixedExtent> mixed_extents_;       // likewise, of their samples in the group
};

/// Puts samples in an order in which neighbours on the film are together, and names the ranges that are each
/// in a square of the lattice, with at most kMixedSamples.
std::vector<TileGroup> sort_mixed(const SampleGrid& grid, const TileParams& params,
                                  std::vector<MixedSample>& samples);

/// The plan's tiles, all at once.
SampleTiles make_sample_tiles(const RayMesh& mesh, const FacetSamples& owned, const SampleGrid& grid,
                              const TileParams& params);

/// The position on the screen of local coordinates (0, 0), and half the rectangle's size in pixels.
struct TileFrame {
    Vec2 centre{0}, half{0};
};
TileFrame tile_frame(const SampleTile& tile, const SampleGrid& grid);

}  // namespace trilens
