// The tiles of a batch: each tile's samples in vectors of neighbours, by bands of rows.
#include <algorithm>
#include <array>
#include <cmath>

#include "projector/tiles/sample_tiles.h"

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
    for (std::size_t r = 0; r < static_cast<std::size_t>(tile.height); ++r) {
        const int first = rows.first_column[r], last = rows.last_column[r],
                  row = tile.row + static_cast<int>(r);
        if (first > last) continue;
        if (include(tile.column + first, row) && include(tile.column + last, row)) continue;
        tile.least_weight = tile.low = tile.high = NAN;
        return;
    }
}

/// A vector's columns or rows in its tile.
using Lines = std::array<std::uint8_t, kLanes>;
static_assert(kLargestTile <= 255);

/// From lines to local coordinates.
struct LocalScale {
    explicit LocalScale(int lines)
        : middle(static_cast<float>(lines - 1) / 2), scale(1 / std::max(0.5f, middle)) {}
    float at(std::uint8_t line) const { return (static_cast<float>(line) - middle) * scale; }

    float middle, scale;
};

void add_empty_boxes(SampleTiles& tiles) {
    VectorBoxes empty{};
    std::fill_n(empty.centre_u, kLanes, 1e9f);
    std::fill_n(empty.centre_v, kLanes, 1e9f);
    tiles.boxes.push_back(empty);
}

/// What the lines span, in one lane of a tile's boxes.
void put_range(const Lines& lines, const LocalScale& local, float& centre, float& half) {
    constexpr float kRound = 1e-6f;
    std::uint8_t first = lines[0], last = lines[0];
    for (const std::uint8_t line : lines) first = std::min(first, line);
    for (const std::uint8_t line : lines) last = std::max(last, line);
    const float low = local.at(first), high = local.at(last);
    centre = (low + high) / 2;
    half = (high - low) / 2 + kRound;
}

}  // namespace

/// Fills the rows' ends. Returns whether every row is one run.
bool TileMaker::place_rows(const RoughTile& rough, const SampleTile& tile) {
    const std::size_t height = static_cast<std::size_t>(tile.height);
    first_column_.assign(height + kBand - 1, tile.width);
    last_column_.assign(height + kBand - 1, -1);
    row_sample_.assign(height + kBand - 1, 0);
    bool whole_rows = grid_->in_rows() || !grid_->chosen.empty();
    for_each_run(*grid_, rough.samples, [&](const LatticeRun& run) {
        const int x = run.first.column - tile.column;
        const std::size_t y = static_cast<std::size_t>(run.first.row - tile.row);
        whole_rows = whole_rows && (last_column_[y] < 0 || last_column_[y] == x - 1);
        first_column_[y] = std::min(first_column_[y], x);
        last_column_[y] = std::max(last_column_[y], x + run.count - 1);
        row_sample_[y] = run.sample - static_cast<Id>(x);
    });
    return whole_rows;
}

void TileMaker::begin_list(std::size_t samples) {
    // What is written without a sample is overwritten by the next one.
    const std::size_t room = samples + kLanes;
    column_.resize(room);
    row_.resize(room);
    sample_.resize(room);
    band_ends_.clear();
}

/// The samples as a list: by bands, in each by columns, in each by rows; where each band ends. Every row is
/// one run.
void TileMaker::list_rows(const SampleTile& tile) {
    begin_list(tile.samples);
    std::uint32_t count = 0;
    for (int y = 0; y < tile.height; y += kBand) {
        const int* first = &first_column_[static_cast<std::size_t>(y)];
        const int* last = &last_column_[static_cast<std::size_t>(y)];
        const Id* sample = &row_sample_[static_cast<std::size_t>(y)];
        const int begin = *std::min_element(first, first + kBand),
                  end = *std::max_element(last, last + kBand);
        const int all_begin = *std::max_element(first, first + kBand),
                  all_end = *std::min_element(last, last + kBand);
        for (int x = begin; x <= end; ++x) {
            const bool all = x >= all_begin && x <= all_end;
            for (int k = 0; k < kBand; ++k) {
                const std::uint32_t at = all ? count + static_cast<std::uint32_t>(k) : count;
                column_[at] = static_cast<std::uint8_t>(x);
                row_[at] = static_cast<std::uint8_t>(y + k);
                sample_[at] = sample[k] + static_cast<Id>(x);
                count += !all && x >= first[k] && x <= last[k];
            }
            if (all) count += kBand;
        }
        band_ends_.push_back(count);
    }
}

