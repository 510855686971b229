// Terrains: seen in a mirror as Embree sees them, and directly as a caster of voxel columns does.
#include <cmath>
#include <string>

#include "laws/agreement.h"
#include "laws/worlds.h"
#include "render/engines/engine.h"
#include "support/mountains.h"
#include "support/test.h"

using namespace trilens;
using namespace trilens_test;

namespace {

constexpr int kTerrainWidth = 80, kTerrainHeight = 60;
constexpr double kSizeX = 8, kSizeY = 1.2, kSizeZ = 6;

std::string heights_file(const HeightGrid& heights) {
    const std::string file = scratch_dir("terrain_law") + "/heights.exr";
    write_heights(file, heights);
    return file;
}

std::string terrain_world(const std::string& file, const std::string& more, const std::string& optics = "") {
    return R"({"version": 1, "film": {"width": 80, "height": 60},
        "cameras": [{"name": "main", "yfov": 50, "lookAt": {"eye": [0.2, 1.3, 2.6], "at": [0.2, 1.3, 0]}}],
        "background": {"color": [0.3, 0.4, 0.6]},
        "materials": [{"name": "chrome", "metallicFactor": 1, "roughnessFactor": 0}],
        "meshes": [)" +
           optics + R"({"name": "range", "role": "terrain", "heights": ")" + file +
           R"(", "size": [8, 1.2, 6])" + more + "}]}";
}

constexpr const char* kBallOverTerrain =
    R"({"name": "ball", "role": "optic", "material": "chrome", "primitive": {"type": "sphere", "center": [0, 1.3, 0], "radius": 0.6}},)";

SampleViews views_of(const World& world, Engine engine) {
    const auto viewer = make_viewer(world, {}, engine, ignore);
    SampleViews views;
    viewer->view({0, 0, kTerrainWidth, kTerrainHeight, 1}, views);
    return views;
}

/// Where a ray meets the terrain, as distances along the view axis: behind one row of samples, at or before
/// the next. Both infinite where it meets none.
struct RowInterval {
    double after = INFINITY, until = INFINITY;
};

/// One column of pixels, from the bottom: each ray goes on from the row at which the one below it ended, for
/// it goes at least as far. Heights between two samples of a row are on the line between them. After:
/// Cohen-Or, Rich, Lerner, Shenkar, A Real-Time Photo-Realistic Visual Flythrough (1996).
std::vector<RowInterval> cast_column(const HeightGrid& heights, const Vec3& eye, double across,
                                     const std::vector<double>& rises) {
    std::vector<RowInterval> column(rises.size());
    const auto depth_of = [&](int row) { return eye.z - (row / (heights.rows - 1.0) - 0.5) * kSizeZ; };
    int row = heights.rows - 1;
    while (row >= 0 && depth_of(row) <= 0) --row;
    double before = 0;
    std::size_t pixel = 0;
    for (; row >= 0 && pixel < rises.size(); --row) {
        const double depth = depth_of(row);
        const double place = ((eye.x + across * depth) / kSizeX + 0.5) * (heights.columns - 1);
        if (place < 0 || place > heights.columns - 1) break;
        const int left = std::min(static_cast<int>(place), heights.columns - 2);
        const double share = place - left;
        const double ground = kSizeY * ((1 - share) * static_cast<double>(heights.at(left, row)) +
                                        share * static_cast<double>(heights.at(left + 1, row)));
        while (pixel < rises.size() && eye.y + rises[pixel] * depth <= ground)
            column[pixel++] = {before, depth};
        before = depth;
    }
    return column;
}

}  // namespace

TEST_CASE("terrains are projected as Embree traces them, directly and in a ball", "[terrain][law]") {
    const std::string file = heights_file(mountains(97, 65));
    for (const char* more :
         {"", R"(, "heightError": 0.02)", R"(, "heightError": 0.05, "thinning": "haar")"}) {
        const auto world = world_from("terrain", terrain_world(file, more, kBallOverTerrain), 12);
        const Agreement agreement = compare_engines(*world);
        INFO(more << " " << agreement.first_off_edge);
        CHECK(agreement.optic_pixels > 300);
        CHECK(agreement.off_edge == 0);
        CHECK(agreement.seen <= agreement.pixels / 100);
    }
}

TEST_CASE("a caster of voxel columns finds the terrain where projection and Embree do", "[terrain][law]") {
    const HeightGrid heights = mountains(97, 65);
    const auto world = world_from("terrain_cast", terrain_world(heights_file(heights), ""), 1);
    const Vec3 eye(0.2, 1.3, 2.6);
    const double half = std::tan(25 * 3.14159265358979323846 / 180);
    for (const Engine engine : {Engine::kExact, Engine::kLimitTruth}) {
        const SampleViews views = views_of(*world, engine);
        std::size_t ground = 0, earlier = 0, sky = 0;
        for (int x = 0; x < kTerrainWidth; ++x) {
            std::vector<double> rises;
            for (int y = kTerrainHeight - 1; y >= 0; --y)
                rises.push_back((1 - 2 * (y + 0.5) / kTerrainHeight) * half);
            const double across = (2 * (x + 0.5) / kTerrainWidth - 1) * half * kTerrainWidth / kTerrainHeight;
            const std::vector<RowInterval> column = cast_column(heights, eye, across, rises);
            for (int y = 0; y < kTerrainHeight; ++y) {
                const RowInterval& cast = column[static_cast<std::size_t>(kTerrainHeight - 1 - y)];
                const SampleView& view = views.samples[static_cast<std::size_t>(y * kTerrainWidth + x)];
                if (cast.until == INFINITY) {
                    // Crests between two rows stand above the lines along them; borders end between rows.
                    sky += view.hit.seen() ? 1 : 0;
                    continue;
                }
                ++ground;
                REQUIRE(view.hit.seen());
                REQUIRE(view.depth <= cast.until + 1e-9);
                if (view.depth < cast.after - 1e-9) ++earlier;
            }
        }
        CHECK(ground > 1200);
        CHECK(earlier < ground / 50);
        CHECK(sky < ground / 50);
    }
}
