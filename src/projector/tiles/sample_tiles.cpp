// Cuts each facet's samples into tiles, by counting, then the tiles into groups by medians.
#include "projector/tiles/sample_tiles.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/util/check.h"

namespace trilens {
namespace {

/// Cuts facets into tiles.
class TileCutter {
  public:
    TileCutter(const SampleGrid& grid, int side) : grid_(grid), side_(side) {}

    void add_facet(const FacetOnScreen& facet, std::span<const Id> samples);
    std::vector<RoughTile> tiles;
    std::vector<std::vector<Id>> binned;  // samples of facets that are cut, by tile

  private:
    const SampleGrid& grid_;
    int side_;
};

/// The cells of even size that a facet's samples are cut into, row by row.
class CellsOfFacet {
  public:
    CellsOfFacet(const LatticeExtent& all, int across, int down)
        : all_(all), height_(all.y1 - all.y0 + 1), across_(across), down_(down) {
        const int width = all.x1 - all.x0 + 1;
        column_cell_.resize(static_cast<std::size_t>(width));
        for (int x = 0; x < width; ++x) column_cell_[static_cast<std::size_t>(x)] = x * across / width;
        for (int c = 1; c <= across; ++c) cell_end_.push_back((c * width + across - 1) / across);
    }

    std::size_t count() const { return static_cast<std::size_t>(across_ * down_); }

    /// Calls body(cell, part) for the samples, which ascend, by runs that lie in one cell.
    template <typename Body>
    void for_each_part(const SampleGrid& grid, std::span<const Id> samples, const Body& body) const {
        for_each_run(grid, samples, [&](const LatticeRun& run) {
            const int row_of_cells = (run.first.row - all_.y0) * down_ / height_ * across_;
            for (LatticeRun rest = run; rest.count > 0;) {
                const int x = rest.first.column - all_.x0, cell = column_cell_[static_cast<std::size_t>(x)];
                LatticeRun part = rest;
                part.count = std::min(rest.count, cell_end_[static_cast<std::size_t>(cell)] - x);
                body(static_cast<std::size_t>(row_of_cells + cell), part);
                rest.first.column += part.count;
                rest.sample += static_cast<Id>(part.count);
                rest.count -= part.count;
            }
        });
    }

  private:
    LatticeExtent all_;
    int height_, across_, down_;
    std::vector<int> column_cell_;  // by column
    std::vector<int> cell_end_;     // of each column of cells, the column after its last
};

/// Of a tile's rays, where it can be: beyond it conics are too bent to be bounded well (measured).
constexpr double kTileSpread = 0.2;

/// How far apart the unit directions of a facet's corner rays are.
double spread_of(const FacetOnScreen& facet) {
    const IdTriple& corner = facet.mesh.facets[facet.facet];
    double spread = 0;
    for (std::size_t k = 0; k < 3; ++k) {
        const Vec3 a = normalize_or_zero(facet.mesh.rays[corner[k]].direction),
                   b = normalize_or_zero(facet.mesh.rays[corner[(k + 1) % 3]].direction);
        spread = std::max(spread, length(a - b));
    }
    return spread;
}

void TileCutter::add_facet(const FacetOnScreen& facet, std::span<const Id> samples) {
    LatticeExtent all;
    for_each_run(grid_, samples, [&](const LatticeRun& run) {
        all.include(run.first);
        all.include(run.last());
    });
    // Most facets: nothing to divide, whatever their spread.
    if (all.x1 - all.x0 < side_ && all.y1 - all.y0 < side_) {
        tiles.push_back({facet, samples, all, true});
        return;
    }
    // Even parts; more where they stay half as wide as they may be and the rays spread.
    const double spread = spread_of(facet);
    const auto parts = [&](int length) {
        const int wanted = static_cast<int>(std::min(1e4, std::ceil(spread / kTileSpread)));
        return std::max((length + side_ - 1) / side_, std::min(wanted, 2 * length / side_));
    };
    const CellsOfFacet cells(all, parts(all.x1 - all.x0 + 1), parts(all.y1 - all.y0 + 1));
    std::vector<std::size_t> start(cells.count() + 1, 0);
    cells.for_each_part(grid_, samples, [&](std::size_t cell, const LatticeRun& part) {
        start[cell + 1] += static_cast<std::size_t>(part.count);
    });
    for (std::size_t c = 1; c < start.size(); ++c) start[c] += start[c - 1];
    std::vector<LatticeExtent> extent(start.size());
    std::vector<std::size_t> next(start.begin(), start.end() - 1);
    binned.emplace_back(samples.size());
    cells.for_each_part(grid_, samples, [&](std::size_t cell, const LatticeRun& part) {
        Id* const to = binned.back().data() + next[cell];
        std::iota(to, to + part.count, part.sample);
        next[cell] += static_cast<std::size_t>(part.count);
        extent[cell].include(part.first);
        extent[cell].include(part.last());
    });
    for (std::size_t c = 0; c + 1 < start.size(); ++c) {
        if (start[c] == start[c + 1]) continue;
        const std::span<const Id> own = std::span(binned.back()).subspan(start[c], start[c + 1] - start[c]);
        tiles.push_back({facet, own, extent[c], false});
    }
}

/// Sorts tiles into groups of neighbours on the film.
class Grouping {
  public:
    Grouping(const TileParams& params, const std::vector<RoughTile>& tiles) : params_(params) {
        places_.reserve(tiles.size());
        for (Id i = 0; i < tiles.size(); ++i) {
            const LatticeExtent& e = tiles[i].extent;
            places_.push_back(
                {e.x0 + e.x1, e.y0 + e.y1, static_cast<std::uint32_t>(tiles[i].samples.size()), i});
        }
        if (!places_.empty()) cut(0, places_.size());
    }

