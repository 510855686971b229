// The k-d tree over points beside brute force.
#include <algorithm>
#include <cstddef>
#include <vector>

#include "base/math/point_tree.h"
#include "support/draw.h"
#include "support/test.h"

using namespace trilens;
using namespace trilens_test;

namespace {

std::vector<std::size_t> found_within(const PointTree& tree, const Vec3& place, double reach) {
    std::vector<std::size_t> found;
    tree.any_within(place, reach, [&](std::size_t k) {
        found.push_back(k);
        return false;
    });
    std::sort(found.begin(), found.end());
    return found;
}

std::vector<std::size_t> all_within(const std::vector<Vec3>& points, const Vec3& place, double reach) {
    std::vector<std::size_t> found;
    for (std::size_t k = 0; k < points.size(); ++k)
        if (length(points[k] - place) <= reach) found.push_back(k);
    return found;
}

}  // namespace

TEST_CASE("the points of a k-d tree within a reach are those of brute force, once each", "[base][law]") {
    Draw draw(71);
    // In space, in a plane across x, on a line along z, many at one place.
    for (const Vec3& spread : {Vec3(1), Vec3(0, 1, 1), Vec3(0, 0, 1), Vec3(1e9, 1, 1), Vec3(0)})
        for (const std::size_t count : {0u, 1u, 8u, 9u, 700u}) {
            std::vector<Vec3> points;
            for (std::size_t k = 0; k < count; ++k)
                points.push_back(k % 5 == 4 ? points[k - 3] : Vec3(3) + spread * draw.in_cube(1));
            const PointTree tree(points);
            for (int query = 0; query < 40; ++query) {
                const Vec3 place = count > 0 && query % 2 == 0
                                       ? points[static_cast<std::size_t>(query) % count]
                                       : Vec3(3) + spread * draw.in_cube(1.2);
                const double reach = query % 4 == 0 ? 0 : draw.log_uniform(1e-3, 2);
                REQUIRE(found_within(tree, place, reach) == all_within(points, place, reach));
            }
        }
}

TEST_CASE("a search of a k-d tree ends with the first call that returns true", "[base]") {
    const PointTree tree(std::vector<Vec3>(100, Vec3(1, 2, 3)));
    int calls = 0;
    CHECK(tree.any_within(Vec3(1, 2, 3), 0, [&](std::size_t) { return ++calls == 7; }));
    CHECK(calls == 7);
    CHECK_FALSE(tree.any_within(Vec3(1, 2, 4), 0.5, [&](std::size_t) { return true; }));
}
