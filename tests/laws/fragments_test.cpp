// Fragments: keys tell what full views tell, chosen samples see what all see, and colours are those of
// samples.
#include <algorithm>
#include <cmath>
#include <numeric>

#include "laws/agreement.h"
#include "laws/worlds.h"
#include "render/engines/engine.h"
#include "render/picture/picture.h"
#include "support/test.h"

using namespace trilens;
using namespace trilens_test;

namespace {

const std::vector<std::string> kScenes = {"sphere", "saddle", "paths/crystal-ball",
                                          "paths/glass-before-mirror"};

std::unique_ptr<World> fragment_world(const std::string& scene, int spp,
                                      FilterKind filter = FilterKind::kBox) {
    std::unique_ptr<World> world = shipped_world(scene, 8, 64, 48);
    world->scene.film.spp = spp;
    world->scene.film.filter = filter;
    return world;
}

struct Difference {
    double mean = 0, largest = 0, rms = 0;
};

Difference beauty_difference(const Image& a, const Image& b) {
    Difference result;
    std::size_t count = 0;
    for (const char* name : {"R", "G", "B"}) {
        const std::vector<float>&x = a.find(name)->floats(), &y = b.find(name)->floats();
        for (std::size_t i = 0; i < x.size(); ++i, ++count) {
            const double off = std::fabs(double{x[i]} - double{y[i]});
            result.mean += off;
            result.rms += off * off;
            result.largest = std::max(result.largest, off);
        }
    }
    result.mean /= static_cast<double>(count);
    result.rms = std::sqrt(result.rms / static_cast<double>(count));
    return result;
}

Picture drawn(const World& world, Shading shading) {
    PictureRequest request;
    request.layers.shading = shading;
    return draw_picture(world, request, {}, ignore, nullptr);
}

}  // namespace

TEST_CASE("a sample's key is that of what its view shows", "[laws][law][fragments]") {
    for (const std::string& scene : kScenes) {
        CAPTURE(scene);
        const auto world = fragment_world(scene, 3);
        const std::unique_ptr<Viewer> viewer = make_viewer(*world, {}, Engine::kExact, ignore);
        const SampleGrid grid{3, 2, 60, 47, 3, SampleOrder::kLattice};
        std::vector<FragmentKey> keys(grid.size());
        viewer->find_keys(grid, keys);
        SampleViews views;
        viewer->view(grid, views);
        std::size_t alone = 0, unlike = 0;
        for (std::size_t s = 0; s < keys.size(); ++s) {
            alone += keys[s] == kAlone;
            unlike += keys[s] != kAlone && keys[s] != viewer->key_of(views, views.samples[s]);
        }
        CHECK(unlike == 0);
        CHECK(alone < keys.size() / 2);
    }
}

TEST_CASE("samples in rows of the lattice, and chosen ones of them, see what they see pixel by pixel",
          "[laws][law][fragments]") {
    const auto world = fragment_world("sphere", 3);
    const std::unique_ptr<Viewer> viewer = make_viewer(*world, {}, Engine::kExact, ignore);
    const SampleGrid pixels{3, 2, 60, 47, 3}, rows{3, 2, 60, 47, 3, SampleOrder::kLattice};
    SampleGrid chosen = rows;
    std::vector<Id> list;
    for (Id s = 5; s < rows.size(); s += 1 + s % 7) list.push_back(s);
    chosen.chosen = list;
    SampleViews by_pixels, by_rows, of_chosen;
    viewer->view(pixels, by_pixels);
    viewer->view(rows, by_rows);
    viewer->view(chosen, of_chosen);

    const auto same = [](const SampleViews& a, std::size_t i, const SampleViews& b, std::size_t j) {
        const SampleView &x = a.samples[i], &y = b.samples[j];
        bool equal = x.optic == y.optic && x.facet == y.facet && x.depth == y.depth &&
                     x.hit.triangle == y.hit.triangle && x.ray.direction == y.ray.direction;
        const auto one = a.ends_of(x), other = b.ends_of(y);
        equal = equal && one.size() == other.size();
        for (std::size_t k = 0; equal && k < one.size(); ++k)
            equal = one[k].hit.triangle == other[k].hit.triangle && one[k].hit.t == other[k].hit.t &&
                    one[k].node == other[k].node;
        return equal;
    };
    std::size_t unlike = 0;
    for (std::size_t s = 0; s < rows.size(); ++s) {
        const Vec2 at = rows.position(s);
        const auto column = static_cast<std::size_t>((at.x - rows.x0) * 3),
                   row = static_cast<std::size_t>((at.y - rows.y0) * 3);
        const std::size_t p = pixels.sample_at(column, row);
        REQUIRE(pixels.position(p) == at);
        unlike += !same(by_rows, s, by_pixels, p);
    }
    CHECK(unlike == 0);
    for (std::size_t k = 0; k < list.size(); ++k) {
        REQUIRE(chosen.position(k) == rows.position(list[k]));
        unlike += !same(of_chosen, k, by_rows, list[k]);
    }
    CHECK(unlike == 0);
}

