// Facets that are probed where that is worth it: the same pixels for any crop and any number of threads,
// no farther from the truth than with all facets, and less of them probed where pixels are few.
#include <cmath>
#include <string>

#include "base/util/parallel.h"
#include "laws/worlds.h"
#include "render/picture/picture.h"
#include "support/test.h"

using namespace trilens;
using namespace trilens_test;

namespace {

Picture drawn(const World& world, FacetUse facets, const LayerRequest& layers = {}) {
    PictureRequest request;
    request.frame.facets = facets;
    request.layers = layers;
    return draw_picture(world, request, {}, ignore, nullptr);
}

Image truth_of(const World& world) {
    PictureRequest request;
    request.engine = Engine::kLimitTruth;
    return draw_picture(world, request, {}, ignore, nullptr).image;
}

double mean_difference(const Image& a, const Image& b) {
    double sum = 0;
    std::size_t count = 0;
    for (const char* name : {"R", "G", "B"}) {
        const std::vector<float>&x = a.find(name)->floats(), &y = b.find(name)->floats();
        for (std::size_t i = 0; i < x.size(); ++i, ++count) sum += std::fabs(double{x[i]} - double{y[i]});
    }
    return sum / static_cast<double>(count);
}

/// Whether the pixels of the crop are those of the whole.
bool agrees(const Image& whole, const Image& crop) {
    for (const char* name : {"R", "G", "B"}) {
        const std::vector<float>&all = whole.find(name)->floats(), &part = crop.find(name)->floats();
        for (int y = 0; y < crop.data_height; ++y)
            for (int x = 0; x < crop.data_width; ++x)
                if (part[static_cast<std::size_t>(y * crop.data_width + x)] !=
                    all[static_cast<std::size_t>((y + crop.y0) * whole.data_width + x + crop.x0)])
                    return false;
    }
    return true;
}

}  // namespace

TEST_CASE("which facets are worthwhile changes with no crop and no number of threads", "[laws][law]") {
    for (const std::string scene : {"paths/crystal-ball", "paths/glass-torus", "paths/mirror-balls"})
        for (const int spp : {1, 2}) {
            CAPTURE(scene, spp);
            const auto world = shipped_world(scene, 8, 80, 60);
            world->scene.film.spp = spp;
            set_thread_count(1);
            const Picture whole = drawn(*world, FacetUse::kWorthwhile);
            set_thread_count(3);
            CHECK(agrees(whole.image, drawn(*world, FacetUse::kWorthwhile).image));
            LayerRequest crop;
            crop.x0 = 21, crop.y0 = 17, crop.x1 = 60, crop.y1 = 40;
            CHECK(agrees(whole.image, drawn(*world, FacetUse::kWorthwhile, crop).image));
            set_thread_count(0);
            REQUIRE(whole.statistics.probes.size() == world->optics.size());
            CHECK(drawn(*world, FacetUse::kAll).statistics.probes.empty());
        }
}

TEST_CASE("worthwhile facets are no farther from the truth than all of them", "[laws][law]") {
    for (const std::string scene : {"paths/crystal-ball", "paths/mirror-torus", "paths/glass-torus"}) {
        CAPTURE(scene);
        const auto world = shipped_world(scene, 8, 80, 60);
        const Image truth = truth_of(*world);
        const Picture all = drawn(*world, FacetUse::kAll), some = drawn(*world, FacetUse::kWorthwhile);
        CHECK(mean_difference(some.image, truth) <= mean_difference(all.image, truth) + 1e-6);
        CHECK(some.statistics.traced_pixels >= all.statistics.traced_pixels);
        // On a film of few pixels facets hold few samples.
        CHECK(some.statistics.projected_facets < all.statistics.projected_facets);
    }
}
