// The facet over a place of the film: the nearest of those that overlap there, found as a search through all
// of them finds it.
#include "paths/nested/nested_optics.h"

#include "intersect/random_scene.h"
#include "support/test.h"

using namespace trilens;
using namespace trilens_test;

namespace {

/// All facets, one after the other.
std::optional<CoveringFacet> by_search(const RayMesh& mesh, const std::vector<char>& covers,
                                       const Vec2& pixel) {
    std::optional<CoveringFacet> best;
    for (std::size_t f = 0; f < mesh.facets.size(); ++f) {
        bool counts = covers[f] != 0;
        Vec2 at[3];
        Vec3 w(0);
        for (int k = 0; k < 3; ++k) {
            const Vec3& s = mesh.screen[mesh.facets[f][static_cast<std::size_t>(k)]];
            counts = counts && s.z > 0;
            at[k] = Vec2(s.x, s.y) / s.z;
            w[k] = s.z;
        }
        if (!counts) continue;
        const auto area = [](const Vec2& a, const Vec2& b, const Vec2& c) {
            return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
        };
        const double whole = area(at[0], at[1], at[2]);
        const Vec3 flat =
            Vec3(area(pixel, at[1], at[2]), area(at[0], pixel, at[2]), area(at[0], at[1], pixel)) / whole;
        if (std::min({flat.x, flat.y, flat.z}) < 0) continue;
        const Vec3 e = flat / w;
        const double depth = 1 / (e.x + e.y + e.z);
        if (!best || depth < best->depth) best = CoveringFacet{static_cast<Id>(f), e * depth, depth};
    }
    return best;
}

}  // namespace

TEST_CASE("the nearest facet over a place is found", "[paths]") {
    Random random(72);
    RayMesh mesh;
    std::vector<char> covers;
    for (Id f = 0; f < 300; ++f) {
        const Vec2 middle(random.uniform(-20, 220), random.uniform(-20, 120));
        for (int k = 0; k < 3; ++k) {
            const double w = f % 25 == 7 && k == 1 ? -1.0 : random.uniform(1, 5);
            mesh.screen.emplace_back(w * (middle.x + random.uniform(-15, 15)),
                                     w * (middle.y + random.uniform(-15, 15)), w);
        }
        mesh.facets.push_back({3 * f, 3 * f + 1, 3 * f + 2});
        covers.push_back(f % 10 != 3);
    }
    mesh.rays.resize(mesh.screen.size());
    const NestedCover cover(mesh, covers);
    CHECK(cover.area() > 200 * 100);
    std::size_t over = 0;
    for (int i = 0; i < 4000; ++i) {
        const Vec2 pixel(random.uniform(-60, 260), random.uniform(-60, 160));
        const auto found = cover.at(pixel), wanted = by_search(mesh, covers, pixel);
        REQUIRE(found.has_value() == wanted.has_value());
        if (!found) continue;
        ++over;
        CHECK(found->facet == wanted->facet);
        CHECK(found->depth == Approx(wanted->depth));
        CHECK(length(found->weights - wanted->weights) < 1e-9);
    }
    CHECK(over > 500);
    CHECK(!NestedCover().at({1, 1}));
    CHECK(!NestedCover(mesh, std::vector<char>(covers.size(), 0)).at({100, 50}));
}

TEST_CASE("no place between two facets that share an edge is left open", "[paths][law]") {
    RayMesh mesh;
    Random random(73);
    for (int j = 0; j < 9; ++j)
        for (int i = 0; i < 9; ++i) {
            const double w = random.uniform(1, 3);
            mesh.screen.emplace_back(w * (10 * i + random.uniform(-2, 2)),
                                     w * (10 * j + random.uniform(-2, 2)), w);
        }
    for (Id j = 0; j < 8; ++j)
        for (Id i = 0; i < 8; ++i) {
            const Id a = 9 * j + i;
            mesh.facets.push_back({a, a + 1, a + 10});
            mesh.facets.push_back({a, a + 10, a + 9});
        }
    mesh.rays.resize(mesh.screen.size());
    const NestedCover cover(mesh, std::vector<char>(mesh.facets.size(), 1));
    for (const IdTriple& facet : mesh.facets)
        for (std::size_t k = 0; k < 3; ++k)
            for (int i = 0; i <= 20; ++i) {
                const Vec3 s = mix(mesh.screen[facet[k]], mesh.screen[facet[(k + 1) % 3]], i / 20.0);
                CHECK(cover.at({s.x / s.z, s.y / s.z}).has_value());
            }
}
