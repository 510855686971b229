// Terrains' triangles: no cracks, no more error than was allowed, holes where heights are missing.
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <stdexcept>
#include <vector>

#include "base/util/parallel.h"
#include "support/mountains.h"
#include "support/test.h"
#include "terrain/terrain.h"

using namespace trilens;
using namespace trilens_test;

namespace {

const Vec3 kSize(8, 1.5, 6);

TerrainMesh thinned(const HeightGrid& heights, ThinningRule rule, double threshold) {
    return make_terrain(heights, {kSize, {}}, Thinning{rule, threshold, {}});
}

/// Along y at every sample, by looking for the triangle there: nothing of how the triangles came to be.
/// NaN where there is none.
std::vector<double> heights_by_search(const TerrainMesh& mesh, const HeightGrid& heights) {
    std::vector<double> found(heights.values.size(), std::numeric_limits<double>::quiet_NaN());
    const auto place = [&](const Vec3& p) {
        return Vec2((p.x / kSize.x + 0.5) * (heights.columns - 1),
                    (p.z / kSize.z + 0.5) * (heights.rows - 1));
    };
    for (const auto& [ia, ib, ic] : mesh.triangles) {
        const Vec2 a = place(mesh.points[ia]), b = place(mesh.points[ib]), c = place(mesh.points[ic]);
        const double area = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
        REQUIRE(area < 0);  // down the picture is towards us: the front is up
        const int x0 = static_cast<int>(std::floor(std::min({a.x, b.x, c.x}))),
                  x1 = static_cast<int>(std::ceil(std::max({a.x, b.x, c.x})));
        const int y0 = static_cast<int>(std::floor(std::min({a.y, b.y, c.y}))),
                  y1 = static_cast<int>(std::ceil(std::max({a.y, b.y, c.y})));
        for (int y = std::max(0, y0); y <= std::min(y1, heights.rows - 1); ++y)
            for (int x = std::max(0, x0); x <= std::min(x1, heights.columns - 1); ++x) {
                const double wb = ((x - a.x) * (c.y - a.y) - (y - a.y) * (c.x - a.x)) / area;
                const double wc = ((b.x - a.x) * (y - a.y) - (b.y - a.y) * (x - a.x)) / area;
                if (wb < -1e-9 || wc < -1e-9 || wb + wc > 1 + 1e-9) continue;
                const double here =
                    (1 - wb - wc) * mesh.points[ia].y + wb * mesh.points[ib].y + wc * mesh.points[ic].y;
                double& height = found[static_cast<std::size_t>(y * heights.columns + x)];
                if (!std::isnan(height)) REQUIRE(height == Approx(here).margin(1e-9));  // neighbours agree
                height = here;
            }
    }
    return found;
}

double worst_error(const TerrainMesh& mesh, const HeightGrid& heights) {
    const std::vector<double> found = heights_by_search(mesh, heights);
    double worst = 0;
    for (std::size_t i = 0; i < found.size(); ++i) {
        REQUIRE(!std::isnan(found[i]));
        worst = std::max(worst, std::fabs(found[i] - static_cast<double>(heights.values[i]) * kSize.y));
    }
    return worst;
}

/// Of the grid, seen from above.
double area_of(const TerrainMesh& mesh) {
    double area = 0;
    for (const auto& [a, b, c] : mesh.triangles)
        area += 0.5 * cross(mesh.points[b] - mesh.points[a], mesh.points[c] - mesh.points[a]).y;
    return area;
}

/// Every side belongs to two triangles that run along it in opposite directions, or lies on the grid's
/// border.
void check_closed(const TerrainMesh& mesh) {
    std::map<std::pair<Id, Id>, int> sides;
    for (const IdTriple& t : mesh.triangles)
        for (std::size_t k = 0; k < 3; ++k) ++sides[{t[k], t[(k + 1) % 3]}];
    const auto on_border = [&](const Vec3& a, const Vec3& b) {
        const auto both = [](double p, double q, double at) {
            return std::fabs(p - at) < 1e-12 && std::fabs(q - at) < 1e-12;
        };
        return both(a.x, b.x, -kSize.x / 2) || both(a.x, b.x, kSize.x / 2) || both(a.z, b.z, -kSize.z / 2) ||
               both(a.z, b.z, kSize.z / 2);
    };
    for (const auto& [side, count] : sides) {
        REQUIRE(count == 1);
        if (sides.count({side.second, side.first}) == 0)
            REQUIRE(on_border(mesh.points[side.first], mesh.points[side.second]));
    }
}

constexpr int kSizes[][2] = {{33, 33}, {50, 37}, {100, 9}, {2, 40}, {2, 2}, {66, 64}};

}  // namespace

