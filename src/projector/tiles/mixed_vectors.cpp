// Vectors of facets with few samples: neighbours share a vector, whatever their facets.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "projector/exact/exact_hit.h"
#include "projector/tiles/sample_tiles.h"

namespace trilens {
namespace {

constexpr int kCell = 4;  // samples along a cell's edge, and cells along a square's

Vec2 position_of(const SampleGrid& grid, int column, int row) {
    if (grid.side == 1) return {grid.x0 + (column + 0.5), grid.y0 + (row + 0.5)};
    return {grid.x0 + (column + 0.5) / grid.side, grid.y0 + (row + 0.5) / grid.side};
}

/// Widens the group's bounds by a facet's rays through its samples.
void include_rays(const FacetRays& facet, const SampleGrid& grid, const MixedExtent& samples,
                  MixedGroup& group) {
    const LatticeExtent& extent = samples.extent;
    const Vec2 reach = glm::max(glm::abs(position_of(grid, extent.x0, extent.y0) - facet.screen),
                                glm::abs(position_of(grid, extent.x1, extent.y1) - facet.screen));
    const std::array<double, 3>& w = facet.rays.weight;
    double terms = std::fabs(w[0]) + reach.x * std::fabs(w[1]) + reach.y * std::fabs(w[2]);
    const double least = samples.least_weight - kDecisionErrorBound * terms;
    const double scale = least > 0 ? 1 / least : std::numeric_limits<double>::infinity();
    double origin = 0, direction = 0, shift = 0;
    for (int a = 0; a < 3; ++a) {
        origin += std::fabs(facet.rays.origin[0][a]) + reach.x * std::fabs(facet.rays.origin[1][a]) +
                  reach.y * std::fabs(facet.rays.origin[2][a]);
        direction += std::fabs(facet.rays.direction[0][a]) + reach.x * std::fabs(facet.rays.direction[1][a]) +
                     reach.y * std::fabs(facet.rays.direction[2][a]);
        shift += std::fabs(facet.centre[a] - group.centre[a]);
    }
    terms *= scale;
    group.weight_terms = std::max(group.weight_terms, terms);
    group.origin_terms = std::max(group.origin_terms, origin * scale + terms * shift);
    group.direction_terms = std::max(group.direction_terms, direction * scale);
    // Not a number: no bound.
    if (!(scale * (1 + origin + direction + terms + shift) < std::numeric_limits<double>::infinity()))
        group.weight_terms = std::numeric_limits<double>::infinity();
}

/// Numbers the cells of a lattice that begins at (0, 0): square by square, `across` of them in a row, and
/// inside a square there and back by rows.
struct CellOrder {
    std::size_t across;

    static constexpr unsigned kSquare = kCell * kCell;

