// The interval of a pixel's coverage holds against 4,096 samples, in shipped scenes and in random ones.
#include <fmt/format.h>
#include <memory>
#include <string>
#include <vector>

#include "laws/hunt.h"
#include "laws/worlds.h"
#include "render/engines/engine.h"
#include "render/picture/picture.h"
#include "support/test.h"

using namespace trilens;
using namespace trilens_test;

namespace {

constexpr int kSamplesAcross = 64;  // samples along a pixel's edge

struct CoverageTally {
    std::size_t pixels = 0;
    std::size_t beyond = 0;  // whose samples' share lies outside of the interval
    std::size_t open = 0;    // of some width
    std::size_t silent = 0;  // of the whole width
    std::size_t mixed = 0;   // that show several meshes
    std::size_t known = 0;   // of these, to a quarter
    double width = 0;        // of all intervals

    void add(const CoverageTally& more) {
        pixels += more.pixels;
        beyond += more.beyond;
        open += more.open;
        silent += more.silent;
        mixed += more.mixed;
        known += more.known;
        width += more.width;
    }
    std::string words() const {
        return fmt::format(
            "{} pixels, {} open, {} silent, mean width {:.4f}; {} of {} mixed ones to a quarter", pixels,
            open, silent, width / static_cast<double>(pixels), known, mixed);
    }
};

CoverageTally hold_against_samples(const World& world, const FrameParams& frame,
                                   int across = kSamplesAcross) {
    const Film& film = world.scene.film;
    const std::unique_ptr<Viewer> viewer = make_viewer(world, frame, Engine::kExact, ignore);
    CoverageTally held;
    SampleViews centres, samples;
    const std::size_t each = static_cast<std::size_t>(across * across);
    const SampleGrid whole{0, 0, film.width, film.height, 1};
    viewer->view(whole, centres);
    std::vector<Id> shown_by_pixel;
    for (const SampleView& view : centres.samples) shown_by_pixel.push_back(shown_mesh(world, view));
    std::vector<CoverageBounds> bounds_by_pixel(whole.pixels());
    viewer->bound_coverage(whole, shown_by_pixel, bounds_by_pixel);
    for (int y = 0; y < film.height; ++y) {
        const SampleGrid fine{0, y, film.width, y + 1, across};
        viewer->view(fine, samples);
        const std::size_t start = whole.first_sample(0, y), width = static_cast<std::size_t>(film.width);
        const std::span<const Id> shown(shown_by_pixel.data() + start, width);
        const std::span<const CoverageBounds> bounds(bounds_by_pixel.data() + start, width);
        for (std::size_t x = 0; x < width; ++x) {
            const std::size_t first = fine.first_sample(static_cast<int>(x), y);
            std::size_t count = 0;
            for (std::size_t s = 0; s < each; ++s)
                count += shown_mesh(world, samples.samples[first + s]) == shown[x];
            const double share = static_cast<double>(count) / static_cast<double>(each);
            const CoverageBounds& own = bounds[x];
            ++held.pixels;
            held.open += own.low < own.high;
            held.silent += own.low == 0 && own.high == 1;
            held.width += own.high - own.low;
            held.beyond += share < own.low || share > own.high;
            held.mixed += count < each;
            held.known += count < each && own.high - own.low < 0.25;
        }
    }
    return held;
}

}  // namespace

TEST_CASE("a pixel's coverage lies in its interval: shipped scenes", "[laws][law][coverage]") {
    for (const char* scene : {"sphere", "torus", "cameras", "paths/mirror-balls", "paths/prism"}) {
        CAPTURE(scene);
        const CoverageTally held = hold_against_samples(*shipped_world(scene, 8, 16, 12), {});
        INFO(held.words());
        CHECK(held.beyond == 0);
        CHECK(held.known > 0);
    }
}