TEST_CASE("shading by fragments: coverage and flat colours to rounding, others nearly",
          "[laws][law][fragments]") {
    // Unlit materials, no Fresnel: nothing turns within a fragment.
    const std::string flat = R"({"version":1,"film":{"width":64,"height":48,"spp":4},
        "cameras":[{"name":"main","yfov":45,"lookAt":{"eye":[0.3,0.6,4.4],"at":[0,0,0],"up":[0,1,0]}}],
        "render":{"fresnel":false},
        "materials":[{"name":"mirror","metallicFactor":1,"baseColorFactor":[0.9,0.8,0.7]},
                     {"name":"red","unlit":true,"baseColorFactor":[0.8,0.1,0.1]},
                     {"name":"blue","unlit":true,"baseColorFactor":[0.1,0.2,0.9]}],
        "meshes":[{"name":"ball","role":"optic","material":"mirror","primitive":{"type":"sphere","radius":1}},
                  {"name":"floor","role":"object","material":"red","primitive":{"type":"plane","center":[0,-1.1,0],"size":[6,6]}},
                  {"name":"box","role":"object","material":"blue","primitive":{"type":"box","center":[-1.6,0,1.2],"size":[0.5,0.9,0.5]}}]})";
    const auto world = world_from("flat", flat, 8);
    const Picture by_fragment = drawn(*world, Shading::kFragment),
                  by_sample = drawn(*world, Shading::kSample);
    CHECK(beauty_difference(by_fragment.image, by_sample.image).largest < 1e-6);
    CHECK(by_fragment.image.find("A")->floats() == by_sample.image.find("A")->floats());
    CHECK(by_fragment.statistics.fragments < 2 * by_fragment.statistics.fragment_pixels);
    CHECK(by_sample.statistics.fragments == 0);

    for (const std::string& scene : kScenes) {
        CAPTURE(scene);
        const auto lit = fragment_world(scene, 4);
        const Difference off =
            beauty_difference(drawn(*lit, Shading::kFragment).image, drawn(*lit, Shading::kSample).image);
        // With textures the fragments are the better answer: 16 samples of a texture are not its mean.
        const bool textured = scene == "sphere" || scene == "saddle" || scene == "paths/glass-before-mirror";
        CHECK(off.mean < (textured ? 1e-2 : 1e-3));
        CHECK(off.rms < (textured ? 2.5e-2 : 5e-3));
    }
}

TEST_CASE(
    "shading by fragments: textures as near to the mean of many samples as those of as many samples are",
    "[laws][law][fragments][textures]") {
    // Water: shadows that end where tiles do. Torus: pixels over which the mirror bends much.
    for (const std::string scene : {"sphere", "torus", "water"}) {
        const auto drawn_with = [&](int spp, Shading shading) {
            return drawn(*fragment_world(scene, spp), shading).image;
        };
        const Image truth = drawn_with(24, Shading::kSample);
        const Difference by_fragment = beauty_difference(drawn_with(8, Shading::kFragment), truth),
                         by_sample = beauty_difference(drawn_with(8, Shading::kSample), truth);
        INFO(scene << ": by fragment " << by_fragment.mean << ", rms " << by_fragment.rms << ", by sample "
                   << by_sample.mean << ", rms " << by_sample.rms);
        CHECK(by_fragment.mean < by_sample.mean + 3e-4);
        CHECK(by_fragment.rms < by_sample.rms + 8e-4);
    }
}

