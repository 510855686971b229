// Rays that are collected band by band are those of the whole picture; a race of a scene counts them.
#include "trilens/view_collector.h"

#include <algorithm>

#include "base/rasterize.h"
#include "core/ray_mesh.h"
#include "support/test.h"
#include "trilens/bench.h"
#include "trilens/render.h"
#include "trilens/scene.h"

using namespace trilens;

namespace {

RayMesh film_mesh(double from) {
    return make_camera_mesh(make_perspective({{}, 40, 9, 7}), 9, 7, from);
}

}  // namespace

TEST_CASE("a mesh that comes in bands is one mesh with the samples of all", "[trilens]") {
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

TEST_CASE("a benchmark of many bands races each sample on the optics once", "[trilens]") {
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
