// Shapes in a plane are found as by asking each.
#include "caustics/plane_tree.h"

#include <cmath>
#include <vector>

#include "support/draw.h"
#include "support/test.h"

using namespace trilens;
using namespace trilens_test;

namespace {

struct RandomPlane {
    Draw draw;

    double between(double low, double high) { return draw.uniform(low, high); }
    Vec2 in_square(double half) {
        const Vec3 at = draw.in_cube(half);
        return {at.x, at.y};
    }

    /// From specks to what covers all, and some needles and points.
    std::array<Vec2, 3> triangle() {
        const Vec2 at = in_square(1.3);
        const double size = draw.log_uniform(1e-4, 5);
        std::array<Vec2, 3> corner{at, at + size * in_square(1), at + size * in_square(1)};
        const double kind = between(0, 1);
        if (kind < 0.2) corner[2] = corner[1] + 1e-3 * (corner[2] - corner[1]);
        if (kind < 0.05) corner[2] = corner[1] = corner[0];
        return corner;
    }
    PlaneParallelogram parallelogram() {
        const double size = draw.log_uniform(1e-4, 3);
        const Vec2 middle = in_square(1.5), wide = size * in_square(1);
        const double share = draw.log_uniform(1e-3, 1);
        const Vec2 high = size * share * in_square(1);
        return {middle, between(0, 1) < 0.2 ? Mat2(0) : Mat2(wide, high)};
    }
};

std::vector<std::uint32_t> found_in(const PlaneTree& tree, const PlaneParallelogram& asked) {
    std::vector<std::uint32_t> found;
    tree.for_each_near(asked, [&](std::uint32_t shape) { found.push_back(shape); });
    return found;
}

std::vector<std::uint32_t> found_one_by_one(const std::vector<PlaneBounds>& shapes,
                                            const PlaneParallelogram& asked) {
    std::vector<std::uint32_t> found;
    for (std::uint32_t i = 0; i < shapes.size(); ++i)
        if (shapes[i].meets(asked.box(), asked)) found.push_back(i);
    return found;
}

}  // namespace

TEST_CASE("plane tree: finds the shapes that asking each one finds, once and in order", "[caustics][law]") {
    const std::size_t count = GENERATE(0, 1, 7, 40, 3000);
    RandomPlane random{Draw(count)};
    std::vector<PlaneBounds> shapes;
    for (std::size_t i = 0; i < count; ++i) shapes.push_back(PlaneBounds::of(random.triangle()));
    const PlaneTree tree(shapes, {{-1, -0.5}, {1, 0.5}});
    std::size_t all = 0;
    for (int i = 0; i < 2000; ++i) {
        const PlaneParallelogram asked = random.parallelogram();
        const std::vector<std::uint32_t> found = found_in(tree, asked);
        REQUIRE(found == found_one_by_one(shapes, asked));
        all += found.size();
    }
    CHECK(all >= 2 * count);
}

TEST_CASE("plane tree: shapes that only touch the lines it is divided along are found", "[caustics]") {
    std::vector<PlaneBounds> shapes;
    for (int y = -8; y < 8; ++y)
        for (int x = -8; x < 8; ++x) {
            const Vec2 at = Vec2(x, y) / 8.0;
            shapes.push_back(
                PlaneBounds::of(std::array<Vec2, 3>{at, at + Vec2(0.125, 0), at + Vec2(0, 0.125)}));
        }
    const PlaneTree tree(shapes, {Vec2(-1), Vec2(1)});
    for (int y = -8; y <= 8; ++y)
        for (int x = -8; x <= 8; ++x) {
            const PlaneParallelogram point{Vec2(x, y) / 8.0, Mat2(0)};
            CHECK(found_in(tree, point) == found_one_by_one(shapes, point));
        }
}

TEST_CASE("plane bounds: all of a triangle meets them, and little beside it does", "[caustics]") {
    RandomPlane random{Draw(5)};
    int beside = 0, met = 0;
    for (int i = 0; i < 3000; ++i) {
        const std::array<Vec2, 3> corner = random.triangle();
        const PlaneBounds bounds = PlaneBounds::of(corner);
        const double u = random.between(0, 1), v = random.between(0, 1 - u);
        const PlaneParallelogram inside{corner[0] + u * (corner[1] - corner[0]) + v * (corner[2] - corner[0]),
                                        Mat2(1e-9)};
        CHECK(bounds.meets(inside.box(), inside));
        // As far beyond a side as the corner across is before it.
        const Vec2 other = corner[1] + corner[2] - corner[0];
        const Vec2 middle = 0.5 * (corner[1] + corner[2]);
        const PlaneParallelogram outside{middle + 1.5 * (other - middle), Mat2(0)};
        const double area = std::fabs((corner[1].x - corner[0].x) * (corner[2].y - corner[0].y) -
                                      (corner[1].y - corner[0].y) * (corner[2].x - corner[0].x));
        if (area < 1e-12) continue;
        ++beside, met += bounds.meets(outside.box(), outside);
    }
    CHECK(beside > 2000);
    CHECK(met == 0);
}
