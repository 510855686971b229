// Sorts each facet's samples into tiles and vectors, by counting, then cuts the tiles into groups by medians.
#include "projector/sample_tiles.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/check.h"

namespace trilens {
namespace {

constexpr int kBand = 4;  // rows of samples that fill vectors together

struct LatticeSample {
    int column = 0, row = 0;
    Id sample = 0;
};

LatticeSample on_lattice(const SampleGrid& grid, Id sample) {
    if (grid.side == 1) {
        const Id width = static_cast<Id>(grid.width());
        return {static_cast<int>(sample % width), static_cast<int>(sample / width), sample};
    }
    const Id per_pixel = static_cast<Id>(grid.samples_per_pixel()), pixel = sample / per_pixel,
             inside = sample % per_pixel;
    const Id width = static_cast<Id>(grid.width()), side = static_cast<Id>(grid.side);
    return {static_cast<int>(pixel % width * side + inside % side),
            static_cast<int>(pixel / width * side + inside / side), sample};
}

/// A rectangle of the lattice, first and last line each way.
struct Extent {
    int x0 = INT32_MAX, x1 = 0, y0 = INT32_MAX, y1 = 0;

    void include(const LatticeSample& s) {
        x0 = std::min(x0, s.column), x1 = std::max(x1, s.column);
        y0 = std::min(y0, s.row), y1 = std::max(y1, s.row);
    }
};

/// A tile before its vectors are made.
struct RoughTile {
    FacetOnScreen facet;
    Id rays = 0;
    std::span<const Id> samples;
    Extent extent;
    bool whole_facet = false;
};

/// Cuts facets into tiles.
class TileCutter {
  public:
    TileCutter(const SampleGrid& grid, int side) : grid_(grid), side_(side) {}

    void add_facet(const FacetOnScreen& facet, Id rays, std::span<const Id> samples);
    std::vector<RoughTile> tiles;

  private:
    const SampleGrid& grid_;
    int side_;
    std::vector<std::vector<Id>> binned_;  // samples of facets that are cut, by tile
};

void TileCutter::add_facet(const FacetOnScreen& facet, Id rays, std::span<const Id> samples) {
    Extent all;
    for (const Id s : samples) all.include(on_lattice(grid_, s));
    if (all.x1 - all.x0 < side_ && all.y1 - all.y0 < side_) {
        tiles.push_back({facet, rays, samples, all, true});
        return;
    }
    const int across = (all.x1 - all.x0) / side_ + 1, down = (all.y1 - all.y0) / side_ + 1;
    const auto cell = [&](const LatticeSample& s) {
        return static_cast<std::size_t>((s.row - all.y0) / side_ * across + (s.column - all.x0) / side_);
    };
    std::vector<std::size_t> start(static_cast<std::size_t>(across * down) + 1, 0);
    for (const Id s : samples) ++start[cell(on_lattice(grid_, s)) + 1];
    for (std::size_t c = 1; c < start.size(); ++c) start[c] += start[c - 1];
    std::vector<Extent> extent(start.size());
    std::vector<std::size_t> next(start.begin(), start.end() - 1);
    binned_.emplace_back(samples.size());
    for (const Id s : samples) {
        const LatticeSample at = on_lattice(grid_, s);
        binned_.back()[next[cell(at)]++] = s;
        extent[cell(at)].include(at);
    }
    for (std::size_t c = 0; c + 1 < start.size(); ++c) {
        if (start[c] == start[c + 1]) continue;
        const std::span<const Id> own = std::span(binned_.back()).subspan(start[c], start[c + 1] - start[c]);
        tiles.push_back({facet, rays, own, extent[c], false});
    }
}

/// Makes tiles' vectors.
class VectorMaker {
  public:
    VectorMaker(const SampleGrid& grid, SampleTiles& tiles) : grid_(grid), out_(tiles) {}

    void add(const RoughTile& rough);

  private:
    void sort_by_bands(const SampleTile& tile);
    void add_vector(const SampleTile& tile, std::size_t first, std::size_t count);