    std::vector<TileGroup> groups;
    std::vector<RoughTile> in_order(const std::vector<RoughTile>& tiles) const {
        std::vector<RoughTile> sorted;
        sorted.reserve(tiles.size());
        for (const Place& place : places_) sorted.push_back(tiles[place.tile]);
        return sorted;
    }

  private:
    /// Twice a tile's middle.
    struct Place {
        int x = 0, y = 0;
        std::uint32_t samples = 0;
        Id tile = 0;
    };
    void cut(std::size_t first, std::size_t last);

    const TileParams& params_;
    std::vector<Place> places_;
};

void Grouping::cut(std::size_t first, std::size_t last) {
    int x0 = INT32_MAX, x1 = 0, y0 = INT32_MAX, y1 = 0;
    std::size_t samples = 0;
    for (std::size_t i = first; i < last; ++i) {
        const Place& place = places_[i];
        samples += place.samples;
        x0 = std::min(x0, place.x), x1 = std::max(x1, place.x);
        y0 = std::min(y0, place.y), y1 = std::max(y1, place.y);
    }
    const std::size_t count = last - first, most = params_.group_tiles;
    if (count == 1 || (count <= most && samples <= params_.group_samples)) {
        groups.push_back({static_cast<std::uint32_t>(first), static_cast<std::uint32_t>(count)});
        return;
    }
    std::size_t half = count / 2;
    if (count > most) {
        half = (count + most - 1) / most / 2 * most;
        if (half == 0 || half >= count) half = count / 2;
    }
    const auto begin = places_.begin() + static_cast<std::ptrdiff_t>(first);
    const int Place::*along = x1 - x0 > y1 - y0 ? &Place::x : &Place::y;
    std::nth_element(begin, begin + static_cast<std::ptrdiff_t>(half),
                     places_.begin() + static_cast<std::ptrdiff_t>(last),
                     [along](const Place& a, const Place& b) {
                         return a.*along != b.*along ? a.*along < b.*along : a.tile < b.tile;
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

TileParams tile_params(std::size_t triangles) {
    TileParams params;
    const double below = 0.7 * std::sqrt(static_cast<double>(triangles));
    params.mixed_below = static_cast<std::uint32_t>(std::clamp(below, 12.0, 1000.0));
    // Few facets in a vector are few rays to set up; a compact vector meets fewer of many triangles.
    if (triangles > 4000) params.together = 0;
    return params;
}

TilePlan plan_tiles(const RayMesh& mesh, const FacetSamples& owned, const SampleGrid& grid,
                    const TileParams& params) {
    TRILENS_CHECK(params.tile_side >= 1 && params.tile_side <= kLargestTile,
                  "a tile's slots must fit 16 bits");
    TRILENS_CHECK(params.group_tiles >= 1 && params.group_tiles <= kLanes, "a group's tiles are lanes");
    TilePlan plan;
    TileCutter cutter(grid, params.tile_side);
    for (std::size_t f = 0; f < mesh.facets.size(); ++f) {
        if (owned.of(f).empty() || !mesh.has_rays(f)) continue;
        const FacetOnScreen facet{mesh, f, facet_weights(mesh, f)};
        if (facet.weights.edge_on) continue;
        if (owned.of(f).size() >= params.mixed_below) {
            cutter.add_facet(facet, owned.of(f));
            continue;
        }
        for (const Id s : owned.of(f))
            plan.mixed.push_back({s, static_cast<std::uint32_t>(plan.mixed_facets.size())});
        plan.mixed_facets.push_back(facet);
    }
    plan.mixed_groups = sort_mixed(grid, params, plan.mixed);
    Grouping grouping(params, cutter.tiles);
    plan.tiles = grouping.in_order(cutter.tiles);
    plan.groups = std::move(grouping.groups);
    plan.batches = make_batches(plan.groups);
    plan.binned = std::move(cutter.binned);
    return plan;
}

SampleTiles make_sample_tiles(const RayMesh& mesh, const FacetSamples& owned, const SampleGrid& grid,
                              const TileParams& params) {
    const TilePlan plan = plan_tiles(mesh, owned, grid, params);
    SampleTiles tiles;
    tiles.vectors.reserve(owned.sample.size() / kLanes * 3 / 2 + 16);
    tiles.samples.reserve(owned.sample.size() / kLanes * 3 / 2 + 16);
    tiles.valid.reserve(owned.sample.size() / kLanes * 3 / 2 + 16);
    tiles.tiles.reserve(plan.tiles.size());
    TileMaker maker(grid);
    for (std::size_t b = 0; b < plan.batches.size(); ++b) maker.add_batch(plan, b, tiles);
    for (std::size_t g = 0; g < plan.mixed_groups.size(); ++g) maker.add_mixed(plan, g, tiles);
    return tiles;
}

TileFrame tile_frame(const SampleTile& tile, const SampleGrid& grid) {
    const double side = grid.side;
    return {
        {grid.x0 + (tile.column + 0.5 * tile.width) / side, grid.y0 + (tile.row + 0.5 * tile.height) / side},
        {std::max(0.5, 0.5 * (tile.width - 1)) / side, std::max(0.5, 0.5 * (tile.height - 1)) / side}};
}

}  // namespace trilens
