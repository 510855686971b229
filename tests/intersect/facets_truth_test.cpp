// Facets truth: the interpolated ray of each owned sample, whatever the number of threads.
#include <algorithm>
#include <vector>

#include "base/util/parallel.h"
#include "intersect/tracer.h"
#include "random_scene.h"
#include "support/test.h"

using namespace trilens;
using namespace trilens_test;

namespace {

bool same_hit(const Hit& a, const Hit& b) {
    return a.triangle == b.triangle && (!a.seen() || (a.t == b.t && a.barycentric == b.barycentric));
}

}  // namespace

TEST_CASE("facets truth traces the interpolated ray of every owned sample, and nothing else",
          "[intersect][law]") {
    Random random(7);
    const TriangleScene scene = random_triangles(random, 400, 1);
    const Tracer tracer(scene);

    RayMesh mesh;
    mesh.screen = {{1, 1, 1}, {2 * 30, 2 * 4, 2}, {0.5 * 8, 0.5 * 28, 0.5}, {31, 30, 1}};
    for (int k = 0; k < 4; ++k)
        mesh.rays.push_back({Vec3(0, 0, 2) + random.in_box(0.5), Vec3(0, 0, -1) + random.in_box(0.3)});
    mesh.facets = {{0, 1, 2}, {kNone, kNone, kNone}, {1, 3, 2}};
    const SampleGrid grid{0, 0, 32, 32, 2};

    // Owners by the sign of the weights; facet 1 has no rays and owns a strip all the same.
    std::vector<Id> owner(grid.size(), kNone);
    for (std::size_t s = 0; s < grid.size(); ++s) {
        const Vec2 at = grid.position(s);
        if (at.y > 31) owner[s] = 1;
        for (const Id facet : {Id{0}, Id{2}}) {
            const Vec3 e = facet_weights(mesh, facet).unnormalised(at.x, at.y);
            if (e.x > 0 && e.y > 0 && e.z > 0) owner[s] = facet;
        }
    }
    const Hit untouched{7, -3, {5, 5}};
    std::vector<Hit> hits(grid.size(), untouched);
    trace_facets(tracer, mesh, group_by_facet(owner, mesh.facets.size()), grid, hits);

    int seen = 0;
    for (std::size_t s = 0; s < grid.size(); ++s) {
        if (owner[s] == kNone || owner[s] == 1) {
            CHECK(same_hit(hits[s], untouched));
            continue;
        }
        // The direct formula: screen-linear weights over depth.
        const Vec2 at = grid.position(s);
        const IdTriple& c = mesh.facets[owner[s]];
        const Mat3 screen(mesh.screen[c[0]], mesh.screen[c[1]], mesh.screen[c[2]]);
        Vec3 e = glm::inverse(screen) * Vec3(at.x, at.y, 1);
        e /= e.x + e.y + e.z;
        Ray ray;
        for (int k = 0; k < 3; ++k) {
            ray.origin += e[k] * mesh.rays[c[k]].origin;
            ray.direction += e[k] * mesh.rays[c[k]].direction;
        }
        const Hit direct = tracer.first_hit(ray);
        REQUIRE(direct.triangle == hits[s].triangle);
        if (!direct.seen()) continue;
        ++seen;
        CHECK(length(position(scene, direct) - position(scene, hits[s])) < 1e-11);
    }
    CHECK(seen > 500);
}

TEST_CASE("facets truth does not depend on the number of threads", "[intersect][law]") {
    Random random(8);
    const TriangleScene scene = random_triangles(random, 500, 1);
    const Tracer tracer(scene);
    RayMesh mesh;
    const SampleGrid grid{0, 0, 64, 64, 1};
    std::vector<Id> owner(grid.size());
    for (Id f = 0; f < 256; ++f) {  // facets of 4 x 4 samples each
        const double x = 4.0 * (f % 16), y = 4.0 * (f / 16);
        for (const Vec2& corner : {Vec2(x, y), Vec2(x + 8, y), Vec2(x, y + 8)}) {
            mesh.screen.emplace_back(corner.x, corner.y, 1);
            mesh.rays.push_back({random.in_box(2), random.direction()});
        }
        mesh.facets.push_back({3 * f, 3 * f + 1, 3 * f + 2});
    }
    for (std::size_t s = 0; s < grid.size(); ++s) owner[s] = static_cast<Id>(s / 4 % 16 + 16 * (s / 256));
    const FacetSamples owned = group_by_facet(owner, mesh.facets.size());

    std::vector<Hit> one(grid.size()), many(grid.size());
    set_thread_count(1);
    trace_facets(tracer, mesh, owned, grid, one);
    set_thread_count(0);
    trace_facets(tracer, mesh, owned, grid, many);
    for (std::size_t s = 0; s < grid.size(); ++s) REQUIRE(same_hit(one[s], many[s]));
    CHECK(std::count_if(one.begin(), one.end(), [](const Hit& hit) { return hit.seen(); }) > 200);
}
