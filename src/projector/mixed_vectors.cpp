// Vectors of facets with few samples: neighbours share a vector, whatever their facets.
#include <algorithm>
#include <cmath>
#include <limits>

#include "projector/decide.h"
#include "projector/sample_tiles.h"

namespace trilens {
namespace {

constexpr int kCell = 4;  // samples along a cell's edge, and cells along a square's

Vec2 position_of(const SampleGrid& grid, int column, int row) {
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
    const double least = samples.least_weight - kDecisionDoubt * terms;
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

}  // namespace

std::vector<TileGroup> sort_mixed(const SampleGrid& grid, const TileParams& params,
                                  std::vector<MixedSample>& samples) {
    static_assert(kCell * kCell * kCell * kCell == kMixedSamples);
    if (samples.empty()) return {};
    LatticeExtent all;
    LatticeWalk walk(grid);
    for (const MixedSample& s : samples) all.include(walk.at(s.sample));
    const std::size_t across = static_cast<std::size_t>((all.x1 - all.x0) / (kCell * kCell) + 1),
                      down = static_cast<std::size_t>((all.y1 - all.y0) / (kCell * kCell) + 1);
    // The square of (x, y), and in it the cell next to (near_x, near_y), there and back by rows.
    const auto cell_of = [&](int x, int y, int near_x, int near_y) {
        const int square_x = x / (kCell * kCell), square_y = y / (kCell * kCell);
        const int cell_x = std::clamp(near_x / kCell - square_x * kCell, 0, kCell - 1),
                  cell_y = std::clamp(near_y / kCell - square_y * kCell, 0, kCell - 1);
        const std::size_t square =
            static_cast<std::size_t>(square_y) * across + static_cast<std::size_t>(square_x);
        return square * kCell * kCell +
               static_cast<std::size_t>(cell_y * kCell + (cell_y % 2 ? kCell - 1 - cell_x : cell_x));
    };
    std::vector<std::uint32_t> cell(samples.size()), next(across * down * kCell * kCell + 1, 0);
    // Samples of one facet follow each other: those of small ones are put in one cell, so that few vectors
    // share a facet.
    for (std::size_t first = 0, last = 0; first < samples.size(); first = last) {
        int x_sum = 0, y_sum = 0;
        for (; last < samples.size() && samples[last].facet == samples[first].facet; ++last) {
            const LatticeSample at = walk.at(samples[last].sample);
            x_sum += at.column - all.x0;
            y_sum += at.row - all.y0;
        }
        const int count = static_cast<int>(last - first);
        for (std::size_t i = first; i < last; ++i) {
            const LatticeSample at = walk.at(samples[i].sample);
            const int x = at.column - all.x0, y = at.row - all.y0;
            const bool together = count <= static_cast<int>(params.together);
            cell[i] = static_cast<std::uint32_t>(
                cell_of(x, y, together ? x_sum / count : x, together ? y_sum / count : y));
            ++next[cell[i] + 1];
        }
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

void TileMaker::add_mixed(const TilePlan& plan, std::size_t number, SampleTiles& tiles) {
    const std::size_t count = plan.mixed_groups[number].count;
    const std::span<const MixedSample> samples =
        std::span(plan.mixed).subspan(plan.mixed_groups[number].first, count);
    mixed_facets_.clear();
    for (const MixedSample& s : samples)
        if (mixed_facets_.empty() || mixed_facets_.back() != s.facet) mixed_facets_.push_back(s.facet);
    std::sort(mixed_facets_.begin(), mixed_facets_.end());
    mixed_facets_.erase(std::unique(mixed_facets_.begin(), mixed_facets_.end()), mixed_facets_.end());

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
    std::size_t place = 0;
    for (std::size_t i = 0; i < group.vectors * kLanes; ++i) {
        const std::size_t lane = i % kLanes;
        const MixedSample& s = samples[std::min(i, count - 1)];
        if (lane == 0) {
            tiles.vectors.emplace_back();
            tiles.lanes.emplace_back();
            tiles.samples.emplace_back().valid = (1u << std::min(kLanes, count - i)) - 1;
        }
        if (mixed_facets_[place] != s.facet)
            place = static_cast<std::size_t>(
                std::lower_bound(mixed_facets_.begin(), mixed_facets_.end(), s.facet) -
                mixed_facets_.begin());
        const LatticeSample at = walk.at(s.sample);
        const FacetRays& rays = tiles.rays[first_rays + place];
        const Vec2 from = position_of(*grid_, at.column, at.row) - rays.screen;
        MixedExtent& extent = mixed_extents_[place];
        extent.extent.include(at);
        extent.least_weight = std::min(extent.least_weight, rays.rays.weight_at(from.x, from.y));
        tiles.vectors.back().u[lane] = static_cast<float>(at.column);
        tiles.vectors.back().v[lane] = static_cast<float>(at.row);
        tiles.lanes.back().rays[lane] = static_cast<Id>(first_rays + place);
        tiles.samples.back().sample[lane] = s.sample;
    }
    for (std::size_t f = 0; f < mixed_facets_.size(); ++f)
        include_rays(tiles.rays[first_rays + f], *grid_, mixed_extents_[f], group);
    tiles.mixed.push_back(group);
}

}  // namespace trilens
