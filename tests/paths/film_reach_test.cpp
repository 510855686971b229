// Triangles that may reach the film, against all of their points.
#include "intersect/random_scene.h"
#include "paths/facets/divide_facet.h"
#include "support/test.h"

using namespace trilens;
using namespace trilens_test;

TEST_CASE("a triangle with any point on the film may reach it, through the eye's plane too", "[paths]") {
    const Vec2 film(640, 480);
    Random random(61);
    std::size_t on_film = 0, kept_off = 0, left_out = 0;
    for (int i = 0; i < 20000; ++i) {
        std::array<Vec3, 3> screen;
        for (Vec3& s : screen) {
            const double w = random.uniform(-1, 3);
            s = Vec3(w * random.uniform(-900, 1500), w * random.uniform(-900, 1400), w);
            if (i % 4 == 0) s.x += random.uniform(-2000, 2000);  // steeper through the eye's plane
        }
        bool seen = false;
        for (int k = 0; k < 60; ++k) {
            double a = random.uniform(0, 1), b = random.uniform(0, 1);
            if (a + b > 1) a = 1 - a, b = 1 - b;
            const Vec3 p = (1 - a - b) * screen[0] + a * screen[1] + b * screen[2];
            seen = seen || (p.z > 0 && p.x >= 0 && p.x <= film.x * p.z && p.y >= 0 && p.y <= film.y * p.z);
        }
        const bool may = may_reach_film(screen, film);
        if (seen) CHECK(may);
        on_film += seen;
        kept_off += may && !seen;
        left_out += !may;
    }
    CHECK(on_film > 3000);
    CHECK(left_out > 3000);
    CHECK(kept_off < on_film);
}

TEST_CASE("what is behind the eye, or off one side, does not reach the film", "[paths]") {
    const Vec2 film(100, 100);
    CHECK_FALSE(may_reach_film({Vec3(50, 50, -1), Vec3(60, 50, -1), Vec3(50, 60, -2)}, film));
    CHECK_FALSE(may_reach_film({Vec3(-50, 50, 1), Vec3(-60, 50, 1), Vec3(-50, 60, 2)}, film));
    CHECK_FALSE(may_reach_film({Vec3(150, 50, 1), Vec3(160, 50, 1), Vec3(10, 60, -1)}, film));
    CHECK(may_reach_film({Vec3(99, 99, 1), Vec3(160, 50, 1), Vec3(150, 60, 1)}, film));
    CHECK(may_reach_film({Vec3(-200, -200, 1), Vec3(400, -200, 1), Vec3(-200, 400, 1)}, film));
}
