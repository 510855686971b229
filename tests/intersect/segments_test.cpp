// Segments asked side by side against the same asked one by one.
#include <algorithm>
#include <limits>

#include "intersect/box_tree.h"
#include "intersect/limit_tracer.h"
#include "intersect/tracer.h"
#include "random_scene.h"
#include "support/test.h"
#include "test_surfaces.h"

using namespace trilens;
using namespace trilens_test;

namespace {

constexpr double kUnbounded = std::numeric_limits<double>::infinity();

/// A step of any length, sometimes along axes, sometimes none that a ray can have.
Vec3 any_step(Random& random, double size) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    Vec3 step = random.log_uniform(1e-3, 10) * size * random.direction();
    switch (random.below(24)) {
        case 0:
            return Vec3(0);
        case 1:
            return Vec3(nan, 0, 1);
        case 2:
            return Vec3(0, kUnbounded, 0);
        case 3:
            return 1e-200 * step;
        case 4:
            return 1e200 * step;
        case 5:
        case 6:
            step[static_cast<int>(random.below(3))] = 0;
            break;
        case 7: {
            const double along = step.x;
            step = Vec3(0);
            step[static_cast<int>(random.below(3))] = along;
            break;
        }
        default:
            break;
    }
    return step;
}

Segments any_segments(Random& random, const Vec3& centre, double size) {
    Segments segments;
    const std::size_t count = random.below(Segments::kMost + 1);
    const Vec3 target = centre + random.in_box(2 * size);
    for (std::size_t i = 0; i < count; ++i) {
        const Vec3 from = centre + random.in_box(random.below(8) == 0 ? 1e5 * size : 2 * size);
        segments.add(from, random.below(2) == 0 ? target - from : any_step(random, size));
    }
    return segments;
}

}  // namespace

TEST_CASE("segments side by side are hidden as single rays are", "[intersect][oracle][law]") {
    Random random(31);
    int hidden = 0, open = 0;
    for (int trial = 0; trial < 60; ++trial) {
        const double size = random.log_uniform(1e-4, 1e4);
        TriangleScene scene = random_triangles(random, 1 + random.below(200), size);
        const Vec3 centre = trial % 3 == 0 ? Vec3(1e5 * size) : Vec3(0);
        for (Vec3& p : scene.points) p += centre;
        if (trial % 4 == 0)  // one far beyond the others, in a tree of its own
            for (int k = 0; k < 3; ++k) scene.points[scene.triangles[0][static_cast<std::size_t>(k)]] *= 1e6;
                // Packets of 4 rays, of 8, and of what suits the machine best.
#if defined(__x86_64__)
        const bool has_eight = __builtin_cpu_supports("avx2");
#else
        const bool has_eight = false;
#endif
        const Tracer tracer(scene, trial % 5 == 1 ? "sse2" : trial % 5 == 2 && has_eight ? "avx2" : "");
        for (int batch = 0; batch < 30; ++batch) {
            const Segments segments = any_segments(random, centre, size);
            const Segments::Bits found = tracer.occluded(segments);
            CHECK((found & ~segments.all()) == 0);
            for (std::size_t i = 0; i < segments.count; ++i) {
                const bool one = tracer.occluded(segments.ray(i), 0, 1);
                CHECK(one == (found >> i & 1));
                ++(one ? hidden : open);
            }
        }
    }
    CHECK(hidden > 2000);
    CHECK(open > 2000);
    CHECK(Tracer(TriangleScene()).occluded(any_segments(random, Vec3(0), 1)) == 0);
}

TEST_CASE("segments side by side meet a curved surface as single rays do", "[intersect][oracle][law]") {
    Random random(33);
    const Torus torus(1, 0.4);
    const ProjectedSphere sphere(FaceDomain::kSquare, Vec3(3, -2, 1), 0.01);
    int met = 0, passed = 0;
    const auto check = [&](const LimitTracer& tracer, const Vec3& centre, double size) {
        for (int batch = 0; batch < 60; ++batch) {
            const Segments segments = any_segments(random, centre, size);
            const Segments::Bits asked = static_cast<Segments::Bits>(random.below(1u << 31)) * 2 + 1;
            const Segments::Bits found = tracer.occluded(segments, asked);
            CHECK((found & ~(segments.all() & asked)) == 0);
            for_each_of(segments.all() & asked, [&](std::size_t i) {
                const auto hit = tracer.first_hit(segments.ray(i));
                const bool one = hit && hit->t < 1;
                CHECK(one == (found >> i & 1));
                ++(one ? met : passed);
            });
        }
    };
    check(LimitTracer(torus, grid_of(torus, 16)), Vec3(0), 0.8);
    check(LimitTracer(sphere, grid_of(sphere, 12)), Vec3(3, -2, 1), 0.006);
    CHECK(met > 100);
    CHECK(passed > 300);
}

TEST_CASE("a segment that may not meet a box has no point in it", "[intersect][law]") {
    Random random(32);
    int apart = 0, met = 0;
    for (int trial = 0; trial < 3000; ++trial) {
        Box box;
        box.include(random.in_box(1));
        box.include(box.low + random.log_uniform(1e-6, 1) * Vec3(1, trial % 3 ? 1 : 0, 0.5));
        const Segments segments = any_segments(random, Vec3(0), 1);
        const Segments::Bits may = may_meet(segments, box);
        for (std::size_t i = 0; i < segments.count; ++i) {
            // The stretch within each pair of sides, in turn.
            const Ray ray = segments.ray(i);
            double enter = 0, leave = 1;
            for (int k = 0; k < 3; ++k) {
                const double a = (box.low[k] - ray.origin[k]) / ray.direction[k],
                             b = (box.high[k] - ray.origin[k]) / ray.direction[k];
                if (ray.direction[k] == 0 && (ray.origin[k] < box.low[k] || ray.origin[k] > box.high[k]))
                    leave = -1;
                if (ray.direction[k] == 0) continue;
                enter = std::max(enter, std::min(a, b)), leave = std::min(leave, std::max(a, b));
            }
            const double room = 1e-9;
            if (enter < leave - room) CHECK((may >> i & 1));
            if (enter > leave + room && std::isfinite(dot(ray.direction, ray.direction)) &&
                dot(ray.direction, ray.direction) > 1e-12)
                CHECK_FALSE((may >> i & 1));
            ++(may >> i & 1 ? met : apart);
        }
    }
    CHECK(apart > 5000);
    CHECK(met > 500);
    const Box everywhere{Vec3(-kUnbounded), Vec3(kUnbounded)};
    const Segments segments = any_segments(random, Vec3(0), 1);
    CHECK(may_meet(segments, everywhere) == segments.all());
}
