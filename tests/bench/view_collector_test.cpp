// Rays that are collected band by band are those of the whole picture; a race of a scene counts them.
#include "bench/race/scene_race.h"

#include <algorithm>

#include "base/raymesh/rasterize.h"
#include "core/ray_mesh.h"
#include "support/test.h"
#include "trilens/render.h"
#include "trilens/scene.h"

using namespace trilens;
using namespace trilens_bench;

namespace {

RayMesh film_mesh(double from) {
    return make_camera_mesh(make_perspective({{}, 40, 9, 7}), 9, 7, from);
}

}  // namespace

TEST_CASE("a mesh that comes in bands is one mesh with the samples of all", "[bench][trilens]") {
    const SampleGrid film{0, 0, 9, 7, 2};
    const RayMesh near = film_mesh(0), far = film_mesh(1);
    for (const int rows : {1, 2, 3, 7}) {
        CAPTURE(rows);
        ViewCollector collector(film);
        SampleGrid band = film;
        for (int y = 0; y < 7; y += rows) {
            band.y0 = y, band.y1 = std::min(7, y + rows);
            collector.add(near, rasterize_facets(near, band), band);
            if (y > 0) collector.add(far, rasterize_facets(far, band), band);
            collector.add(far, {}, band);
        }
        const CollectedViews views = collector.take();
        const FacetSamples whole = rasterize_facets(near, film);
        REQUIRE(views.meshes.size() == (rows < 7 ? 2 : 1));
        CHECK(views.owned[0].first == whole.first);
        CHECK(views.owned[0].sample == whole.sample);
        if (rows < 7)
            CHECK(views.owned[1].sample.size() ==
                  whole.sample.size() - 4 * 9 * static_cast<std::size_t>(rows));
        CHECK(views.views().size() == views.meshes.size());
        CHECK(collector.take().meshes.empty());
    }
}

TEST_CASE("parts of a film that are narrower than it count in the film", "[bench][trilens]") {
    const SampleGrid film{0, 0, 9, 7, 2};
    const RayMesh mesh = film_mesh(0);
    ViewCollector collector(film);
    const SampleGrid above{0, 0, 9, 3, 2}, below{2, 3, 6, 7, 2};
    for (const SampleGrid& part : {above, below}) collector.add(mesh, rasterize_facets(mesh, part), part);
    const CollectedViews views = collector.take();
    REQUIRE(views.meshes.size() == 1);
    REQUIRE(views.owned[0].sample.size() == above.size() + below.size());
    const FacetSamples whole = rasterize_facets(mesh, film);
    for (std::size_t f = 0; f < mesh.facets.size(); ++f) {
        std::vector<Id> wanted;
        for (const Id sample : whole.of(f)) {
            const Vec2 at = film.position(sample);
            if (at.y < 3 || (at.x > 2 && at.x < 6)) wanted.push_back(sample);
        }
        const auto found = views.owned[0].of(f);
        CHECK(std::equal(found.begin(), found.end(), wanted.begin(), wanted.end()));
    }
}

TEST_CASE("a benchmark of many bands races each sample on the optics once", "[bench][trilens]") {
    Scene scene = parse_scene(
        scene_examples()[0].json, "",
        std::vector<SceneOverride>{{"/film/width", "400"}, {"/film/height", "300"}, {"/film/spp", "1"}});
    BenchRequest request;
    request.frame.resolution = 4;
    request.race.repeats = 1;
    const BenchResult bench = run_bench(scene, request);
    CHECK_FALSE(bench.direct);
    PictureRequest picture;
    picture.frame = request.frame;
    CHECK(bench.race.pixels == Renderer(scene).draw(picture).statistics.optic_pixels);
    for (const double ms : {bench.surface_ms, bench.rays_ms, bench.shade_ms}) CHECK(ms > 0);
}
