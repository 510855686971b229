// Visibility of whole pixels: what is sure of a pixel is what each of its samples sees by the plain engine.
#include <algorithm>
#include <vector>

#include "base/raymesh/rasterize.h"
#include "engines_compared.h"
#include "support/test.h"

using namespace trilens;
using namespace trilens_test;

namespace {

struct PixelTally {
    std::size_t pixels = 0, sure = 0, seen = 0, listed = 0;
    std::size_t different = 0;  // samples that see something else
    std::size_t missing = 0;    // samples of listed pixels that see what is not on the list
};

/// The pixels' samples, by the pixels' facets.
FacetSamples samples_of(const FacetSamples& pixels, const SampleGrid& grid) {
    const Id per_pixel = static_cast<Id>(grid.samples_per_pixel());
    FacetSamples samples;
    for (const std::size_t first : pixels.first) samples.first.push_back(first * per_pixel);
    for (const Id pixel : pixels.sample)
        for (Id i = 0; i < per_pixel; ++i) samples.sample.push_back(pixel * per_pixel + i);
    return samples;
}

FacetSamples all_pixels(const SampleGrid& grid) {
    SampleGrid pixels = grid;
    pixels.side = 1;
    return all_samples(pixels);
}

void compare_pixels(const Case& c, PixelTally& tally) {
    const PreparedScene scene(c.scene);
    std::vector<Hit> plain(c.grid.size());
    draw(scene, c.mesh, samples_of(c.owned, c.grid), c.grid, plain, {.vectors = false});
    std::vector<Visible> visible(c.grid.pixels()), alone(c.grid.pixels());
    std::vector<PixelTriangle> open;
    find_visible_by_pixel(scene, c.mesh, c.owned, c.grid, visible, &open);
    find_visible_by_pixel(scene, c.mesh, c.owned, c.grid, alone);
    const std::size_t per_pixel = static_cast<std::size_t>(c.grid.samples_per_pixel());
    for (const Id p : c.owned.sample) {
        const bool sure = visible[p].triangle != kSeveral;
        ++tally.pixels;
        tally.sure += sure;
        tally.seen += sure && visible[p].seen();
        tally.different += alone[p].triangle != visible[p].triangle;
        const auto is_of = [&](const PixelTriangle& one) { return one.pixel == p; };
        const auto first = std::find_if(open.begin(), open.end(), is_of),
                   last = std::find_if_not(first, open.end(), is_of);
        tally.listed += first != last;
        for (std::size_t s = p * per_pixel; s < (p + 1) * per_pixel; ++s) {
            if (sure)
                tally.different += !around(visible[p], plain[s]);
            else if (first != last && plain[s].seen())
                tally.missing += std::none_of(
                    first, last, [&](const PixelTriangle& one) { return one.triangle == plain[s].triangle; });
        }
    }
}

void check(const PixelTally& tally) {
    CHECK(tally.different == 0);
    CHECK(tally.missing == 0);
    CHECK(tally.sure > tally.pixels / 4);
    CHECK(tally.seen > 0);
    CHECK(tally.listed > 0);
}

}  // namespace

TEST_CASE("pixels that surely see one triangle do so with all samples, in a bowed mirror",
          "[projector][law]") {
    Random random(31);
    for (const std::string& set : kernel_instruction_sets()) {
        REQUIRE(use_instruction_set(set));
        PixelTally tally;
        for (int i = 0; i < 12; ++i) {
            const SampleGrid grid{3, 5, 43, 37, 2 + i % 4};
            const Frame frame = random_frame(random);
            const RayMesh mesh = bowed_mesh(grid, frame, 1 + random.below(8));
            const TriangleScene scene = bumpy_room(frame, 1 + random.below(6));
            compare_pixels({scene, mesh, grid, pixels_in_facets(mesh, grid)}, tally);
        }
        INFO(set << ": " << tally.sure << " of " << tally.pixels << " sure");
        check(tally);
    }
    CHECK(use_instruction_set(""));
}

TEST_CASE("pixels that surely see one triangle do so with all samples, for rays and screens of every kind",
          "[projector][law]") {
    Random random(32);
    PixelTally tally;
    for (int i = 0; i < 400; ++i) {
        const int x0 = random.below(2000);
        const SampleGrid grid{x0, 7, x0 + 8 + random.below(20), 7 + 8 + random.below(20),
                              2 + random.below(3)};
        const Frame frame = random_frame(random);
        const RayMesh mesh =
            random_facet(random, grid, frame, static_cast<Rays>(i % 5), static_cast<Screen>(i / 5 % 4));
        const TriangleScene scene = random_triangles(random, frame, 1 + random.below(40));
        const bool outside = i % 7 == 0;
        compare_pixels({scene, mesh, grid, outside ? all_pixels(grid) : pixels_in_facets(mesh, grid)}, tally);
    }
    INFO(tally.sure << " of " << tally.pixels << " sure");
    check(tally);
}

TEST_CASE("pixels in a facet have all their samples in it, and most of those that could are found",
          "[projector][law]") {
    Random random(33);
    for (int i = 0; i < 40; ++i) {
        const SampleGrid grid{2, 1, 62, 41, 2 + i % 3};
        const RayMesh mesh = bowed_mesh(grid, {}, 1 + random.below(9));
        const FacetSamples samples = rasterize_facets(mesh, grid), pixels = pixels_in_facets(mesh, grid);
        std::vector<Id> owner(grid.size(), kNone);
        for (std::size_t f = 0; f < mesh.facets.size(); ++f)
            for (const Id s : samples.of(f)) owner[s] = static_cast<Id>(f);
        std::size_t wrong = 0, whole = 0;
        const std::size_t per_pixel = static_cast<std::size_t>(grid.samples_per_pixel());
        for (std::size_t f = 0; f < mesh.facets.size(); ++f)
            for (const Id p : pixels.of(f))
                for (std::size_t s = p * per_pixel; s < (p + 1) * per_pixel; ++s) wrong += owner[s] != f;
        for (std::size_t p = 0; p < grid.pixels(); ++p)
            whole += std::all_of(&owner[p * per_pixel], &owner[p * per_pixel] + per_pixel,
                                 [&](Id f) { return f != kNone && f == owner[p * per_pixel]; });
        CHECK(wrong == 0);
        CHECK(pixels.sample.size() <= whole);
        CHECK(pixels.sample.size() > whole * 3 / 4);
    }
}
