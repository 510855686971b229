// Cells that any thread halves are the same for all, with the bounds that the surface says.
#include "specular/cell_bvh.h"

#include <array>
#include <atomic>

#include "base/util/parallel.h"
#include "support/draw.h"
#include "support/test.h"
#include "support/test_surfaces.h"

using namespace trilens_test;

TEST_CASE("cells halved by many threads at once are one tree's, with the surface's bounds",
          "[specular][law]") {
    const CubeSphere sphere(Vec3(0.2, 0, -1), 1.5);
    const CellBvh cells(sphere);
    const auto bounder = sphere.make_bounder();
    REQUIRE(bounder);
    REQUIRE(cells.faces().size() == sphere.face_count());
    constexpr std::size_t kWalks = 64, kDeep = 12;
    std::array<std::array<const CellHalves*, kDeep>, kWalks> seen{};
    std::atomic<int> wrong = 0;
    parallel_for(kWalks, 1, [&](std::size_t first, std::size_t last) {
        for (std::size_t walk = first; walk < last; ++walk) {
            // Walks of one of eight ways: each is gone by several threads.
            const SurfaceCell* cell = &cells.faces()[walk % 2];
            for (std::size_t depth = 0; depth < kDeep; ++depth) {
                const CellHalves* halves = cells.halves(*cell);
                seen[walk][depth] = halves;
                for (const SurfaceCell& half : *halves) {
                    const SurfaceBounds bounds = bounder->bounds(half.box.face, half.box.low, half.box.high);
                    if (bounds.position_radius != half.bounds.position_radius ||
                        bounds.normal_radius != half.bounds.normal_radius ||
                        bounds.middle.position != half.bounds.middle.position ||
                        !is_within(half.box, cell->box))
                        ++wrong;
                }
                cell = &(*halves)[(walk / 2 >> depth % 2) % 2];
            }
        }
    });
    CHECK(wrong == 0);
    for (std::size_t walk = 8; walk < kWalks; ++walk) CHECK(seen[walk] == seen[walk % 8]);
}