TEST_CASE("thinned terrains have no cracks and cover the whole grid", "[terrain]") {
    for (const auto& [columns, rows] : kSizes) {
        const HeightGrid heights = mountains(columns, rows);
        for (const ThinningRule rule : {ThinningRule::kBound, ThinningRule::kLinear, ThinningRule::kHaar})
            for (const double threshold : {0.0, 0.01, 0.05, 0.2, 10.0}) {
                const TerrainMesh mesh = thinned(heights, rule, threshold);
                INFO(columns << " x " << rows << " by " << name_of(rule) << " at " << threshold);
                check_closed(mesh);
                CHECK(area_of(mesh) == Approx(kSize.x * kSize.z).epsilon(1e-9));
            }
    }
}

TEST_CASE("no sample is farther off than the bound that thinning was given", "[terrain]") {
    for (const auto& [columns, rows] : kSizes) {
        const HeightGrid heights = mountains(columns, rows);
        for (const double threshold : {0.0, 0.003, 0.02, 0.1, 0.5}) {
            const TerrainMesh mesh = thinned(heights, ThinningRule::kBound, threshold);
            const double worst = worst_error(mesh, heights);
            INFO(columns << " x " << rows << " at " << threshold << ": " << mesh.triangles.size());
            CHECK(worst <= threshold + 1e-9);
        }
    }
    const HeightGrid heights = mountains(257, 257);
    CHECK(thinned(heights, ThinningRule::kBound, 0.1).triangles.size() < 2 * 256 * 256 / 10);
}

TEST_CASE("the error that a thinned terrain tells of is the one that is found by search", "[terrain]") {
    const HeightGrid heights = mountains(75, 61);
    for (const ThinningRule rule : {ThinningRule::kBound, ThinningRule::kLinear, ThinningRule::kHaar}) {
        const TerrainMesh mesh = thinned(heights, rule, 0.05);
        CHECK(mesh.greatest_error == Approx(worst_error(mesh, heights)).epsilon(1e-5));
        CHECK(mesh.rms_error < mesh.greatest_error);
        CHECK(mesh.rms_error > 0);
    }
}

TEST_CASE("a terrain that is not thinned has all its triangles and no error", "[terrain]") {
    const HeightGrid heights = mountains(21, 14);
    const TerrainMesh mesh = make_terrain(heights, {kSize, {}}, {});
    CHECK(mesh.triangles.size() == 2 * 20 * 13);
    CHECK(mesh.whole_triangles == mesh.triangles.size());
    CHECK(mesh.points.size() == heights.values.size());
    CHECK(worst_error(mesh, heights) < 1e-9);
    CHECK(mesh.greatest_error == 0);
    check_closed(mesh);
}

TEST_CASE("a slope that is even is two triangles", "[terrain]") {
    HeightGrid slope{17, 17, 1, {}};
    for (int y = 0; y < 17; ++y)
        for (int x = 0; x < 17; ++x)
            slope.values.push_back(static_cast<float>(x) * 0.25f - static_cast<float>(y) * 0.5f);
    for (const ThinningRule rule : {ThinningRule::kBound, ThinningRule::kLinear})
        CHECK(thinned(slope, rule, 0).triangles.size() == 2);
    // Haar's wavelets see steps where there is a slope.
    CHECK(thinned(slope, ThinningRule::kHaar, 0).triangles.size() == 2 * 16 * 16);
    const TerrainMesh mesh = thinned(slope, ThinningRule::kBound, 0);
    const Vec3 normal = normalize(Vec3(-4 * kSize.y / kSize.x, 1, 8 * kSize.y / kSize.z));
    for (const Vec3& one : mesh.normals) CHECK(length(one - normal) < 1e-6);
}

TEST_CASE("Haar's and linear detail signals are those of the textbook", "[terrain]") {
    // 15 9 1 3: means 12 2, details 3 -1; mean 7, detail 5. Alike in all rows; the fifth column is one more.
    HeightGrid heights{5, 5, 1, {}};
    for (int y = 0; y < 5; ++y)
        for (const float value : {15.f, 9.f, 1.f, 3.f, 3.f}) heights.values.push_back(value);
    const HeightSquare square(heights, std::numeric_limits<double>::quiet_NaN());
    const SampleWorth haar(square, ThinningRule::kHaar, {}, {});
    // In the first row, with the three neighbours there: -3, and 3, -1 at the sides, -3 below.
    CHECK(static_cast<double>(haar.at(1, 0)) == Approx(std::sqrt(9. + 9 + 1 + 9)));
    // The middle of all, with details of -5 in the right half's blocks and 5 in the left.
    CHECK(static_cast<double>(haar.at(2, 2)) == Approx(std::sqrt(5 * 25.)));
    const SampleWorth linear(square, ThinningRule::kLinear, {}, {});
    // 9 lies 1 above the line from 15 to 1, its neighbours below and beside it: 1 at the row's, 0 at the
    // columns that the coarser grid has.
    CHECK(static_cast<double>(linear.at(1, 0)) == Approx(std::sqrt(1. + 1)));
}