    const SampleGrid& grid_;
    SampleTiles& out_;
    std::vector<LatticeSample> samples_, sorted_;
    std::vector<std::uint32_t> start_;
};

/// SampleTile's least_weight, low and high.
void bound_weights(const FacetOnScreen& facet, const SampleGrid& grid, std::span<const LatticeSample> samples,
                   SampleTile& tile) {
    const Mat3& m = facet.weights.weights_from_screen;
    tile.least_weight = tile.low = INFINITY;
    tile.high = 0;
    for (const LatticeSample& s : samples) {
        const double x = grid.x0 + (s.column + 0.5) / grid.side, y = grid.y0 + (s.row + 0.5) / grid.side;
        const double e0 = m[0].x * x + m[1].x * y + m[2].x, e1 = m[0].y * x + m[1].y * y + m[2].y,
                     e2 = m[0].z * x + m[1].z * y + m[2].z;
        const double sum = e0 + e1 + e2, least = std::min(e0, std::min(e1, e2)) / sum;
        if (!(sum > 0)) {
            tile.least_weight = tile.low = tile.high = NAN;
            return;
        }
        tile.least_weight = std::min(tile.least_weight, least);
        tile.low = std::min(tile.low, sum);
        tile.high = std::max(tile.high, sum);
    }
}

/// samples_ into sorted_: by bands of rows, in each by columns, in each by rows. Samples of a column come by
/// rows.
void VectorMaker::sort_by_bands(const SampleTile& tile) {
    const auto key = [&](const LatticeSample& s) {
        return static_cast<std::size_t>((s.row - tile.row) / kBand * tile.width + s.column - tile.column);
    };
    start_.assign(static_cast<std::size_t>((tile.height + kBand - 1) / kBand * tile.width) + 1, 0);
    for (const LatticeSample& s : samples_) ++start_[key(s) + 1];
    for (std::size_t k = 1; k < start_.size(); ++k) start_[k] += start_[k - 1];
    sorted_.resize(samples_.size());
    for (const LatticeSample& s : samples_) sorted_[start_[key(s)]++] = s;
}

void VectorMaker::add(const RoughTile& rough) {
    samples_.clear();
    for (const Id s : rough.samples) samples_.push_back(on_lattice(grid_, s));
    SampleTile tile;
    tile.rays = rough.rays;
    tile.facet = static_cast<Id>(rough.facet.facet);
    tile.whole_facet = rough.whole_facet;
    bound_weights(rough.facet, grid_, samples_, tile);
    tile.first_vector = static_cast<std::uint32_t>(out_.vectors.size());
    tile.first_boxes = static_cast<std::uint32_t>(out_.boxes.size());
    tile.samples = static_cast<std::uint32_t>(samples_.size());
    tile.column = rough.extent.x0;
    tile.row = rough.extent.y0;
    tile.width = rough.extent.x1 - rough.extent.x0 + 1;
    tile.height = rough.extent.y1 - rough.extent.y0 + 1;
    tile.first_slot = out_.slot.size();
    out_.slot.resize(tile.first_slot + static_cast<std::size_t>(tile.width * tile.height), kNoSlot);
    sort_by_bands(tile);

    // A vector ends with its band, unless the tile is so small that this would waste lanes.
    const bool across_bands = sorted_.size() <= 4 * kLanes;
    for (std::size_t first = 0; first < sorted_.size();) {
        const int band = (sorted_[first].row - tile.row) / kBand;
        std::size_t count = 1;
        while (count < kLanes && first + count < sorted_.size() &&
               (across_bands || (sorted_[first + count].row - tile.row) / kBand == band)) {
            ++count;
        }
        add_vector(tile, first, count);
        first += count;
    }
    tile.vectors = static_cast<std::uint32_t>(out_.vectors.size()) - tile.first_vector;
    out_.tiles.push_back(tile);
}

void VectorMaker::add_vector(const SampleTile& tile, std::size_t first, std::size_t count) {
    const std::size_t number = out_.vectors.size() - tile.first_vector;
    const float middle_x = static_cast<float>(tile.width - 1) / 2,
                middle_y = static_cast<float>(tile.height - 1) / 2;
    const float scale_u = 1 / std::max(0.5f, middle_x), scale_v = 1 / std::max(0.5f, middle_y);
    SampleVector vector;
    VectorSamples ids;
    ids.valid = (1u << count) - 1;
    float lu = 2, hu = -2, lv = 2, hv = -2;
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
        const LatticeSample& s = sorted_[first + std::min(lane, count - 1)];
        const int x = s.column - tile.column, y = s.row - tile.row;
        ids.sample[lane] = s.sample;
        vector.u[lane] = (static_cast<float>(x) - middle_x) * scale_u;
        vector.v[lane] = (static_cast<float>(y) - middle_y) * scale_v;
        lu = std::min(lu, vector.u[lane]), hu = std::max(hu, vector.u[lane]);
        lv = std::min(lv, vector.v[lane]), hv = std::max(hv, vector.v[lane]);
        if (lane < count)
            out_.slot[tile.first_slot + static_cast<std::size_t>(y * tile.width + x)] =
                static_cast<std::uint16_t>(number * kLanes + lane);
    }
    if (number % kLanes == 0) {
        VectorBoxes empty{};
        std::fill_n(empty.centre_u, kLanes, 1e9f);
        std::fill_n(empty.centre_v, kLanes, 1e9f);
        out_.boxes.push_back(empty);
    }
    VectorBoxes& boxes = out_.boxes.back();
    constexpr float kRound = 1e-6f;
    boxes.centre_u[number % kLanes] = (lu + hu) / 2;
    boxes.centre_v[number % kLanes] = (lv + hv) / 2;
    boxes.half_u[number % kLanes] = (hu - lu) / 2 + kRound;
    boxes.half_v[number % kLanes] = (hv - lv) / 2 + kRound;
    out_.vectors.push_back(vector);
    out_.samples.push_back(ids);
}

/// Sorts tiles into groups of neighbours on the film.
class Grouping {
  public:
    Grouping(const TileParams& params, std::vector<RoughTile>& tiles, std::vector<TileGroup>& groups)
        : params_(params), tiles_(tiles), groups_(groups), order_(tiles.size()) {
        std::iota(order_.begin(), order_.end(), Id{0});
    }

