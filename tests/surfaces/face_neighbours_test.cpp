// Steps over edges end where the surface goes on: from borders of faces to points just beyond them.
#include "base/raymesh/face_neighbours.h"

#include <array>
#include <string>
#include <utility>
#include <vector>

#include "support/test.h"
#include "surfaces/surfaces.h"
#include "test_cages.h"

using namespace trilens;
using namespace trilens_test;

namespace {

/// A smooth closed surface of triangles.
Cage rounded_bipyramid() {
    Cage cage = bipyramid(5);
    cage.scheme = SubdivisionScheme::kLoop;
    return cage;
}

Vec2 side_place(FaceDomain domain, int side, double s) {
    const std::array<Vec2, 4> square{Vec2(0, 0), Vec2(1, 0), Vec2(1, 1), Vec2(0, 1)};
    const std::array<Vec2, 3> triangle{Vec2(0, 0), Vec2(1, 0), Vec2(0, 1)};
    const bool has_four = domain == FaceDomain::kSquare;
    const auto corner = [&](int k) {
        return has_four ? square[static_cast<std::size_t>(k % 4)] : triangle[static_cast<std::size_t>(k % 3)];
    };
    return corner(side) + s * (corner(side + 1) - corner(side));
}

}  // namespace

TEST_CASE("a step over an edge ends on the surface beyond it", "[surfaces][law]") {
    const std::vector<std::pair<std::string, Cage>> cages = {
        {"cube", cube()}, {"prism of two n-gons", prism(5)}, {"triangles", rounded_bipyramid()}};
    for (const auto& [name, cage] : cages) {
        const auto surface = make_limit_surface(cage, name, {});
        const FaceNeighbours neighbours(*surface);
        int crossed = 0;
        double worst = 0;
        for (Id face = 0; face < surface->face_count(); ++face) {
            const FaceDomain domain = surface->domain(face);
            const Vec2 middle = domain == FaceDomain::kSquare ? Vec2(0.5) : Vec2(1.0 / 3);
            for (int side = 0; side < (domain == FaceDomain::kSquare ? 4 : 3); ++side)
                for (const double s : {0.2, 0.45, 0.7}) {
                    CAPTURE(name, face, side, s);
                    const Vec2 border = side_place(domain, side, s);
                    const Vec3 here = surface->eval(face, border).position;
                    // As far beyond the edge as a place inside is before it.
                    constexpr double kShort = 0.01;
                    const Vec3 inside = surface->eval(face, border + kShort * (middle - border)).position;
                    const Vec3 beyond = here + (here - inside);
                    const auto found = neighbours.over_edge({face, border}, beyond);
                    REQUIRE(found);
                    CHECK(found->face != face);
                    ++crossed;
                    const double way = length(beyond - here);
                    const Vec3 off = surface->eval(found->face, found->uv).position - beyond;
                    worst = std::max(worst, length(off) / (way * way));
                    // One that stays on the face is none over an edge.
                    CHECK_FALSE(neighbours.over_edge({face, border}, inside));
                }
        }
        CAPTURE(name, crossed);
        CHECK(crossed >= 60);
        CHECK(worst < 20);  // of the size of curvatures: second order in the step
    }
}

TEST_CASE("a border that no face shares is not stepped over", "[surfaces][law]") {
    const auto surface = make_limit_surface(sheet(2, 1), "sheet", {});
    const FaceNeighbours neighbours(*surface);
    int over = 0, stopped = 0;
    for (Id face = 0; face < surface->face_count(); ++face)
        for (int side = 0; side < 4; ++side) {
            const Vec2 border = side_place(FaceDomain::kSquare, side, 0.4);
            const Vec3 here = surface->eval(face, border).position;
            const Vec3 inside = surface->eval(face, border + 0.01 * (Vec2(0.5) - border)).position;
            (neighbours.over_edge({face, border}, here + (here - inside)) ? over : stopped) += 1;
        }
    CHECK(over == 2);
    CHECK(stopped == 6);
}