TEST_CASE("the channel of fragments adds up to their number", "[laws][law][fragments]") {
    const auto world = fragment_world("sphere", 3);
    PictureRequest request;
    request.layers.layers = {"stat"};
    const auto sum_of = [&](const Picture& picture) {
        std::size_t sum = 0;
        for (const Id count : picture.image.find("stat.fragments")->ids()) sum += count;
        return sum;
    };
    const Picture by_fragment = draw_picture(*world, request, {}, ignore, nullptr);
    CHECK(sum_of(by_fragment) == by_fragment.statistics.fragments);
    CHECK(by_fragment.statistics.fragments_per_pixel() ==
          Approx(static_cast<double>(by_fragment.statistics.fragments) / (64 * 48)));
    CHECK(by_fragment.statistics.pixels_shaded_by_sample > 0);
    CHECK(by_fragment.statistics.pixels_shaded_by_sample <= by_fragment.statistics.rays_by_sample);
    request.layers.shading = Shading::kSample;
    CHECK(sum_of(draw_picture(*world, request, {}, ignore, nullptr)) == 64 * 48 * 9);
}

TEST_CASE("a filter of what is shown: no pixel beyond the screen's range by bright light, others as before",
          "[laws][law][fragments]") {
    for (const FilterKind filter : {FilterKind::kBox, FilterKind::kMitchell}) {
        CAPTURE(static_cast<int>(filter));
        const auto world = fragment_world("sphere", 3, filter);
        PictureRequest request;
        const Image light = draw_picture(*world, request, {}, ignore, nullptr).image;
        request.layers.shown = [](const Vec3& v) { return v; };
        const Image same = draw_picture(*world, request, {}, ignore, nullptr).image;
        CHECK(beauty_difference(light, same).largest < 1e-6);
        world->shading.background.color = Vec3(1000);  // far brighter than the screen's white
        request.layers.shown = [](const Vec3& v) { return glm::min(v, Vec3(1)); };
        const Image cut = draw_picture(*world, request, {}, ignore, nullptr).image;
        double most = -INFINITY, least = INFINITY;
        for (const char* name : {"R", "G", "B"})
            for (const float value : cut.find(name)->floats()) {
                most = std::max(most, double{value});
                least = std::min(least, double{value});
            }
        // Mitchell's lobes take at most a seventh of white.
        CHECK(most <= (filter == FilterKind::kBox ? 1 + 1e-6 : 1.15));
        CHECK(least >= (filter == FilterKind::kBox ? 0 : -0.15));
    }
}

TEST_CASE("shading by fragments: the same picture in any window and by any filter",
          "[laws][law][fragments]") {
    for (const FilterKind filter : {FilterKind::kBox, FilterKind::kMitchell, FilterKind::kGaussian}) {
        CAPTURE(static_cast<int>(filter));
        const auto world = fragment_world("sphere", 3, filter);
        PictureRequest whole, part;
        part.layers.x0 = 17, part.layers.y0 = 9, part.layers.x1 = 45, part.layers.y1 = 31;
        const Image all = draw_picture(*world, whole, {}, ignore, nullptr).image,
                    window = draw_picture(*world, part, {}, ignore, nullptr).image;
        std::size_t unlike = 0;
        for (const char* name : {"R", "G", "B", "A"})
            for (int y = 9; y < 31; ++y)
                for (int x = 17; x < 45; ++x)
                    unlike += all.find(name)->floats()[static_cast<std::size_t>(y * 64 + x)] !=
                              window.find(name)->floats()[static_cast<std::size_t>((y - 9) * 28 + x - 17)];
        CHECK(unlike == 0);
    }
}