    void make() {
        if (!order_.empty()) cut(0, order_.size());
        std::vector<RoughTile> sorted;
        sorted.reserve(order_.size());
        for (const Id i : order_) sorted.push_back(tiles_[i]);
        tiles_ = std::move(sorted);
    }

  private:
    /// Twice the middle of a tile.
    int middle(Id tile, bool x) const {
        const Extent& e = tiles_[tile].extent;
        return x ? e.x0 + e.x1 : e.y0 + e.y1;
    }
    void cut(std::size_t first, std::size_t last);

    const TileParams& params_;
    std::vector<RoughTile>& tiles_;
    std::vector<TileGroup>& groups_;
    std::vector<Id> order_;
};

void Grouping::cut(std::size_t first, std::size_t last) {
    int x0 = INT32_MAX, x1 = 0, y0 = INT32_MAX, y1 = 0;
    std::size_t samples = 0;
    for (std::size_t i = first; i < last; ++i) {
        const int x = middle(order_[i], true), y = middle(order_[i], false);
        samples += tiles_[order_[i]].samples.size();
        x0 = std::min(x0, x), x1 = std::max(x1, x);
        y0 = std::min(y0, y), y1 = std::max(y1, y);
    }
    const std::size_t count = last - first, most = params_.group_tiles;
    if (count == 1 || (count <= most && samples <= params_.group_samples)) {
        groups_.push_back({static_cast<std::uint32_t>(first), static_cast<std::uint32_t>(count)});
        return;
    }
    std::size_t half = count / 2;
    if (count > most) {
        half = (count + most - 1) / most / 2 * most;
        if (half == 0 || half >= count) half = count / 2;
    }
    const auto begin = order_.begin() + static_cast<std::ptrdiff_t>(first);
    const bool by_x = x1 - x0 > y1 - y0;
    std::nth_element(begin, begin + static_cast<std::ptrdiff_t>(half),
                     order_.begin() + static_cast<std::ptrdiff_t>(last), [&](Id a, Id b) {
                         const int p = middle(a, by_x), q = middle(b, by_x);
                         return p != q ? p < q : a < b;
                     });
    cut(first, first + half);
    cut(first + half, last);
}

std::vector<TileGroup> make_batches(std::span<const TileGroup> groups) {
    std::vector<TileGroup> batches;
    TileGroup batch;
    std::uint32_t tiles = 0;
    for (std::uint32_t g = 0; g < groups.size(); ++g) {
        if (tiles + groups[g].count > kLanes) {
            batches.push_back(batch);
            batch = {g, 0};
            tiles = 0;
        }
        ++batch.count;
        tiles += groups[g].count;
    }
    if (batch.count > 0) batches.push_back(batch);
    return batches;
}

}  // namespace

SampleTiles make_sample_tiles(const RayMesh& mesh, const FacetSamples& owned, const SampleGrid& grid,
                              const TileParams& params) {
    TRILENS_CHECK(params.tile_side >= 1 && params.tile_side <= 240, "a tile's slots must fit 16 bits");
    TRILENS_CHECK(params.group_tiles >= 1 && params.group_tiles <= kLanes, "a group's tiles are lanes");
    SampleTiles tiles;
    TileCutter cutter(grid, params.tile_side);
    for (std::size_t f = 0; f < mesh.facets.size(); ++f) {
        if (owned.of(f).empty() || !mesh.has_rays(f)) continue;
        const FacetOnScreen facet{mesh, f, facet_weights(mesh, f)};
        if (facet.weights.edge_on) continue;
        cutter.add_facet(facet, static_cast<Id>(tiles.rays.size()), owned.of(f));
        tiles.rays.push_back(make_facet_rays(facet));
    }
    Grouping(params, cutter.tiles, tiles.groups).make();
    tiles.batches = make_batches(tiles.groups);
    tiles.vectors.reserve(owned.sample.size() / kLanes * 3 / 2 + 16);
    tiles.samples.reserve(owned.sample.size() / kLanes * 3 / 2 + 16);
    tiles.tiles.reserve(cutter.tiles.size());
    VectorMaker maker(grid, tiles);
    for (const RoughTile& tile : cutter.tiles) maker.add(tile);
    return tiles;
}

TileFrame tile_frame(const SampleTile& tile, const SampleGrid& grid) {
    const double side = grid.side;
    return {
        {grid.x0 + (tile.column + 0.5 * tile.width) / side, grid.y0 + (tile.row + 0.5 * tile.height) / side},
        {std::max(0.5, 0.5 * (tile.width - 1)) / side, std::max(0.5, 0.5 * (tile.height - 1)) / side}};
}

}  // namespace trilens
