// The first law: the projector shows exactly what Embree finds along the same rays, but for edge ties.
#include "laws/agreement.h"

#include <cstdio>

#include "laws/worlds.h"
#include "support/test.h"
#include "surfaces/test_cages.h"

using namespace trilens;
using namespace trilens_test;

namespace {

/// Share of an optic's pixels that may lie on an edge closely enough for the engines to differ.
constexpr double kEdgeShare = 1e-3;

void check_agreement(const std::string& name, int n, const World& world, bool print) {
    const Agreement a = compare_engines(world);
    if (print) {
        std::printf("%-28s n=%-3d optic pixels %7zu  seen %4zu  coverage %4zu  off edge %zu  worst t %.1e\n",
                    name.c_str(), n, a.optic_pixels, a.seen, a.coverage, a.off_edge, a.worst_t);
        std::fflush(stdout);
    }
    INFO(name << " at n = " << n << ": " << a.first_off_edge);
    CHECK(a.off_edge == 0);
    CHECK(static_cast<double>(a.seen) <=
          kEdgeShare * static_cast<double>(std::max<std::size_t>(a.optic_pixels, 1000)));
    CHECK(static_cast<double>(a.coverage) <=
          kEdgeShare * static_cast<double>(std::max<std::size_t>(a.optic_pixels, 1000)));
    CHECK(a.worst_t < 1e-6);
}

void check_shipped(int width, int height, bool print) {
    for (const std::string& name : shipped_scenes()) {
        for (const int n : {1, 2, 8}) {
            std::string missing;
            const auto world = shipped_world(name, n, width, height, &missing);
            if (!world) {
                note_skip("agreement on scene " + name, missing);
                continue;
            }
            check_agreement(name, n, *world, print);
        }
    }
}

void check_cages(int width, int height, const std::vector<int>& resolutions, bool print) {
    if (data_cages().empty()) TRILENS_SKIP("needs data/cages");
    TRILENS_NEEDS_DATA("models/spot.obj");
    for (const std::string& cage : data_cages())
        for (const int n : resolutions) check_agreement(cage, n, *cage_world(cage, n, width, height), print);
}

const std::vector<std::string> kGlassScenes{"prism",        "plano-convex", "meniscus",   "glass-torus",
                                            "mirror-torus", "wine-glass",   "under-water"};

}  // namespace

TEST_CASE("projector and Embree agree on the shipped scenes", "[laws][oracle][law][golden]") {
    check_shipped(160, 120, false);
}

TEST_CASE("projector and Embree agree over whole paths: every end of every sample",
          "[laws][paths][oracle][law]") {
    for (const std::string name : {"crystal-ball", "mirror-balls", "glass-before-mirror", "bowl"})
        for (const int n : {1, 2, 8})
            check_agreement(name, n, *shipped_world("paths/" + name, n, 120, 90), true);
}

TEST_CASE("the same through prism, lenses, rings and a glass of wine", "[laws][paths][law][thorough]") {
    for (const std::string& name : kGlassScenes)
        for (const int n : {1, 8}) check_agreement(name, n, *shipped_world("paths/" + name, n, 72, 54), true);
}

TEST_CASE("the same through prism, lenses, rings and a glass of wine at full size",
          "[.long][laws][paths][law]") {
    for (const std::string& name : kGlassScenes)
        for (const int n : {1, 2, 8})
            check_agreement(name, n, *shipped_world("paths/" + name, n, 160, 120), true);
}

TEST_CASE("projector and Embree agree on cages of every kind as mirrors", "[laws][oracle][law]") {
    std::size_t k = 0;
    for (const auto& [name, cage] : made_cages()) {
        check_agreement(name, 1, *cage_world(cage, 1, 120, 90), false);
        if (k++ % 3 == 0) check_agreement(name, 4, *cage_world(cage, 4, 60, 45), false);
    }
}

TEST_CASE("projector and Embree agree on Pixar's cages as mirrors", "[laws][oracle][law]") {
    check_cages(96, 72, {2}, false);
}

TEST_CASE("the same at full size, with a table", "[.long][agreement][law]") {
    check_shipped(640, 480, true);
    check_cages(640, 480, {1, 2, 8}, true);
    for (const auto& [name, cage] : made_cages())
        for (const int n : {1, 4}) check_agreement(name, n, *cage_world(cage, n, 120, 90), true);
}
