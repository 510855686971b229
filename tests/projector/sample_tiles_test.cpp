// Tiles, vectors and groups: every owned sample once, where the tables say it is.
#include "projector/tiles/sample_tiles.h"

#include <algorithm>
#include <map>

#include "base/raymesh/rasterize.h"
#include "film_mesh.h"
#include "random_cases.h"
#include "support/test.h"

using namespace trilens;
using namespace trilens_test;

namespace {

RayMesh flat_mesh(const SampleGrid& grid, int cells) {
    return film_mesh(grid, cells, [](double x, double y) { return Ray{Vec3(x, y, 0), Vec3(0, 0, 1)}; });
}

/// Where local coordinates (u, v) of a tile lie on the screen.
Vec2 on_screen(const SampleTile& tile, const SampleGrid& grid, float u, float v) {
    const TileFrame frame = tile_frame(tile, grid);
    return frame.centre + Vec2(u, v) * frame.half;
}

/// Without every fifth sample: rows with gaps.
FacetSamples without_some(const FacetSamples& owned) {
    FacetSamples left{{0}, {}};
    for (std::size_t f = 0; f + 1 < owned.first.size(); ++f) {
        for (const Id s : owned.of(f))
            if (s % 5 != 0) left.sample.push_back(s);
        left.first.push_back(left.sample.size());
    }
    return left;
}

}  // namespace

TEST_CASE("every owned sample is in one lane, whose place, box and slot are its own", "[projector][law]") {
    for (const int side : {1, 2, 3}) {
        for (const auto& [cells, gaps] :
             {std::pair(1, false), {1, true}, {7, false}, {7, true}, {40, false}}) {
            const SampleGrid grid{-3, 11, 94, 80, side};
            const RayMesh mesh = flat_mesh(grid, cells);
            const FacetSamples all = rasterize_facets(mesh, grid), owned = gaps ? without_some(all) : all;
            TileParams params;
            params.tile_side = 20;
            params.mixed_below = 30;
            params.together = side == 2 ? 0 : 24;
            const SampleTiles tiles = make_sample_tiles(mesh, owned, grid, params);
            std::vector<int> seen(grid.size(), 0);
            std::size_t misplaced = 0, outside = 0, wrong_slot = 0, foreign = 0, mixed = 0, not_first = 0;
            std::vector<std::size_t> owner(grid.size(), 0);
            for (std::size_t f = 0; f < mesh.facets.size(); ++f)
                for (const Id s : owned.of(f)) owner[s] = f;
            for (const SampleTile& tile : tiles.tiles) {
                CHECK(tile.width <= params.tile_side);
                CHECK(tile.height <= params.tile_side);
                std::map<Id, bool> of_facet;
                for (const Id s : owned.of(tile.facet)) of_facet[s] = true;
                for (std::uint32_t v = 0; v < tile.vectors; ++v) {
                    const SampleVector& vector = tiles.vectors[tile.first_vector + v];
                    const VectorSamples& ids = tiles.samples[tile.first_vector + v];
                    const std::uint32_t valid = tiles.valid[tile.first_vector + v];
                    not_first += (valid & (valid + 1)) != 0;
                    const VectorBoxes& box = tiles.boxes[tile.first_boxes + v / kLanes];
                    for (std::size_t k = 0; k < kLanes; ++k) {
                        outside += std::fabs(vector.u[k] - box.centre_u[v % kLanes]) > box.half_u[v % kLanes];
                        outside += std::fabs(vector.v[k] - box.centre_v[v % kLanes]) > box.half_v[v % kLanes];
                        const Vec2 gap =
                            on_screen(tile, grid, vector.u[k], vector.v[k]) - grid.position(ids.sample[k]);
                        misplaced += length(gap) > 1e-5;
                        if (!(valid >> k & 1)) continue;
                        ++seen[ids.sample[k]];
                        foreign += !of_facet.count(ids.sample[k]);
                        const Vec2 from =
                            (grid.position(ids.sample[k]) - Vec2(grid.x0, grid.y0)) * double(side);
                        const std::size_t cell =
                            static_cast<std::size_t>((int(std::floor(from.y)) - tile.row) * tile.width +
                                                     int(std::floor(from.x)) - tile.column);
                        wrong_slot += tiles.slot[tile.first_slot + cell] != v * kLanes + k;
                    }
                }
            }
            for (const MixedGroup& group : tiles.mixed) {
                CHECK(group.vectors <= kLanes);
                // Near each other, however few they are.
                float least = 1e9f, most = 0;
                for (std::uint32_t v = group.first_vector; v < group.first_vector + group.vectors; ++v) {
                    least =
                        std::min(least, *std::min_element(tiles.vectors[v].u, tiles.vectors[v].u + kLanes));
                    most = std::max(most, *std::max_element(tiles.vectors[v].u, tiles.vectors[v].u + kLanes));
                }
                CHECK(most - least < static_cast<float>(kLanes));
                for (std::uint32_t v = 0; v < group.vectors; ++v) {
                    const SampleVector& vector = tiles.vectors[group.first_vector + v];
                    const VectorSamples& ids = tiles.samples[group.first_vector + v];
                    const std::uint32_t valid = tiles.valid[group.first_vector + v];
                    not_first += (valid & (valid + 1)) != 0;
                    for (std::size_t k = 0; k < kLanes; ++k) {
                        const Vec2 place =
                            (Vec2(vector.u[k], vector.v[k]) + 0.5) / double(side) + Vec2(grid.x0, grid.y0);
                        misplaced += length(place - grid.position(ids.sample[k])) > 1e-9;
                        if (!(valid >> k & 1)) continue;
                        ++seen[ids.sample[k]];
                        ++mixed;
                        // The rays of a facet that owns the sample: the same bits as its own.
                        const FacetRays& rays = tiles.rays[tiles.lanes[group.first_lanes + v].rays[k]];
                        const SampleRay ray = rays.at(grid.position(ids.sample[k]));
                        const FacetRays own = make_facet_rays(
                            {mesh, owner[ids.sample[k]], facet_weights(mesh, owner[ids.sample[k]])});
                        foreign += ray.origin != own.at(grid.position(ids.sample[k])).origin ||
                                   rays.screen != own.screen || rays.centre != own.centre;
                    }
                }
            }
            CHECK((mixed > 0) == (cells == 40));
            CHECK(misplaced == 0);
            CHECK(outside == 0);
            CHECK(wrong_slot == 0);
            CHECK(foreign == 0);
            CHECK(not_first == 0);
            std::size_t wrong = 0;
            for (const Id s : owned.sample) wrong += seen[s] != 1;
            CHECK(wrong == 0);
        }
    }
}

