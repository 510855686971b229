// The tiles of a batch: each tile's samples in vectors of neighbours, by bands of rows.
#include <algorithm>
#include <cmath>

#include "projector/sample_tiles.h"

namespace trilens {
namespace {

constexpr int kBand = 4;  // rows of samples that fill vectors together

/// Which rows and columns of a tile have samples.
struct RowEnds {
    std::span<const int> first_column, last_column;  // by row of the tile; none: first > last
};

/// SampleTile's least_weight, low and high. Along a row the weights' sum is linear, and each weight has no
/// turning point where the sum is positive: the ends of rows are enough.
void bound_weights(const FacetOnScreen& facet, const SampleGrid& grid, const RowEnds& rows,
                   SampleTile& tile) {
    const Mat3& m = facet.weights.weights_from_screen;
    tile.least_weight = tile.low = INFINITY;
    tile.high = 0;
    const auto include = [&](int column, int row) {
        const double x = grid.x0 + (column + 0.5) / grid.side, y = grid.y0 + (row + 0.5) / grid.side;
        const double e0 = m[0].x * x + m[1].x * y + m[2].x, e1 = m[0].y * x + m[1].y * y + m[2].y,
                     e2 = m[0].z * x + m[1].z * y + m[2].z;
        const double sum = e0 + e1 + e2;
        if (!(sum > 0)) return false;
        tile.least_weight = std::min(tile.least_weight, std::min(e0, std::min(e1, e2)) / sum);
        tile.low = std::min(tile.low, sum);
        tile.high = std::max(tile.high, sum);
        return true;
    };
    for (std::size_t r = 0; r < rows.first_column.size(); ++r) {
        const int first = rows.first_column[r], last = rows.last_column[r],
                  row = tile.row + static_cast<int>(r);
        if (first > last) continue;
        if (include(tile.column + first, row) && include(tile.column + last, row)) continue;
        tile.least_weight = tile.low = tile.high = NAN;
        return;
    }
}

}  // namespace

/// Fills cells_ and the rows' ends.
void TileMaker::place_samples(const RoughTile& rough, SampleTile& tile) {
    const std::size_t width = static_cast<std::size_t>(tile.width),
                      height = static_cast<std::size_t>(tile.height);
    cells_.assign((height + kBand - 1) / kBand * kBand * width, kNone);
    first_column_.assign(height, tile.width);
    last_column_.assign(height, -1);
    LatticeWalk walk(*grid_);
    for (const Id s : rough.samples) {
        const LatticeSample at = walk.at(s);
        const int x = at.column - tile.column, y = at.row - tile.row;
        cells_[static_cast<std::size_t>((y / kBand * tile.width + x) * kBand + y % kBand)] = s;
        int& first = first_column_[static_cast<std::size_t>(y)];
        int& last = last_column_[static_cast<std::size_t>(y)];
        first = std::min(first, x);
        last = std::max(last, x);
    }
}

/// cells_ as a list: by bands, in each by columns, in each by rows; where each band ends.
void TileMaker::sort_by_bands(const SampleTile& tile) {
    // Every cell is written; those without a sample are overwritten by the next one.
    const std::size_t room = tile.samples + 1;
    column_.resize(room);
    row_.resize(room);
    sample_.resize(room);
    band_ends_.clear();
    std::uint32_t count = 0;
    const Id* cell = cells_.data();
    for (int y = 0; y < tile.height; y += kBand) {
        for (int x = 0; x < tile.width; ++x) {
            for (int k = 0; k < kBand; ++k, ++cell) {
                column_[count] = x;
                row_[count] = y + k;
                sample_[count] = *cell;
                count += *cell != kNone;
            }
        }
        band_ends_.push_back(count);
    }
}

void TileMaker::add_vector(const SampleTile& tile, std::size_t first, std::size_t count, SampleTiles& tiles) {
    const std::size_t number = tiles.vectors.size() - tile.first_vector;
    const float middle_x = static_cast<float>(tile.width - 1) / 2,
                middle_y = static_cast<float>(tile.height - 1) / 2;
    const float scale_u = 1 / std::max(0.5f, middle_x), scale_v = 1 / std::max(0.5f, middle_y);
    std::int32_t x[kLanes], y[kLanes];
    VectorSamples& ids = tiles.samples.emplace_back();
    ids.valid = (1u << count) - 1;
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
        const std::size_t from = first + std::min(lane, count - 1);
        x[lane] = column_[from];
        y[lane] = row_[from];
        ids.sample[lane] = sample_[from];
    }
    std::uint16_t* slot = &tiles.slot[tile.first_slot];
    for (std::size_t lane = 0; lane < count; ++lane)
        slot[y[lane] * tile.width + x[lane]] = static_cast<std::uint16_t>(number * kLanes + lane);

