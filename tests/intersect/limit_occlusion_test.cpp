// Whether segments meet an exact surface, without where: as its first hits say.
#include <algorithm>
#include <array>

#include "intersect/limit_tracer.h"
#include "intersect/part_tree.h"
#include "intersect/tracer.h"
#include "random_scene.h"
#include "support/test.h"
#include "surfaces/surfaces.h"
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

namespace {

/// An octahedron out of shape: sub-faces of triangles, or triangles under Loop.
Cage crooked_cage(SubdivisionScheme scheme) {
    Cage cage;
    cage.scheme = scheme;
    cage.points = {{1, 0, 0}, {-1, 0.1, 0}, {0, 1.2, 0}, {0.2, -1, 0}, {0, 0, 1.5}, {0.1, 0, -1}};
    cage.face_vertex_counts.assign(8, 3);
    cage.face_vertex_indices = {0, 2, 4, 2, 1, 4, 1, 3, 4, 3, 0, 4, 2, 0, 5, 1, 2, 5, 3, 1, 5, 0, 3, 5};
    return cage;
}

/// Segments that start side by side and run nearly alike, or any that pass near the middle.
Segments some_segments(Random& random, bool alike) {
    const auto any = [&] {
        const Vec3 from = random.in_box(1.2);
        return Ray{from, random.uniform(0.2, 2) * (random.in_box(0.5) - from)};
    };
    const Ray first = any();
    Segments segments;
    for (std::size_t i = 0; i < Segments::kMost; ++i) {
        const Ray ray =
            alike ? Ray{first.origin + random.in_box(0.05), first.direction + random.in_box(0.02)} : any();
        segments.add(ray.origin, ray.direction);
    }
    return segments;
}

}  // namespace

TEST_CASE("segments meet a surface prepared in parts where their rays' first hits say", "[intersect][law]") {
    Random random(43);
    for (const SubdivisionScheme scheme : {SubdivisionScheme::kCatmullClark, SubdivisionScheme::kLoop}) {
        const auto surface = make_limit_surface(crooked_cage(scheme), "cage", {});
        const std::vector<GridPart> parts = grid_parts(*surface, 16, 4);
        const LimitTracer tracer(*surface, {part_boxes(*surface, 16, parts), [&](Id part) {
                                                return make_part_grid(*surface, 16, parts[part]);
                                            }});
        int met = 0, missed = 0, different = 0;
        for (int k = 0; k < 400; ++k) {
            const Segments segments = some_segments(random, k % 2 == 0);
            const Segments::Bits asked = k % 3 == 0 ? 0x0ff0f0f1u : segments.all();
            const Segments::Bits occluded = tracer.occluded(segments, asked);
            CHECK((occluded & ~asked) == 0);
            for_each_of(asked, [&](std::size_t i) {
                const auto hit = tracer.first_hit(segments.ray(i));
                const bool says = (occluded & Segments::bit(i)) != 0;
                different += says != (hit && hit->t < 1);
                ++(says ? met : missed);
            });
        }
        CHECK(different == 0);
        CHECK(met > 1500);
        CHECK(missed > 1500);
    }
}

TEST_CASE("a part says of segments that they meet it or miss it only where they surely do", "[intersect]") {
    // A flat square of side 2 that is said to stray by 0.1 and at its border by 0.2.
    PartQuad quad;
    quad.corner = {Vec3(-1, -1, 0), Vec3(1, -1, 0), Vec3(1, 1, 0), Vec3(-1, 1, 0)};
    quad.side.fill(2);
    quad.border = 0.2;
    quad.stray = 0.1;
    const PartTree tree(std::array{Box{Vec3(-2, -2, -0.1), Vec3(2, 2, 0.1)}});
    Segments segments;
    const auto add = [&](double x, double from, double to) { segments.add({x, 0, from}, {0, 0, to - from}); };
    add(0.79, 1, -1);     // met
    add(0.81, 1, -1);     // near the border
    add(1.09, 1, -1);     // the surface may stray so far
    add(1.11, 1, -1);     // missed
    add(0, 0.09, -1);     // may start behind it
    add(0, 1, 0.09);      // may end before it
    add(0, 0.11, -0.11);  // met
    add(0, 1, 0.5);       // ends before the box
    segments.add({0, 0, 1}, {0, 0, 0});
    const auto found = tree.find(segments, segments.all(), [&](Id) -> const PartQuad& { return quad; });
    CHECK(found.met == (Segments::bit(0) | Segments::bit(6)));
    CHECK(found.unusual == Segments::bit(8));
    Segments::Bits open = 0;
    for (const PartTree::Open& one : found.open) open |= Segments::bit(one.segment);
    CHECK(open == (Segments::bit(1) | Segments::bit(2) | Segments::bit(4) | Segments::bit(5)));
}
