// Fuzz target of terrains: random heights become triangles, which must cover what has heights once, and be as
// near to it as is said.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <utility>

#include "fuzz/grammar.h"
#include "fuzz/target.h"
#include "terrain/terrain.h"

using namespace trilens;

namespace trilens_fuzz {
namespace {

struct RandomTerrain {
    HeightGrid heights;
    TerrainShape shape;
    Thinning thinning;
};

float random_height(Choices& choose) {
    constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
    switch (choose.below(8)) {
        case 0:
            return 0;
        case 1:
            return choose.chance(96) ? kNone : 1;
        case 2:
            return choose.chance(24) ? std::numeric_limits<float>::infinity() : 0.5f;
        default:
            return static_cast<float>(choose.between(0, 1));
    }
}

RandomTerrain terrain_of(std::string_view bytes) {
    Choices choose(bytes);
    RandomTerrain terrain;
    HeightGrid& grid = terrain.heights;
    grid.columns = 2 + choose.below(24), grid.rows = 2 + choose.below(24);
    terrain.shape.size = {choose.log_between(1e-3, 1e3), choose.log_between(1e-3, 1e3),
                          choose.log_between(1e-3, 1e3)};
    if (choose.chance(64)) terrain.shape.no_data = choose.of(std::array{0.0, 1.0, 0.5});
    terrain.thinning.rule =
        choose.of(std::array{ThinningRule::kBound, ThinningRule::kLinear, ThinningRule::kHaar});
    terrain.thinning.threshold = choose.chance(32) ? 0 : terrain.shape.size.y * choose.log_between(1e-4, 2);
    if (choose.chance(64)) {
        InterestRegion& region = terrain.thinning.region.emplace();
        region.center = {choose.between(-1, 1) * terrain.shape.size.x,
                         choose.between(-1, 1) * terrain.shape.size.z};
        region.radii = {choose.log_between(1e-2, 2) * terrain.shape.size.x,
                        choose.log_between(1e-2, 2) * terrain.shape.size.z};
    }
    // A slope under what the bytes say, so that a terrain of few bytes is thinned.
    for (int row = 0; row < grid.rows; ++row)
        for (int column = 0; column < grid.columns; ++column)
            grid.values.push_back(random_height(choose) + 0.01f * static_cast<float>(row + 2 * column));
    return terrain;
}

bool has_height(const RandomTerrain& terrain, int column, int row) {
    const float value = terrain.heights.at(column, row);
    return std::isfinite(value) && !(terrain.shape.no_data && double{value} == *terrain.shape.no_data);
}

/// Twice the area on the ground, positive for fronts that look upwards: z is down the rows.
double twice_area(const TerrainMesh& mesh, const IdTriple& triangle) {
    const Vec3 &a = mesh.points[triangle[0]], &b = mesh.points[triangle[1]], &c = mesh.points[triangle[2]];
    return (c.x - a.x) * (b.z - a.z) - (b.x - a.x) * (c.z - a.z);
}

/// Each edge runs once in each direction at most. Returns the area on the ground, in cells.
double require_sheet(const RandomTerrain& terrain, const TerrainMesh& mesh) {
    const double cell = terrain.shape.size.x / (terrain.heights.columns - 1) * terrain.shape.size.z /
                        (terrain.heights.rows - 1);
    double area = 0;
    std::map<std::pair<Id, Id>, int> edges;
    for (const IdTriple& triangle : mesh.triangles) {
        for (std::size_t k = 0; k < 3; ++k) {
            require(triangle[k] < mesh.points.size(), "a corner that is no point");
            require(++edges[{triangle[k], triangle[(k + 1) % 3]}] == 1,
                    "two triangles on one side of an edge");
        }
        const double twice = twice_area(mesh, triangle);
        require(twice > 0, "a triangle that looks down, or none at all");
        area += 0.5 * twice / cell;
    }
    return area;
}

/// All cells with four heights are covered, and of those with three at most half.
void require_holes(const RandomTerrain& terrain, double area) {
    int whole = 0, torn = 0;
    for (int row = 0; row + 1 < terrain.heights.rows; ++row)
        for (int column = 0; column + 1 < terrain.heights.columns; ++column) {
            const int corners = has_height(terrain, column, row) + has_height(terrain, column + 1, row) +
                                has_height(terrain, column, row + 1) +
                                has_height(terrain, column + 1, row + 1);
            whole += corners == 4;
            torn += corners == 3;
        }
    require(area >= whole - 1e-6 && area <= whole + 0.5 * torn + 1e-6,
            fmt::format("triangles cover {} cells: {} have four heights, {} three", area, whole, torn));
}

/// Of a triangle over a place of the ground; none where it lies beside it.
std::optional<double> height_over(const TerrainMesh& mesh, const IdTriple& triangle, const Vec2& place) {
    const Vec3 &a = mesh.points[triangle[0]], &b = mesh.points[triangle[1]], &c = mesh.points[triangle[2]];
    const double whole = twice_area(mesh, triangle);
    const double v = ((c.x - a.x) * (place.y - a.z) - (place.x - a.x) * (c.z - a.z)) / whole,
                 w = ((place.x - a.x) * (b.z - a.z) - (b.x - a.x) * (place.y - a.z)) / whole;
    constexpr double kRounding = 1e-9;
    if (v < -kRounding || w < -kRounding || v + w > 1 + kRounding) return std::nullopt;
    return a.y + v * (b.y - a.y) + w * (c.y - a.y);
}

/// No sample lies farther from the triangles over it than is said.
void require_near(const RandomTerrain& terrain, const TerrainMesh& mesh) {
    const HeightGrid& grid = terrain.heights;
    const Vec3& size = terrain.shape.size;
    double worst = 0;
    for (int row = 0; row < grid.rows; ++row)
        for (int column = 0; column < grid.columns; ++column) {
            if (!has_height(terrain, column, row)) continue;
            const Vec2 place(size.x * (double{1} * column / (grid.columns - 1) - 0.5),
                             size.z * (double{1} * row / (grid.rows - 1) - 0.5));
            for (const IdTriple& triangle : mesh.triangles)
                if (const auto height = height_over(mesh, triangle, place))
                    worst = std::max(worst, std::fabs(*height - size.y * double{grid.at(column, row)}));
        }
    require(worst <= mesh.greatest_error + 1e-6 * size.y,
            fmt::format("a sample is off by {}, which is to be {} at most", worst, mesh.greatest_error));
}

/// Returns the area on the ground, in cells.
double require_terrain(const RandomTerrain& terrain, const std::optional<Thinning>& thinning) {
    const TerrainMesh mesh = make_terrain(terrain.heights, terrain.shape, thinning);
    require(mesh.normals.size() == mesh.points.size() && mesh.uvs.size() == mesh.points.size(),
            "points without normals or places");
    for (const Vec3& normal : mesh.normals)
        require(std::fabs(length(normal) - 1) < 1e-9, "a normal that is not unit");
    // Where the last column and row cut the quadtree, triangles become two or three.
    const auto cut = 3 * static_cast<std::size_t>(terrain.heights.columns + terrain.heights.rows);
    require(mesh.triangles.size() <= mesh.whole_triangles + (thinning ? cut : 0),
            fmt::format("{} triangles, {} in the whole grid", mesh.triangles.size(), mesh.whole_triangles));
    require(thinning || mesh.greatest_error == 0, "the whole grid is off from itself");
    require(mesh.rms_error <= mesh.greatest_error * (1 + 1e-9), "a mean above the greatest");
    if (thinning && thinning->rule == ThinningRule::kBound && !thinning->region)
        require(mesh.greatest_error <= thinning->threshold * (1 + 1e-6) + 1e-6 * terrain.shape.size.y,
                fmt::format("off by {}, more than {}", mesh.greatest_error, thinning->threshold));
    require_near(terrain, mesh);
    return require_sheet(terrain, mesh);
}

}  // namespace

Answer random_terrain(std::string_view bytes) {
    return answer([&] {
        const RandomTerrain terrain = terrain_of(bytes);
        const double whole = require_terrain(terrain, std::nullopt);
        require_holes(terrain, whole);
        const double thinned = require_terrain(terrain, terrain.thinning);
        require(std::fabs(thinned - whole) < 1e-6,
                fmt::format("thinned triangles cover {} cells, all of them {}", thinned, whole));
    });
}

}  // namespace trilens_fuzz