    SampleVector& vector = tiles.vectors.emplace_back();
    std::int32_t x0 = x[0], x1 = x[0], y0 = y[0], y1 = y[0];
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
        vector.u[lane] = (static_cast<float>(x[lane]) - middle_x) * scale_u;
        vector.v[lane] = (static_cast<float>(y[lane]) - middle_y) * scale_v;
        x0 = std::min(x0, x[lane]), x1 = std::max(x1, x[lane]);
        y0 = std::min(y0, y[lane]), y1 = std::max(y1, y[lane]);
    }
    if (number % kLanes == 0) {
        VectorBoxes empty{};
        std::fill_n(empty.centre_u, kLanes, 1e9f);
        std::fill_n(empty.centre_v, kLanes, 1e9f);
        tiles.boxes.push_back(empty);
    }
    VectorBoxes& boxes = tiles.boxes.back();
    constexpr float kRound = 1e-6f;
    const float lu = (static_cast<float>(x0) - middle_x) * scale_u,
                hu = (static_cast<float>(x1) - middle_x) * scale_u,
                lv = (static_cast<float>(y0) - middle_y) * scale_v,
                hv = (static_cast<float>(y1) - middle_y) * scale_v;
    boxes.centre_u[number % kLanes] = (lu + hu) / 2;
    boxes.centre_v[number % kLanes] = (lv + hv) / 2;
    boxes.half_u[number % kLanes] = (hu - lu) / 2 + kRound;
    boxes.half_v[number % kLanes] = (hv - lv) / 2 + kRound;
}

void TileMaker::add_tile(const RoughTile& rough, SampleTiles& tiles) {
    SampleTile tile;
    tile.rays = static_cast<Id>(tiles.rays.size() - 1);
    tile.facet = static_cast<Id>(rough.facet.facet);
    tile.whole_facet = rough.whole_facet;
    tile.first_vector = static_cast<std::uint32_t>(tiles.vectors.size());
    tile.first_boxes = static_cast<std::uint32_t>(tiles.boxes.size());
    tile.samples = static_cast<std::uint32_t>(rough.samples.size());
    tile.column = rough.extent.x0;
    tile.row = rough.extent.y0;
    tile.width = rough.extent.x1 - rough.extent.x0 + 1;
    tile.height = rough.extent.y1 - rough.extent.y0 + 1;
    tile.first_slot = tiles.slot.size();
    tiles.slot.resize(tile.first_slot + static_cast<std::size_t>(tile.width * tile.height), kNoSlot);
    place_samples(rough, tile);
    bound_weights(rough.facet, *grid_, {first_column_, last_column_}, tile);

    // A vector ends with its band, unless the tile is so small that this would waste lanes.
    sort_by_bands(tile);
    if (tile.samples <= 4 * kLanes) band_ends_.assign(1, tile.samples);
    std::size_t first = 0;
    for (const std::uint32_t end : band_ends_) {
        while (first < end) {
            const std::size_t count = std::min<std::size_t>(kLanes, end - first);
            add_vector(tile, first, count, tiles);
            first += count;
        }
    }
    tile.vectors = static_cast<std::uint32_t>(tiles.vectors.size()) - tile.first_vector;
    tiles.tiles.push_back(tile);
}

void TileMaker::add_batch(const TilePlan& plan, std::size_t batch, SampleTiles& tiles) {
    const TileGroup groups = plan.batches[batch];
    tiles.batches.push_back({static_cast<std::uint32_t>(tiles.groups.size()), groups.count});
    const std::size_t first_rays = tiles.rays.size();
    for (std::uint32_t g = groups.first; g < groups.first + groups.count; ++g) {
        const TileGroup group = plan.groups[g];
        tiles.groups.push_back({static_cast<std::uint32_t>(tiles.tiles.size()), group.count});
        for (std::uint32_t t = group.first; t < group.first + group.count; ++t) {
            const RoughTile& rough = plan.tiles[t];
            const bool same_facet =
                tiles.rays.size() > first_rays && t > 0 && plan.tiles[t - 1].facet.facet == rough.facet.facet;
            if (!same_facet) tiles.rays.push_back(make_facet_rays(rough.facet));
            add_tile(rough, tiles);
        }
    }
}

}  // namespace trilens