TEST_CASE("what lies in the region of interest is kept, what lies far outside goes", "[terrain]") {
    const HeightGrid heights = mountains(129, 129);
    const Vec2 middle(-2, 1);
    const InterestRegion region{middle, {1, 1.5}, 20};
    const TerrainMesh mesh = make_terrain(heights, {kSize, {}}, Thinning{ThinningRule::kBound, 0.01, region});
    const TerrainMesh evenly = thinned(heights, ThinningRule::kBound, 0.01);
    CHECK(mesh.triangles.size() < evenly.triangles.size() / 2);
    check_closed(mesh);
    const std::vector<double> found = heights_by_search(mesh, heights);
    double near = 0, far = 0;
    for (int y = 0; y < 129; ++y)
        for (int x = 0; x < 129; ++x) {
            const auto i = static_cast<std::size_t>(y * 129 + x);
            const double off = std::fabs(found[i] - static_cast<double>(heights.values[i]) * kSize.y);
            const double away = length(Vec2((x / 128. - 0.5) * kSize.x, (y / 128. - 0.5) * kSize.z) - middle);
            // Hats there reach as far as they are wide: weights are no less than those a little farther out.
            if (away < 0.4) near = std::max(near, off);
            if (away > 4) far = std::max(far, off);
        }
    CHECK(near < 0.01 * std::exp(0.5));
    CHECK(far > 0.1);
}

TEST_CASE("cells around missing heights are holes, thinned or not", "[terrain]") {
    HeightGrid heights = mountains(60, 45);
    const float odd[] = {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(),
                         -9999};
    for (int k = 0; k < 40; ++k) heights.values[static_cast<std::size_t>(k * 61 + 7 * (k % 5))] = odd[k % 3];
    const auto missing =
        static_cast<std::size_t>(std::count_if(heights.values.begin(), heights.values.end(), [](float value) {
            return !std::isfinite(value) || value == -9999;
        }));
    const TerrainShape shape{kSize, -9999};
    const TerrainMesh whole = make_terrain(heights, shape, {});
    CHECK(whole.missing_heights == missing);
    CHECK(area_of(whole) < 0.99 * kSize.x * kSize.z);
    for (const ThinningRule rule : {ThinningRule::kBound, ThinningRule::kLinear, ThinningRule::kHaar}) {
        const TerrainMesh mesh = make_terrain(heights, shape, Thinning{rule, 0.05, {}});
        CHECK(area_of(mesh) == Approx(area_of(whole)).epsilon(1e-9));
        CHECK(mesh.triangles.size() < whole.triangles.size());
        const std::vector<double> found = heights_by_search(mesh, heights),
                                  all = heights_by_search(whole, heights);
        for (std::size_t i = 0; i < found.size(); ++i) {
            REQUIRE(std::isnan(found[i]) == std::isnan(all[i]));
            if (rule == ThinningRule::kBound && !std::isnan(all[i]))
                REQUIRE(std::fabs(found[i] - all[i]) <= 0.05 + 1e-9);
        }
        for (const Vec3& normal : mesh.normals) REQUIRE(length(normal) == Approx(1));
    }
}

TEST_CASE("a terrain is the same for any number of threads", "[terrain]") {
    const HeightGrid heights = mountains(300, 200);
    set_thread_count(1);
    const TerrainMesh one = thinned(heights, ThinningRule::kHaar, 0.01);
    set_thread_count(0);
    const TerrainMesh all = thinned(heights, ThinningRule::kHaar, 0.01);
    CHECK(one.triangles == all.triangles);
    CHECK(one.points == all.points);
}

TEST_CASE("a terrain of too many triangles is refused before they are made", "[terrain][bad-input]") {
    const HeightGrid heights{kMostHeightsSide, kMostHeightsSide, 1, {}};
    CHECK_THROWS_AS(make_terrain(heights, {kSize, {}}, {}), std::length_error);
}
