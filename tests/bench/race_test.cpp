// A race gives times, ratios that fit them, and names what the two sides see differently.
#include <algorithm>

#include "base/raymesh/rasterize.h"
#include "base/util/error.h"
#include "bench/race/race.h"
#include "support/test.h"

using namespace trilens;
using namespace trilens_bench;

namespace {

/// A square pinhole film before a bumpy wall.
struct Course {
    SampleGrid grid{0, 0, 64, 48, 1};
    RayMesh mesh;
    TriangleScene scene;
    FacetSamples owned;

    Course() {
        for (const Vec2 corner : {Vec2(0, 0), Vec2(64, 0), Vec2(64, 48), Vec2(0, 48)}) {
            mesh.screen.push_back({corner, 1});
            mesh.rays.push_back({Vec3(0), {(corner.x - 32) / 32, (corner.y - 24) / 32, 1}});
        }
        mesh.facets = {{0, 1, 2}, {0, 2, 3}};
        for (int j = 0; j <= 20; ++j)
            for (int i = 0; i <= 20; ++i)
                // Off the middle: else a row of diagonals meets pixel centres exactly, where either side may
                // be right.
                scene.points.push_back({i * 0.5 - 4.93, j * 0.5 - 5.04, 4 + 0.2 * std::sin(i + 2.0 * j)});
        for (Id j = 0; j < 20; ++j) {
            for (Id i = 0; i < 20; ++i) {
                const Id a = j * 21 + i;
                for (const IdTriple& t : {IdTriple{a, a + 1, a + 22}, IdTriple{a, a + 22, a + 21}}) {
                    scene.primitive.push_back(static_cast<Id>(scene.triangles.size()));
                    scene.object.push_back(0);
                    scene.triangles.push_back(t);
                }
            }
        }
        owned = rasterize_facets(mesh, grid);
    }
};

}  // namespace

TEST_CASE("a race counts its course and times both sides", "[bench]") {
    const Course course;
    const RaceResult r = race({course.scene, {{&course.mesh, &course.owned}}, course.grid}, {3, ""});
    CHECK(r.pixels == course.grid.size());
    CHECK(r.seen == r.pixels);
    CHECK(r.facets == 2);
    CHECK(r.triangles == 800);
    for (const double ms : {r.prepare_ms, r.samples_ms, r.visible_ms, r.written_ms, r.whole_ms, r.build_ms,
                            r.rays_ms, r.trace_ms, r.trace_written_ms})
        CHECK(ms > 0);
    CHECK(r.slowest_ratio <= r.ratio.written);
    CHECK(r.ratio.written <= r.fastest_ratio);
    CHECK(r.ratio.with_build == Approx((r.trace_written_ms + r.build_ms) / (r.written_ms + r.prepare_ms)));
    CHECK(r.mismatches.pixels == r.mismatches.edge + r.mismatches.depth + r.mismatches.unexplained);
    CHECK(r.mismatches.unexplained == 0);
    CHECK(r.mismatches.pixels < r.pixels / 100);
    CHECK(r.depth_complexity == 1);
    CHECK(r.shared == 0);
    CHECK(r.ambiguous < 0.01);
    CHECK(r.unbounded == 0);
}

TEST_CASE("a race counts layers, samples that share vectors, and samples that floats leave in doubt",
          "[bench]") {
    Course course;
    const RaceView view{&course.mesh, &course.owned};
    TriangleScene twice = course.scene;
    const auto points = static_cast<Id>(twice.points.size());
    for (const Vec3& p : course.scene.points) twice.points.push_back(2.0 * p);
    for (const IdTriple& t : course.scene.triangles) {
        twice.triangles.push_back({t[0] + points, t[1] + points, t[2] + points});
        twice.primitive.push_back(static_cast<Id>(twice.primitive.size()));
        twice.object.push_back(1);
    }
    CHECK(race({twice, {view}, course.grid}, {1, ""}).depth_complexity == 2);

    // The same wall again at the same place: floats cannot tell which is nearer.
    TriangleScene same = twice;
    for (std::size_t p = 0; p < course.scene.points.size(); ++p) same.points[points + p] = same.points[p];
    const RaceResult ambiguous = race({same, {view}, course.grid}, {1, ""});
    CHECK(ambiguous.depth_complexity == 1);
    CHECK(ambiguous.ambiguous == 1);
    CHECK(ambiguous.unbounded == 0);

    // A film of many small facets.
    RayMesh small;
    for (int j = 0; j <= 48; j += 2) {
        for (int i = 0; i <= 64; i += 2) {
            small.screen.push_back({Vec2(i, j), 1});
            small.rays.push_back({Vec3(0), {(i - 32) / 32.0, (j - 24) / 32.0, 1}});
        }
    }
    for (Id j = 0; j < 24; ++j) {
        for (Id i = 0; i < 32; ++i) {
            const Id a = j * 33 + i;
            small.facets.push_back({a, a + 1, a + 34});
            small.facets.push_back({a, a + 34, a + 33});
        }
    }
    const FacetSamples owned = rasterize_facets(small, course.grid);
    CHECK(race({course.scene, {{&small, &owned}}, course.grid}, {1, ""}).shared == 1);
}

TEST_CASE("two views of a course add up", "[bench][law]") {
    const Course course;
    const RaceView view{&course.mesh, &course.owned};
    const RaceResult r = race({course.scene, {view, view}, course.grid}, {1, ""});
    CHECK(r.pixels == 2 * course.grid.size());
    CHECK(r.facets == 4);
}

TEST_CASE("an instruction set that a side does not have is a usage error", "[bench][bad-input]") {
    const Course course;
    CHECK_THROWS_AS(race({course.scene, {{&course.mesh, &course.owned}}, course.grid}, {1, "mmx"}),
                    UsageError);
    // The next race has all of them again.
    CHECK(race({course.scene, {{&course.mesh, &course.owned}}, course.grid}, {1, ""}).pixels > 0);
}

TEST_CASE("a race refuses what does not fit together", "[bench][bad-input]") {
    const Course course;
    const FacetSamples none, wrong{{0, 0, 7}, {1, 2}};
    const RaceParams once{1, ""};
    CHECK_THROWS_AS(race({course.scene, {{&course.mesh, &none}}, course.grid}, once), InputError);
    CHECK_THROWS_AS(race({course.scene, {{&course.mesh, &wrong}}, course.grid}, once), InputError);
    CHECK_THROWS_AS(race({course.scene, {{}}, course.grid}, once), InputError);
    CHECK_THROWS_AS(race({course.scene, {}, {0, 0, 9, 9, 65536}}, once), InputError);
    CHECK_THROWS_AS(race({course.scene, {}, course.grid}, {0, ""}), UsageError);
}
