// Laws of the classic engine on whole scenes: it comes to the exact engine's picture as its outlines get
// finer, and clipping in the scene leaves a closed room closed.
#include <algorithm>
#include <array>

#include "base/util/parallel.h"
#include "laws/worlds.h"
#include "render/engines/engine.h"
#include "support/test.h"

using namespace trilens;
using namespace trilens_test;

namespace {

SampleViews classic_views(const World& world, const EngineChoice& engine) {
    const Film& film = world.scene.film;
    const SampleGrid grid{0, 0, film.width, film.height, 1};
    SampleViews views;
    make_viewer(world, {}, engine, ignore)->view(grid, views);
    return views;
}

struct ClassicDifference {
    std::size_t pixels = 0, differing = 0;
    std::size_t uncovered = 0;  // the exact engine sees something, the classic one nothing
    double share() const { return static_cast<double>(differing) / static_cast<double>(pixels); }
};

/// The triangles that the sample shows directly, reflected and refracted.
std::array<Id, 3> seen_ids(const SampleViews& views, const SampleView& view) {
    return {view.hit.triangle, views.hit(view, Path::kReflect).triangle,
            views.hit(view, Path::kRefract).triangle};
}

void add(ClassicDifference& sum, const SampleViews& exact, const SampleViews& classic) {
    for (std::size_t p = 0; p < exact.samples.size(); ++p) {
        const SampleView &a = exact.samples[p], &b = classic.samples[p];
        const std::array<Id, 3> before = seen_ids(exact, a), after = seen_ids(classic, b);
        REQUIRE(a.optic == b.optic);
        REQUIRE(a.facet == b.facet);
        bool lost = false;
        for (std::size_t k = 0; k < 3; ++k) lost |= before[k] != kNone && after[k] == kNone;
        ++sum.pixels;
        sum.differing += before != after;
        sum.uncovered += lost;
    }
}

constexpr std::size_t kMostTessellated = 10'000;

/// Over those of the scenes that can be loaded.
ClassicDifference difference(int n, const ClassicParams& params, const std::vector<std::string>& scenes) {
    constexpr int kWide = 160, kHigh = 120;
    ClassicDifference sum;
    for (const std::string& name : scenes) {
        std::string missing;
        const auto world = shipped_world(name, n, kWide, kHigh, &missing);
        if (!world) {
            note_skip("classic engine on scene " + name, missing);
            continue;
        }
        // Each triangle in up to 256 pieces: minutes for a model of 121,496.
        if (params.curves == Curves::kTessellate && world->objects.size() > kMostTessellated) {
            note_skip("tessellation on scene " + name, "too many triangles to tessellate in a test");
            continue;
        }
        add(sum, classic_views(*world, Engine::kExact), classic_views(*world, params));
    }
    REQUIRE(sum.pixels > 0);
    return sum;
}

/// Scenes that differ in all that the classic engine does: a plane, a round, a saddle and a closed mirror,
/// glass.
const std::vector<std::string> kTellingScenes{"flat", "sphere", "saddle", "closed", "paths/crystal-ball"};

void check_arcs(const std::vector<int>& resolutions, const std::vector<std::string>& scenes) {
    for (const int n : resolutions) {
        for (const Clip clip : {Clip::kScene, Clip::kScreen}) {
            const ClassicDifference d = difference(n, {Curves::kArcs, clip}, scenes);
            INFO("n " << n << ": " << d.differing << " of " << d.pixels << " pixels differ");
            // An outline may lie 0.001 px from its conic.
            CHECK(d.share() < 2e-5);
        }
    }
}

void check_pieces(const std::vector<std::string>& scenes) {
    for (const Curves curves : {Curves::kSlices, Curves::kTessellate}) {
        double last = 1, first = 0;
        for (const int k : {1, 4, 16}) {
            const ClassicDifference d = difference(2, {curves, Clip::kScene, k}, scenes);
            INFO("K " << k << ": " << d.share() << " differ, before " << last);
            // A tenth more, or a few pixels, is noise.
            CHECK(d.share() <= 1.1 * last + 6.0 / static_cast<double>(d.pixels));
            last = d.share();
            if (k == 1) first = last;
        }
        // Straight pieces leave a curve like 1 / K^2 where the curve itself is cut, like 1 / K in pieces of
        // triangles.
        CHECK(last < (curves == Curves::kSlices ? 0.05 : 0.35) * first);
    }
}

}  // namespace

TEST_CASE("with arcs the classic engine shows the exact one's picture but for edges",
          "[laws][classic][law][thorough]") {
    check_arcs({1}, shipped_scenes());
    check_arcs({2, 8}, kTellingScenes);
}

TEST_CASE("with arcs the classic engine shows the exact one's picture of every scene at every resolution",
          "[.long][laws][classic][law]") {
    check_arcs({1, 2, 8}, shipped_scenes());
}

TEST_CASE("slices and tessellation come to the exact picture as K grows", "[laws][classic][law]") {
    check_pieces(kTellingScenes);
}

TEST_CASE("slices and tessellation come to the exact picture of every scene", "[.long][laws][classic][law]") {
    check_pieces(shipped_scenes());
}

TEST_CASE("a mirror in a closed room shows the room in every pixel", "[laws][classic][law]") {
    std::size_t open = 0;
    for (const int n : {1, 2, 5, 16}) {
        const auto world = shipped_world("closed", n, 200, 150);
        const SampleViews exact = classic_views(*world, Engine::kExact);
        const auto uncovered = [&](Curves curves, Clip clip, int k) {
            ClassicDifference d;
            add(d, exact, classic_views(*world, ClassicParams{curves, clip, k}));
            return d.uncovered;
        };
        INFO("n " << n);
        for (const SampleView& view : exact.samples)
            REQUIRE((view.hit.seen() || exact.hit(view, Path::kReflect).seen()));
        CHECK(uncovered(Curves::kArcs, Clip::kScene, 1) == 0);
        CHECK(uncovered(Curves::kStraight, Clip::kScene, 1) == 0);
        CHECK(uncovered(Curves::kTessellate, Clip::kScene, 2) == 0);
        CHECK(uncovered(Curves::kTessellate, Clip::kScene, 5) == 0);
        CHECK(uncovered(Curves::kSlices, Clip::kScene, 2) == 0);
        CHECK(uncovered(Curves::kSlices, Clip::kScene, 5) == 0);
        open += uncovered(Curves::kStraight, Clip::kScreen, 1);
    }
    CHECK(open > 0);
}

TEST_CASE("the classic engine shows the same with any number of threads", "[laws][classic][law]") {
    const auto world = shipped_world("torus", 4, 120, 90);
    for (const ClassicParams& params : {ClassicParams{}, ClassicParams{Curves::kSlices, Clip::kScreen, 3}}) {
        set_thread_count(1);
        const SampleViews one = classic_views(*world, params);
        set_thread_count(2);
        const SampleViews two = classic_views(*world, params);
        set_thread_count(0);
        const auto same = [](const Hit& a, const Hit& b) {
            return a.triangle == b.triangle && a.t == b.t && a.barycentric == b.barycentric;
        };
        CHECK(std::equal(one.samples.begin(), one.samples.end(), two.samples.begin(), two.samples.end(),
                         [&](const SampleView& a, const SampleView& b) {
                             return same(a.hit, b.hit) &&
                                    same(one.hit(a, Path::kReflect), two.hit(b, Path::kReflect)) &&
                                    same(one.hit(a, Path::kRefract), two.hit(b, Path::kRefract));
                         }));
    }
}