    std::uint32_t of_cell(unsigned square_x, unsigned square_y, unsigned x, unsigned y) const {
        static_assert((kCell & (kCell - 1)) == 0);
        return static_cast<std::uint32_t>((square_y * across + square_x) * kSquare + y * kCell +
                                          (y % 2 ? kCell - 1 - x : x));
    }
    std::uint32_t of(const LatticeSample& s) const {
        const unsigned x = static_cast<unsigned>(s.column), y = static_cast<unsigned>(s.row);
        return of_cell(x / kSquare, y / kSquare, x / kCell % kCell, y / kCell % kCell);
    }
    /// In the square of `s`: the cell next to another sample's.
    std::uint32_t near(const LatticeSample& other, const LatticeSample& s) const {
        const unsigned square_x = static_cast<unsigned>(s.column) / kSquare,
                       square_y = static_cast<unsigned>(s.row) / kSquare;
        const auto inside = [](int line, unsigned square) {
            return static_cast<unsigned>(
                std::clamp(line / kCell - static_cast<int>(square) * kCell, 0, kCell - 1));
        };
        return of_cell(square_x, square_y, inside(other.column, square_x), inside(other.row, square_y));
    }
};

}  // namespace

std::vector<TileGroup> sort_mixed(const SampleGrid& grid, const TileParams& params,
                                  std::vector<MixedSample>& samples) {
    static_assert(kCell * kCell * kCell * kCell == kMixedSamples);
    if (samples.empty()) return {};
    LatticeExtent all;
    LatticeWalk walk(grid);
    std::vector<LatticeSample> place(samples.size());
    for (std::size_t i = 0; i < samples.size(); ++i) {
        place[i] = walk.at(samples[i].sample);
        all.include(place[i]);
    }
    for (LatticeSample& s : place) s = {s.column - all.x0, s.row - all.y0};
    const std::size_t across = static_cast<std::size_t>((all.x1 - all.x0) / (kCell * kCell) + 1),
                      down = static_cast<std::size_t>((all.y1 - all.y0) / (kCell * kCell) + 1);
    std::vector<std::uint32_t> cell(samples.size()), next(across * down * kCell * kCell + 1, 0);
    const CellOrder order{across};
    // Samples of one facet follow each other: those of small ones are put in one cell, so that few vectors
    // share a facet.
    for (std::size_t first = 0, last = 0; first < samples.size(); first = last) {
        LatticeSample sum;
        for (; last < samples.size() && samples[last].facet == samples[first].facet; ++last) {
            sum.column += place[last].column;
            sum.row += place[last].row;
            cell[last] = order.of(place[last]);
        }
        const int count = static_cast<int>(last - first);
        const LatticeSample middle{sum.column / count, sum.row / count};
        for (std::size_t i = first; i < last && last - first <= params.together; ++i)
            cell[i] = order.near(middle, place[i]);
        for (std::size_t i = first; i < last; ++i) ++next[cell[i] + 1];
    }
    for (std::size_t c = 1; c < next.size(); ++c) next[c] += next[c - 1];
    std::vector<MixedSample> sorted(samples.size());
    for (std::size_t i = 0; i < samples.size(); ++i) sorted[next[cell[i]]++] = samples[i];
    samples = std::move(sorted);
    // `next` has become where the cells end.
    std::vector<TileGroup> groups;
    std::uint32_t first = 0;
    for (std::size_t square = 1; square <= across * down; ++square) {
        const std::uint32_t last = next[square * kCell * kCell - 1];
        if (last > first) groups.push_back({first, last - first});
        first = last;
    }
    return groups;
}

/// Numbers the facets of a group's samples as they come, in mixed_facets_, and names each sample's number in
/// mixed_places_.
void TileMaker::number_mixed_facets(std::span<const MixedSample> samples) {
    // By the facet's last bits: its number, and those with the same bits after it.
    constexpr std::size_t kEntries = 2 * kMixedSamples;
    constexpr std::uint16_t kEmpty = 65535;
    std::array<std::uint16_t, kEntries> number;
    number.fill(kEmpty);
    mixed_facets_.clear();
    mixed_places_.resize(samples.size());
    std::uint16_t last = 0;
    for (std::size_t i = 0; i < samples.size(); ++i) {
        const std::uint32_t facet = samples[i].facet;
        if (i == 0 || facet != samples[i - 1].facet) {
            std::size_t at = facet % kEntries;
            while (number[at] != kEmpty && mixed_facets_[number[at]] != facet) at = (at + 1) % kEntries;
            if (number[at] == kEmpty) {
                number[at] = static_cast<std::uint16_t>(mixed_facets_.size());
                mixed_facets_.push_back(facet);
            }
            last = number[at];
        }
        mixed_places_[i] = last;
    }
}

void TileMaker::add_mixed(const TilePlan& plan, std::size_t number, SampleTiles& tiles) {
    const std::size_t count = plan.mixed_groups[number].count;
    const std::span<const MixedSample> samples =
        std::span(plan.mixed).subspan(plan.mixed_groups[number].first, count);
    number_mixed_facets(samples);
    MixedGroup group;
    group.first_vector = static_cast<std::uint32_t>(tiles.vectors.size());
    group.vectors = static_cast<std::uint32_t>((count + kLanes - 1) / kLanes);
    group.first_lanes = static_cast<std::uint32_t>(tiles.lanes.size());
    const std::size_t first_rays = tiles.rays.size();
    group.first_rays = static_cast<std::uint32_t>(first_rays);
    group.facets = static_cast<std::uint32_t>(mixed_facets_.size());
    for (const std::uint32_t facet : mixed_facets_)
        tiles.rays.push_back(make_facet_rays(plan.mixed_facets[facet]));
    group.centre = tiles.rays[first_rays].centre;
    mixed_extents_.assign(mixed_facets_.size(), {});

    LatticeWalk walk(*grid_);
    for (std::size_t first = 0; first < count; first += kLanes) {
        const std::size_t own = std::min(kLanes, count - first);
        SampleVector& vector = tiles.vectors.emplace_back();
        LaneFacets& lanes = tiles.lanes.emplace_back();
        VectorSamples& ids = tiles.samples.emplace_back();
        tiles.valid.push_back(static_cast<std::uint16_t>((1u << own) - 1));
        for (std::size_t lane = 0; lane < kLanes; ++lane) {
            const std::size_t i = first + std::min(lane, own - 1);
            const LatticeSample at = walk.at(samples[i].sample);
            const std::size_t place = mixed_places_[i];
            const FacetRays& rays = tiles.rays[first_rays + place];
            const Vec2 from = position_of(*grid_, at.column, at.row) - rays.screen;
            MixedExtent& extent = mixed_extents_[place];
            extent.extent.include(at);
            extent.least_weight = std::min(extent.least_weight, rays.rays.weight_at(from.x, from.y));
            vector.u[lane] = static_cast<float>(at.column);
            vector.v[lane] = static_cast<float>(at.row);
            lanes.rays[lane] = static_cast<Id>(first_rays + place);
            ids.sample[lane] = samples[i].sample;
        }
    }
    for (std::size_t f = 0; f < mixed_facets_.size(); ++f)
        include_rays(tiles.rays[first_rays + f], *grid_, mixed_extents_[f], group);
    tiles.mixed.push_back(group);
}

}  // namespace trilens
