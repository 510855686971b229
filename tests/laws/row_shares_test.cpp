// What progress says of a picture: the time left is right though rows differ by a factor of a hundred, being
// told changes nothing, and what is decided is said at once.
#include "render/picture/picture_progress.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "base/util/error.h"
#include "laws/worlds.h"
#include "render/engines/engine.h"
#include "render/picture/picture.h"
#include "scene/examples/examples.h"
#include "support/test.h"

using namespace trilens;
using namespace trilens_test;

namespace {

/// Seconds of each row: a few stretches of rows that take up to a hundred times as long as the others.
std::vector<double> uneven_rows(std::mt19937_64& random, int height) {
    std::uniform_real_distribution<double> share(0, 1);
    std::vector<double> seconds(static_cast<std::size_t>(height), 0.02);
    for (int k = 0; k < 3; ++k) {
        const int size = height / 8 + static_cast<int>(share(random) * height / 2);
        const int first = static_cast<int>(share(random) * (height - size));
        const double more = 0.02 * std::pow(10, 2 * share(random));
        for (int row = first; row < first + size; ++row) seconds[static_cast<std::size_t>(row)] += more;
    }
    return seconds;
}

double sum_of(const std::vector<double>& seconds, int from, int to) {
    double sum = 0;
    for (int row = from; row < to; ++row) sum += seconds[static_cast<std::size_t>(row)];
    return sum;
}

/// A viewer whose optics have facets that there is no room for.
class CrowdedViewer : public Viewer {
  public:
    explicit CrowdedViewer(std::unique_ptr<Viewer> viewer) : viewer_(std::move(viewer)) {}
    void view(const SampleGrid& grid, SampleViews& views) override {
        viewer_->view(grid, views);
        views.crowded_out = 7;
    }
    bool has_facets() const override { return viewer_->has_facets(); }
    const OpticPaths& paths(std::size_t optic) const override { return viewer_->paths(optic); }
    const RayMesh* camera_mesh() const override { return viewer_->camera_mesh(); }
    const CameraModel* exact_camera() const override { return viewer_->exact_camera(); }
    void bound_coverage(const SampleGrid& grid, std::span<const Id> shown,
                        std::span<CoverageBounds> bounds) override {
        viewer_->bound_coverage(grid, shown, bounds);
    }
    bool has_keys() const override { return false; }
    void find_keys(const SampleGrid&, std::span<FragmentKey>) override {}
    void find_keys_of_pixels(const SampleGrid&, std::span<FragmentKey>) override {}
    FragmentKey key_of(const SampleViews& views, const SampleView& view) const override {
        return viewer_->key_of(views, view);
    }

  private:
    std::unique_ptr<Viewer> viewer_;
};

}  // namespace

TEST_CASE(
    "the time left is right within a factor of two 49 times in 50, though rows differ by a factor of a "
    "hundred",
    "[render][progress][law]") {
    std::mt19937_64 random(11);
    std::size_t asked = 0, off = 0, told_of_pixels = 0;  // by shares of pixels alone
    for (int round = 0; round < 300; ++round) {
        const int height = 200 + static_cast<int>(random() % 1000), y0 = static_cast<int>(random() % 50);
        const std::vector<double> seconds = uneven_rows(random, height);
        const double of_any = static_cast<double>(round % 3);  // what a strip takes, however few its rows are
        int timed = 0;
        const RowShares shares = RowShares::measured(y0, y0 + height, [&](int from, int to) {
            REQUIRE((from >= y0 && from < to && to <= y0 + height));
            timed += to - from;
            return of_any + sum_of(seconds, from - y0, to - y0);
        });
        CHECK(timed * 20 <= height);
        CHECK(shares.of(y0, y0 + height) == Approx(1));
        const double whole = sum_of(seconds, 0, height);
        TimeLeft left, by_pixels;
        for (int row = 16; row < height; row += 16) {
            const double now = sum_of(seconds, 0, row), truth = whole - now;
            const auto is_off = [&](const std::optional<double>& told) {
                return told && truth > 0.05 * whole && now > 0.1 * whole &&
                       (*told > 2 * truth || *told < truth / 2);
            };
            const auto told = left.at(shares.of(y0, y0 + row), now);
            off += is_off(told);
            asked += told && truth > 0.05 * whole && now > 0.1 * whole;
            told_of_pixels += is_off(by_pixels.at(static_cast<double>(row) / height, now));
        }
    }
    // Where a stretch begins just beside what was timed, it is off.
    INFO(off << " of " << asked << " are off, " << told_of_pixels << " by pixels alone");
    CHECK(asked > 5000);
    CHECK(off * 50 < asked);
    CHECK(told_of_pixels > 10 * off);
}

TEST_CASE("a picture that is done soon has three rows timed, and rows alike", "[render][progress]") {
    int timed = 0;
    const RowShares shares = RowShares::measured(0, 480, [&](int from, int to) {
        timed += to - from;
        return 1e-3 * (to - from);
    });
    CHECK(timed == 3);
    CHECK(shares.of(0, 120) == Approx(0.25));
    const RowShares few =
        RowShares::measured(5, 9, [](int, int) -> double { throw UsageError("is not asked"); });
    CHECK(few.of(5, 7) == Approx(0.5));
}

TEST_CASE("a picture is the same whether somebody is told how much of it is done",
          "[render][progress][law]") {
    for (const int spp : {1, 2}) {
        Scene scene = load_scene_text(scene_examples().front().json, SceneSource("scene", ""), {}, {});
        scene.film.width = 64, scene.film.height = 160, scene.film.spp = spp;
        const auto world = make_world(std::move(scene), ignore);
        std::vector<double> told;
        Progress progress;
        progress.report = [&](double done) { told.push_back(done); };
        const Picture silent = draw_picture(*world, {}, {}, ignore),
                      loud = draw_picture(*world, {}, progress, ignore);
        REQUIRE(silent.image.channels.size() == loud.image.channels.size());
        for (std::size_t c = 0; c < silent.image.channels.size(); ++c)
            CHECK(silent.image.channels[c].values == loud.image.channels[c].values);
        CHECK(silent.statistics.projected_facets == loud.statistics.projected_facets);
        REQUIRE(!told.empty());
        CHECK(std::is_sorted(told.begin(), told.end()));
        CHECK(told.back() == 1);
    }
}

TEST_CASE("that facets are traced for want of room is told before the first pixel is shaded",
          "[render][progress]") {
    Scene scene = load_scene_text(scene_examples().front().json, SceneSource("scene", ""), {}, {});
    scene.film.width = scene.film.height = 64;
    const auto world = make_world(std::move(scene), ignore);
    CrowdedViewer viewer(make_viewer(*world, {}, Engine::kExact, ignore));
    double done = 0;
    std::vector<double> told_at;
    Progress progress;
    progress.report = [&](double share) { done = share; };
    draw_layers(*world, viewer, {0, 0, 64, 64, {}}, progress, {.crowded_out = [&](std::size_t facets) {
        CHECK(facets == 7);
        told_at.push_back(done);
    }});
    REQUIRE(!told_at.empty());
    CHECK(told_at.front() == 0);
}