TEST_CASE(
    "a pixel's coverage lies in its interval where blocks of pixels see one mesh, the same in any window",
    "[laws][law][coverage]") {
    constexpr int kAcross = 16;
    for (const char* scene : {"sphere", "paths/mirror-balls", "paths/prism", "cameras"}) {
        const auto world = shipped_world(scene, 8, 45, 37);
        FrameParams frame;
        frame.camera = world->scene.cameras.size() > 1 ? 1 : 0;
        CAPTURE(scene, frame.camera);
        const CoverageTally held = hold_against_samples(*world, frame, kAcross);
        INFO(held.words());
        CHECK(held.beyond == 0);

        // Windows start and end within blocks.
        const std::unique_ptr<Viewer> viewer = make_viewer(*world, frame, Engine::kExact, ignore);
        const auto bounds_of = [&](const SampleGrid& window) {
            std::vector<CoverageBounds> bounds(window.pixels());
            viewer->bound_coverage(window, std::vector<Id>(window.pixels(), world->optics.front().mesh),
                                   bounds);
            return bounds;
        };
        const SampleGrid whole{0, 0, 45, 37, 1};
        const std::vector<CoverageBounds> all = bounds_of(whole);
        for (const SampleGrid& window : {SampleGrid{7, 5, 40, 30, 1}, SampleGrid{0, 17, 45, 18, 1}}) {
            const std::vector<CoverageBounds> part = bounds_of(window);
            std::size_t unlike = 0;
            for (std::size_t i = 0; i < part.size(); ++i) {
                const std::size_t width = static_cast<std::size_t>(window.width());
                const CoverageBounds& same = all[whole.first_sample(window.x0 + static_cast<int>(i % width),
                                                                    window.y0 + static_cast<int>(i / width))];
                unlike += part[i].low != same.low || part[i].high != same.high;
            }
            CHECK(unlike == 0);
        }
    }
}

TEST_CASE("a pixel's coverage lies in its interval: cameras that are not linear", "[laws][law][coverage][thorough]") {
    const auto world = shipped_world("cameras", 4, 16, 12);
    for (std::size_t camera = 0; camera < world->scene.cameras.size(); ++camera) {
        CAPTURE(camera);
        FrameParams frame;
        frame.camera = camera;
        const CoverageTally held = hold_against_samples(*world, frame);
        INFO(held.words());
        CHECK(held.beyond == 0);
        CHECK(held.silent < held.pixels);
    }
}

TEST_CASE("a pixel's coverage lies in its interval: random scenes", "[laws][law][coverage][thorough]") {
    CoverageTally all;
    for (std::uint64_t seed = 1; seed <= 12; ++seed) {
        const Quarry quarry = make_quarry(seed);
        CAPTURE(seed, quarry.what);
        const auto world = world_from("coverage", quarry.json, 4);
        world->scene.film.width = 16;
        world->scene.film.height = 12;
        FrameParams frame = quarry.frame;
        frame.max_error = 0;
        const CoverageTally held = hold_against_samples(*world, frame);
        CHECK(held.beyond == 0);
        all.add(held);
    }
    INFO(all.words());
    CHECK(all.width < 0.25 * static_cast<double>(all.pixels));
    CHECK(all.known > all.mixed / 2);
}

TEST_CASE("the layer of coverage has its interval at every pixel, and none where exact outlines are drawn",
          "[laws][coverage]") {
    const auto world = shipped_world("sphere", 8, 32, 24);
    PictureRequest request;
    request.layers.layers = {"optic", "position", "coverage"};
    std::string warned;
    const auto open = [&] {
        warned.clear();
        const Image image =
            draw_picture(*world, request, {}, [&](const std::string& what) { warned += what; }).image;
        const auto &least = image.find("coverage.min")->floats(),
                   &most = image.find("coverage.max")->floats();
        const auto &mesh = image.find("coverage.object")->ids(), &optic = image.find("optic.object")->ids(),
                   &object = image.find("directID.object")->ids();
        std::size_t silent = 0;
        for (std::size_t p = 0; p < least.size(); ++p) {
            CHECK(mesh[p] == (optic[p] != kNone ? optic[p] : object[p]));
            silent += least[p] == 0 && most[p] == 1;
        }
        return silent;
    };
    CHECK(open() == 0);
    CHECK(warned.find("coverage") == std::string::npos);
    request.frame.max_error = 0.5;
    CHECK(open() == 32 * 24);
    CHECK(warned.find("coverage says nothing of 768 pixels") != std::string::npos);
    request.frame.max_error = std::nullopt;
    request.engine = Engine::kLimitTruth;
    CHECK(open() == 32 * 24);
}