/// The same list, whatever the rows.
void TileMaker::list_cells(const RoughTile& rough, const SampleTile& tile) {
    cells_.assign(static_cast<std::size_t>((tile.height + kBand - 1) / kBand * kBand * tile.width), kNone);
    LatticeWalk walk(*grid_);
    for (const Id s : rough.samples) {
        const LatticeSample at = walk.at(s);
        const int x = at.column - tile.column, y = at.row - tile.row;
        cells_[static_cast<std::size_t>((y / kBand * tile.width + x) * kBand + y % kBand)] = s;
    }
    begin_list(tile.samples);
    std::uint32_t count = 0;
    const Id* cell = cells_.data();
    for (int y = 0; y < tile.height; y += kBand) {
        for (int x = 0; x < tile.width; ++x) {
            for (int k = 0; k < kBand; ++k, ++cell) {
                column_[count] = static_cast<std::uint8_t>(x);
                row_[count] = static_cast<std::uint8_t>(y + k);
                sample_[count] = *cell;
                count += *cell != kNone;
            }
        }
        band_ends_.push_back(count);
    }
}

void TileMaker::add_vector(const SampleTile& tile, std::size_t first, std::size_t count, SampleTiles& tiles) {
    const std::size_t number = tiles.vectors.size() - tile.first_vector;
    // There is room for a whole vector after the last sample.
    Lines x, y;
    VectorSamples& ids = tiles.samples.emplace_back();
    tiles.valid.push_back(static_cast<std::uint16_t>((1u << count) - 1));
    std::copy_n(&column_[first], kLanes, x.begin());
    std::copy_n(&row_[first], kLanes, y.begin());
    std::copy_n(&sample_[first], kLanes, ids.sample);
    for (std::size_t lane = count; lane < kLanes; ++lane) {
        x[lane] = x[count - 1];
        y[lane] = y[count - 1];
        ids.sample[lane] = ids.sample[count - 1];
    }
    std::uint16_t* const slot = &tiles.slot[tile.first_slot];
    for (std::size_t lane = 0; lane < count; ++lane)
        slot[y[lane] * tile.width + x[lane]] = static_cast<std::uint16_t>(number * kLanes + lane);

    const LocalScale across(tile.width), down(tile.height);
    SampleVector& vector = tiles.vectors.emplace_back();
    for (std::size_t lane = 0; lane < kLanes; ++lane) vector.u[lane] = across.at(x[lane]);
    for (std::size_t lane = 0; lane < kLanes; ++lane) vector.v[lane] = down.at(y[lane]);
    if (number % kLanes == 0) add_empty_boxes(tiles);
    VectorBoxes& boxes = tiles.boxes.back();
    put_range(x, across, boxes.centre_u[number % kLanes], boxes.half_u[number % kLanes]);
    put_range(y, down, boxes.centre_v[number % kLanes], boxes.half_v[number % kLanes]);
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
    const bool whole_rows = place_rows(rough, tile);
    bound_weights(rough.facet, *grid_, {first_column_, last_column_}, tile);

    // A vector ends with its band, unless the tile is so small that this would waste lanes.
    if (whole_rows)
        list_rows(tile);
    else
        list_cells(rough, tile);
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

namespace {

/// The tile's columns or rows of samples as pixels of `side` samples, in local coordinates.
struct PixelScale {
    PixelScale(int lines, int side)
        : step(2.0f * static_cast<float>(side) / static_cast<float>(lines - 1)),
          reach(static_cast<float>(side - 1) / static_cast<float>(lines - 1)) {}
    /// The middle of a pixel.
    float at(std::uint8_t pixel) const { return -1 + reach + static_cast<float>(pixel) * step; }

    float step, reach;
};

/// As put_range(), of pixels with all their samples.
void put_pixel_range(std::span<const std::uint8_t> pixels, const PixelScale& local, float& centre,
                     float& half) {
    constexpr float kRound = 2e-6f;
    const auto [first, last] = std::minmax_element(pixels.begin(), pixels.end());
    const float low = local.at(*first), high = local.at(*last);
    centre = (low + high) / 2;
    half = (high - low) / 2 + local.reach + kRound;
}

}  // namespace

void TileMaker::add_pixel_vector(const SampleTile& tile, std::size_t first, std::size_t count,
                                 SampleTiles& tiles) {
    const std::size_t number = tiles.vectors.size() - tile.first_vector;
    const PixelScale across(tile.width, pixel_side_), down(tile.height, pixel_side_);
    SampleVector& vector = tiles.vectors.emplace_back();
    VectorSamples& ids = tiles.samples.emplace_back();
    tiles.valid.push_back(static_cast<std::uint16_t>((1u << count) - 1));
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
        const std::size_t from = first + std::min(lane, count - 1);
        vector.u[lane] = across.at(column_[from]);
        vector.v[lane] = down.at(row_[from]);
        ids.sample[lane] = sample_[from];
    }
    if (number % kLanes == 0) add_empty_boxes(tiles);
    VectorBoxes& boxes = tiles.boxes.back();
    const std::size_t lane = number % kLanes;
    put_pixel_range(std::span(column_).subspan(first, count), across, boxes.centre_u[lane],
                    boxes.half_u[lane]);
    put_pixel_range(std::span(row_).subspan(first, count), down, boxes.centre_v[lane], boxes.half_v[lane]);
}

