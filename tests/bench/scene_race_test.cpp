// The race on a scene: both sides draw the rays that leave its optics, and what it prints.
#include <cmath>

#include "base/util/error.h"
#include "bench/race/scene_race.h"
#include "support/test.h"
#include "trilens/render.h"
#include "trilens/scene.h"

using namespace trilens_test;
using namespace trilens_bench;

namespace {

Scene small_sphere() {
    SceneRequest request;
    request.file = source_dir() + "/scenes/sphere.json";
    request.overrides = {{"/film/width", "160"}, {"/film/height", "120"}, {"/film/spp", "1"}};
    return load_scene(request);
}

void quiet(const std::string&) {}

}  // namespace

TEST_CASE("both sides of a race draw the rays of the scene's optics", "[bench][oracle]") {
    BenchRequest request;
    request.frame.resolution = 8;
    request.race.repeats = 1;
    const BenchResult bench = run_bench(small_sphere(), request, quiet);
    const RaceResult& race = bench.race;
    PictureRequest picture;
    picture.frame = request.frame;
    const Image image = Renderer(small_sphere(), quiet).draw(picture).image;
    std::size_t on_optic = 0;
    for (const Id id : image.find("optic.object")->ids()) on_optic += id != kNone;
    CHECK(race.pixels == on_optic);
    CHECK(race.facets > 0);
    CHECK(race.facets <= 6 * 2 * 8 * 8);
    CHECK(race.triangles == 30);
    CHECK(race.mismatches.unexplained == 0);
    CHECK(race.mismatches.pixels == race.mismatches.edge + race.mismatches.depth);
    CHECK_FALSE(bench.direct);
    for (const double share : {race.shared, race.ambiguous, race.unbounded}) {
        CHECK(share >= 0);
        CHECK(share < 1);
    }
    CHECK(race.depth_complexity > 0.5);
    for (const double time : {race.visible_ms, race.written_ms, race.whole_ms, race.trace_ms, bench.shade_ms})
        CHECK((std::isfinite(time) && time > 0));
    CHECK(race.slowest_ratio <= race.ratio.written);
    CHECK(race.ratio.written <= race.fastest_ratio);
    const std::string json = race_json(bench);
    for (const char* name :
         {"\"schema\": \"trilens.bench/1\"", "\"visible_ms\"", "\"written\"", "\"with_build\"", "\"whole\""})
        CHECK(json.find(name) != std::string::npos);
    CHECK(json.find("ignore_config_files=1") != std::string::npos);
    CHECK(race_text(bench).find("hits written per sample") != std::string::npos);
}

TEST_CASE("a race on a scene refuses what it cannot do", "[bench][bad-input]") {
    BenchRequest request;
    request.race.repeats = 0;
    CHECK_THROWS_AS(run_bench(small_sphere(), request, quiet), UsageError);
    request.race = {1, "mmx"};
    CHECK_THROWS_AS(run_bench(small_sphere(), request, quiet), UsageError);
    request.race = {1, ""};
    request.frame.camera = 99;
    CHECK_THROWS_AS(run_bench(small_sphere(), request, quiet), UsageError);
}