TEST_CASE("groups and batches hold every tile once, within their limits, as one range of vectors",
          "[projector][law]") {
    const SampleGrid grid{0, 0, 200, 150, 1};
    const RayMesh mesh = flat_mesh(grid, 23);
    const FacetSamples owned = rasterize_facets(mesh, grid);
    TileParams params;
    params.mixed_below = 0;
    const SampleTiles tiles = make_sample_tiles(mesh, owned, grid, params);
    REQUIRE(tiles.groups.size() > 10);
    std::uint32_t next_tile = 0, next_group = 0, next_vector = 0;
    for (const TileGroup& batch : tiles.batches) {
        CHECK(batch.first == next_group);
        std::uint32_t in_batch = 0;
        for (std::uint32_t g = batch.first; g < batch.first + batch.count; ++g) {
            const TileGroup& group = tiles.groups[g];
            CHECK(group.first == next_tile);
            CHECK(group.count >= 1);
            std::size_t samples = 0;
            for (std::uint32_t t = group.first; t < group.first + group.count; ++t) {
                CHECK(tiles.tiles[t].first_vector == next_vector);
                next_vector += tiles.tiles[t].vectors;
                samples += tiles.tiles[t].samples;
            }
            CHECK((group.count == 1 || samples <= params.group_samples));
            next_tile += group.count;
            in_batch += group.count;
        }
        CHECK(in_batch <= kLanes);
        next_group += batch.count;
    }
    CHECK(next_tile == tiles.tiles.size());
    CHECK(next_group == tiles.groups.size());
    CHECK(next_vector == tiles.vectors.size());
}