/// As add_tile(), of pixels that lie in the facet with all their samples.
void TileMaker::add_pixels(const RoughTile& rough, SampleTiles& tiles) {
    constexpr float kRound = 1 + 1e-5f;
    const int side = pixel_side_;
    SampleTile pixels;  // what the lists are made of: lines are pixels
    pixels.samples = static_cast<std::uint32_t>(rough.samples.size());
    pixels.column = rough.extent.x0;
    pixels.row = rough.extent.y0;
    pixels.width = rough.extent.x1 - rough.extent.x0 + 1;
    pixels.height = rough.extent.y1 - rough.extent.y0 + 1;
    if (place_rows(rough, pixels))
        list_rows(pixels);
    else
        list_cells(rough, pixels);

    SampleTile tile = pixels;
    tile.rays = static_cast<Id>(tiles.rays.size() - 1);
    tile.facet = static_cast<Id>(rough.facet.facet);
    tile.first_vector = static_cast<std::uint32_t>(tiles.vectors.size());
    tile.first_boxes = static_cast<std::uint32_t>(tiles.boxes.size());
    tile.first_slot = tiles.slot.size();
    tile.column *= side, tile.row *= side, tile.width *= side, tile.height *= side;
    tile.reach_u = kRound * PixelScale(tile.width, side).reach;
    tile.reach_v = kRound * PixelScale(tile.height, side).reach;
    // The first and the last row of samples of each row of pixels: what is in between lies in their hull.
    std::vector<int> first(static_cast<std::size_t>(tile.height), tile.width),
        last(static_cast<std::size_t>(tile.height), -1);
    for (int y = 0; y < pixels.height; ++y)
        for (const int row : {y * side, (y + 1) * side - 1}) {
            first[static_cast<std::size_t>(row)] = first_column_[static_cast<std::size_t>(y)] * side;
            last[static_cast<std::size_t>(row)] = (last_column_[static_cast<std::size_t>(y)] + 1) * side - 1;
        }
    SampleGrid samples = *grid_;
    samples.side = side;
    bound_weights(rough.facet, samples, {first, last}, tile);
    for (std::size_t at = 0; at < tile.samples; at += kLanes)
        add_pixel_vector(tile, at, std::min<std::size_t>(kLanes, tile.samples - at), tiles);
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
            if (pixel_side_ > 0)
                add_pixels(rough, tiles);
            else
                add_tile(rough, tiles);
        }
    }
}

}  // namespace trilens
