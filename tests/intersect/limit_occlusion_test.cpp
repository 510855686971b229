// Whether segments meet an exact surface, without where: as its first hits say.
#include <algorithm>

#include "intersect/limit_tracer.h"
#include "intersect/tracer.h"
#include "random_scene.h"
#include "support/test.h"
#include "test_surfaces.h"

using namespace trilens;
using namespace trilens_test;

TEST_CASE("a surface is met between two points where its first hit lies between them", "[intersect][law]") {
    Random random(41);
    const Torus torus(1.0, 0.45);
    const Waves waves(0.12, 9);
    int met = 0, missed = 0, different = 0;
    for (const int n : {6, 24}) {
        const LimitTracer on_torus(torus, grid_of(torus, n)), on_waves(waves, grid_of(waves, n));
        for (int i = 0; i < 6000; ++i) {
            const LimitTracer& tracer = i % 2 == 0 ? on_torus : on_waves;
            const Ray ray{random.in_box(1.5), random.log_uniform(0.5, 20) * random.direction()};
            const double t_min = i % 3 == 0 ? random.uniform(0, 0.5) : 0,
                         t_max = t_min + random.uniform(0, 1);
            const auto hit = tracer.first_hit(ray, t_min);
            const bool meets = tracer.meets(ray, t_min, t_max);
            different += meets != (hit && hit->t < t_max);
            met += meets;
            missed += !meets;
        }
    }
    CHECK(different == 0);
    CHECK(met > 1000);
    CHECK(missed > 1000);
}

TEST_CASE("a surface surely covers the origin only far inside its triangle", "[intersect]") {
    const PlaneTriangle around{Vec2(-1, -1), Vec2(2, -1), Vec2(-1, 2)},
        turned{around[0], around[2], around[1]};
    for (const PlaneTriangle& p : {around, turned}) {
        CHECK(surely_covers_origin(p, 0.7));
        CHECK_FALSE(surely_covers_origin(p, 0.71));
    }
    CHECK_FALSE(surely_covers_origin({Vec2(1, 0), Vec2(2, 0), Vec2(1, 1)}, 0));
}
