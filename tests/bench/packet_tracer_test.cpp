// Embree's own triangles in float against the truth in double: two answers that share no intersection code.
#include "bench/race/packet_tracer.h"

#include <algorithm>
#include <cmath>

#include "base/util/parallel.h"
#include "intersect/random_scene.h"
#include "intersect/tracer.h"
#include "support/test.h"

using namespace trilens;
using namespace trilens_bench;
using namespace trilens_test;

namespace {

/// A film of one square facet pair whose rays fan out and cross, all samples owned but those of a corner.
struct Film {
    RayMesh mesh;
    SampleGrid grid{0, 0, 61, 47, 2};
    std::vector<Id> owner;
    FacetSamples owned;
};

Film make_film(double scale) {
    Film film;
    for (const Vec2& at : {Vec2(0, 0), Vec2(61, 0), Vec2(61, 47), Vec2(0, 47)}) {
        const Vec3 direction(0.03 * (at.x - 30), 0.03 * (at.y - 25) + 0.004 * at.x, -3);
        film.mesh.screen.emplace_back(at.x, at.y, 1);
        film.mesh.rays.push_back({scale * Vec3(0.01 * at.x - 0.3, 0.01 * at.y - 0.2, 2.5), 0.7 * direction});
    }
    film.mesh.facets = {{0, 1, 2}, {kNone, kNone, kNone}, {0, 2, 3}};
    film.owner.resize(film.grid.size());
    for (std::size_t s = 0; s < film.grid.size(); ++s) {
        const Vec2 at = film.grid.position(s);
        film.owner[s] = at.x < 5 && at.y < 5 ? kNone : at.x > 58 ? 1 : 47 * at.x > 61 * at.y ? 0 : 2;
    }
    film.owned = group_by_facet(film.owner, film.mesh.facets.size());
    return film;
}

}  // namespace

TEST_CASE("packets hold every owned sample once", "[bench][law]") {
    const Film film = make_film(1);
    const std::vector<RayPacket> packets = make_ray_packets(film.mesh, film.owned, film.grid);
    std::vector<int> count(film.grid.size(), 0);
    for (const RayPacket& packet : packets) {
        for (const Id sample : packet.sample) {
            if (sample != kNone) ++count[sample];
        }
    }
    for (std::size_t s = 0; s < count.size(); ++s) {
        REQUIRE(count[s] == (film.owner[s] == kNone || film.owner[s] == 1 ? 0 : 1));
    }
}

TEST_CASE("float packets see what the truth sees, but for edges", "[bench]") {
    Random random(41);
    for (const bool best_tree : {false, true}) {
        for (const double scale : {1e-3, 1.0, 1e3}) {
            const TriangleScene scene = random_triangles(random, 300, scale);
            const Film film = make_film(scale);
            std::vector<Hit> exact(film.grid.size());
            trace_facets(Tracer(scene), film.mesh, film.owned, film.grid, exact);

            const FloatHit untouched{5, -1, 0, 0};
            std::vector<FloatHit> hits(film.grid.size(), untouched);
            const PacketTracer tracer(scene, {"", best_tree});
            tracer.trace(make_ray_packets(film.mesh, film.owned, film.grid), hits);

            int differ = 0, seen = 0;
            for (std::size_t s = 0; s < hits.size(); ++s) {
                if (film.owner[s] == kNone || film.owner[s] == 1) {
                    REQUIRE(hits[s].t == untouched.t);
                    continue;
                }
                if (hits[s].triangle != exact[s].triangle) {
                    ++differ;
                    continue;
                }
                if (!exact[s].seen()) continue;
                ++seen;
                CHECK(std::fabs(hits[s].t - exact[s].t) <= 1e-4 * exact[s].t);
            }
            INFO(differ << " of " << hits.size() << " samples differ at scale " << scale);
            CHECK(seen > 4000);
            CHECK(differ <= 4);
        }
    }
}

TEST_CASE("packets through an empty scene see nothing", "[bench]") {
    const Film film = make_film(1);
    std::vector<FloatHit> hits(film.grid.size(), FloatHit{5, -1, 0, 0});
    PacketTracer(TriangleScene{}).trace(make_ray_packets(film.mesh, film.owned, film.grid), hits);
    for (std::size_t s = 0; s < hits.size(); ++s) {
        REQUIRE(hits[s].triangle == (film.owner[s] == kNone || film.owner[s] == 1 ? 5 : kNone));
    }
}

TEST_CASE("hits left in the packets' order are those written per sample", "[bench]") {
    Random random(42);
    const TriangleScene scene = random_triangles(random, 300, 1);
    const Film film = make_film(1);
    const std::vector<RayPacket> packets = make_ray_packets(film.mesh, film.owned, film.grid);
    for (const char* isa : {"", "sse2"}) {
        const PacketTracer tracer(scene, {isa, false});
        CHECK((tracer.rays_at_once() == 8 || tracer.rays_at_once() == 16));
        CHECK(tracer.configuration().find("ignore_config_files=1") != std::string::npos);
        std::vector<FloatHit> hits(film.grid.size());
        std::vector<PacketHits> in_order(packets.size());
        tracer.trace(packets, hits);
        tracer.trace_in_order(packets, in_order);
        std::size_t seen = 0, different = 0;
        for (std::size_t p = 0; p < packets.size(); ++p) {
            for (std::size_t k = 0; k < RayPacket::kRays; ++k) {
                if (packets[p].sample[k] == kNone) continue;
                const FloatHit& hit = hits[packets[p].sample[k]];
                seen += hit.triangle != kNone;
                different +=
                    hit.triangle != in_order[p].triangle[k] ||
                    (hit.triangle != kNone &&
                     (hit.t != in_order[p].t[k] || hit.u != in_order[p].u[k] || hit.v != in_order[p].v[k]));
            }
        }
        CHECK(seen > 4000);
        CHECK(different == 0);
    }
}
