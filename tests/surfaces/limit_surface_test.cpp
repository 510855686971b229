// Laws of limit surfaces: they are what subdivision converges to, and their derivatives are derivatives.
#include <algorithm>
#include <cmath>
#include <map>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "reference_subdivision.h"
#include "support/test.h"
#include "surfaces/surfaces.h"
#include "test_cages.h"

using namespace trilens;
using namespace trilens_test;

namespace {

double spread(const Cage& cage) {
    Vec3 low = cage.points[0], high = cage.points[0];
    for (const Vec3& p : cage.points) low = glm::min(low, p), high = glm::max(high, p);
    return length(high - low);
}

std::unique_ptr<Surface> quiet_cage(const Cage& cage) {
    return make_limit_surface(cage, "cage", {});
}

/// Surface faces by cage face and sub-face, as surfaces.h orders them.
std::map<std::pair<int, int>, Id> face_numbers(const Cage& cage) {
    std::map<std::pair<int, int>, Id> numbers;
    Id next = 0;
    for (int f = 0; f < static_cast<int>(cage.face_vertex_counts.size()); ++f) {
        if (std::count(cage.hole_indices.begin(), cage.hole_indices.end(), f)) continue;
        const int n = cage.face_vertex_counts[f];
        const bool whole = n == (cage.scheme == SubdivisionScheme::kLoop ? 3 : 4);
        for (int k = whole ? -1 : 0; k < (whole ? 0 : n); ++k) numbers[{f, k}] = next++;
    }
    return numbers;
}

struct Comparison {
    int compared = 0, skipped = 0;
    double worst = 0;  // share of the cage's size
};

Comparison compare_with_reference(const Cage& cage, int levels) {
    ReferenceMesh mesh = reference_mesh(cage);
    for (int level = 0; level < levels; ++level) mesh = refine(mesh);
    const auto surface = quiet_cage(cage);
    const auto numbers = face_numbers(cage);
    REQUIRE(surface->face_count() == numbers.size());

    Comparison result;
    for (const ReferenceMesh::Face& face : mesh.faces) {
        const auto number = numbers.find({face.cage_face, face.sub_face});
        if (number == numbers.end()) continue;
        for (std::size_t i = 0; i < face.vertices.size(); ++i) {
            const auto limit = limit_point(mesh, face.vertices[i]);
            if (!limit) {
                ++result.skipped;
                continue;
            }
            const Vec3 position = surface->eval(number->second, face.uv[i]).position;
            result.worst = std::max(result.worst, length(position - *limit) / spread(cage));
            ++result.compared;
        }
    }
    return result;
}

}  // namespace

TEST_CASE("A limit surface is what a second implementation of subdivision converges to",
          "[surfaces][oracle][law]") {
    for (const auto& [name, cage] : small_cages()) {
        CAPTURE(name);
        const Comparison result = compare_with_reference(cage, 3);
        // "dart": OpenSubdiv cannot do it, so its crease is not quite infinitely sharp (limit_patches.cpp).
        CHECK(result.worst < (name == "dart" ? 1e-4 : 1e-11));
        CHECK(result.compared > 4 * result.skipped);
    }
}

TEST_CASE("Limit surfaces at vertices of 2 to 12 faces are what subdivision converges to",
          "[surfaces][law]") {
    for (const auto& [name, cage] : made_cages()) {
        CAPTURE(name);
        const Comparison result = compare_with_reference(cage, 3);
        CAPTURE(result.compared, result.skipped);
        CHECK(result.worst < 1e-11);
        CHECK(result.compared > 4 * result.skipped);
    }
}

TEST_CASE("The limit surfaces of the shapes on file are what subdivision converges to",
          "[surfaces][law][golden]") {
    TRILENS_NEEDS_DATA("cages/catmark_cube.obj");
    for (const std::string& name : cage_files()) {
        CAPTURE(name);
        const Comparison result = compare_with_reference(read_cage(name), name == "catmark_car" ? 1 : 2);
        CAPTURE(result.compared, result.skipped);
        CHECK(result.worst < 1e-9);
        CHECK(result.compared > result.skipped);
    }
}

namespace {

/// Central differences of eval against its own derivatives, relative to the cage's size.
double worst_derivative(const Surface& surface, Id face, const Vec2& uv, double size) {
    constexpr double kStep = 1e-5;
    const auto at = [&](double u, double v) { return surface.eval(face, uv + Vec2(u, v)); };
    const SurfacePoint here = at(0, 0), right = at(kStep, 0), left = at(-kStep, 0), up = at(0, kStep),
                       down = at(0, -kStep);
    const double scale = 1 / (2 * kStep * size);
    double worst = 0;
    for (const Vec3& difference :
         {scale * (right.position - left.position) - here.du / size,
          scale * (up.position - down.position) - here.dv / size,
          scale * (right.du - left.du) - here.duu / size, scale * (up.du - down.du) - here.duv / size,
          scale * (right.dv - left.dv) - here.duv / size, scale * (up.dv - down.dv) - here.dvv / size})
        worst = std::max(worst, length(difference));
    return worst;
}

}  // namespace

TEST_CASE("Derivatives are the derivatives of the position, and the normal is across them", "[surfaces]") {
    std::mt19937 random(7);
    // Away from the lines between patches, where third derivatives jump, and from the last 2^-10 at corners.
    std::uniform_int_distribution<int> eighth(0, 3);
    std::uniform_real_distribution<double> within(0.03, 0.09);
    for (const auto& [name, cage] : small_cages()) {
        CAPTURE(name);
        const auto surface = quiet_cage(cage);
        for (Id face = 0; face < surface->face_count(); ++face)
            for (int i = 0; i < 8; ++i) {
                const Vec2 uv(eighth(random) / 8.0 + within(random), eighth(random) / 8.0 + within(random));
                CAPTURE(face, uv.x, uv.y);
                CHECK(worst_derivative(*surface, face, uv, spread(cage)) < 1e-6);
                const SurfacePoint point = surface->eval(face, uv);
                CHECK(length(point.normal - normalize(cross(point.du, point.dv))) < 1e-12);
            }
    }
    Cage loop = prism(3);
    loop = make_cage({{0, 0, 0}, {2, 0, 0}, {0, 2, 0}, {2, 2, 1}, {-1, 1, 1}, {1, -1, 1}},
                     {{0, 1, 2}, {1, 3, 2}, {0, 2, 4}, {1, 0, 5}});
    loop.scheme = SubdivisionScheme::kLoop;
    const auto surface = quiet_cage(loop);
    for (const Vec2& uv : {Vec2(0.21, 0.17), Vec2(0.1, 0.6), Vec2(0.55, 0.3), Vec2(0.4, 0.3)})
        CHECK(worst_derivative(*surface, 0, uv, spread(loop)) < 1e-6);
}

TEST_CASE("Parameters outside the domain are clamped to it", "[surfaces]") {
    const auto square = quiet_cage(cube());
    CHECK(square->eval(0, {-3, 0.5}).position == square->eval(0, {0, 0.5}).position);
    CHECK(square->eval(0, {0.5, 9}).position == square->eval(0, {0.5, 1}).position);
    CHECK(square->eval(0, {std::nan(""), 1}).position == square->eval(0, {0, 1}).position);
    Cage loop = make_cage({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}});
    loop.scheme = SubdivisionScheme::kLoop;
    const auto triangle = quiet_cage(loop);
    CHECK(length(triangle->eval(0, {1, 1}).position - triangle->eval(0, {0.5, 0.5}).position) < 1e-15);
}

TEST_CASE("A limit surface scales, moves and turns with its cage", "[surfaces][law]") {
    const Cage cage = prism(5);
    const auto surface = quiet_cage(cage);
    const Mat3 turn(Vec3(0, 0, 1), Vec3(1, 0, 0), Vec3(0, 1, 0));
    for (double scale : {1e-4, 1e-2, 1.0, 1e2, 1e4}) {
        Cage moved = cage;
        const Vec3 shift = scale * Vec3(100, -20, 3);
        for (Vec3& p : moved.points) p = scale * (turn * p) + shift;
        const auto image = quiet_cage(moved);
        for (Id face = 0; face < surface->face_count(); ++face)
            for (const Vec2& uv : {Vec2(0, 0), Vec2(1, 0.5), Vec2(0.3, 0.7)}) {
                const SurfacePoint a = surface->eval(face, uv), b = image->eval(face, uv);
                CHECK(length(scale * (turn * a.position) + shift - b.position) < 1e-13 * length(shift));
                CHECK(length(scale * (turn * a.du) - b.du) < 1e-12 * scale);
                CHECK(length(turn * a.normal - b.normal) < 1e-11);
            }
    }
}

TEST_CASE("Where derivatives vanish the normal comes from nearby", "[surfaces]") {
    // A cone of quads whose last edge is one point: the limit is smooth or pointed there, the normals are not
    // zero.
    Cage pole;
    std::vector<std::vector<int>> faces;
    for (int i = 0; i < 8; ++i) {
        const double angle = 2 * 3.14159265358979 * i / 8;
        pole.points.emplace_back(std::cos(angle), std::sin(angle), 0);
        pole.points.emplace_back(0, 0, 1);
        faces.push_back({2 * i, (2 * i + 2) % 16, (2 * i + 3) % 16, 2 * i + 1});
    }
    pole = make_cage(pole.points, faces);
    pole.scheme = SubdivisionScheme::kBilinear;
    const auto cone = quiet_cage(pole);
    for (Id face = 0; face < 8; ++face) {
        const SurfacePoint tip = cone->eval(face, {0.5, 1}), below = cone->eval(face, {0.5, 0.5});
        CHECK(length(tip.du) < 1e-15);
        CHECK(length(tip.normal - below.normal) < 1e-9);
        CHECK(tip.normal.z > 0.5);
    }
    Cage point = cube();
    for (Vec3& p : point.points) p = Vec3(1, 2, 3);
    CHECK(quiet_cage(point)->eval(0, {0.5, 0.5}).normal == Vec3(0));
    CHECK(quiet_cage(point)->eval(0, {0.5, 0.5}).position == Vec3(1, 2, 3));
    Cage line = sheet(1, 1);
    for (Vec3& p : line.points) p = Vec3(p.x + p.y, 0, 0);
    CHECK(quiet_cage(line)->eval(0, {0.25, 0.5}).normal == Vec3(0));
}

TEST_CASE("Holes have no faces and change nothing else", "[surfaces][law]") {
    Cage holed = cube();
    holed.hole_indices = {2};
    const auto with = quiet_cage(holed), without = quiet_cage(cube());
    REQUIRE(with->face_count() == 5);
    for (Id face = 0; face < 5; ++face)
        CHECK(with->eval(face, {0.3, 0.8}).position ==
              without->eval(face < 2 ? face : face + 1, {0.3, 0.8}).position);
}

TEST_CASE("the first order is the same bit for bit without the second", "[surfaces][law]") {
    std::mt19937 random(29);
    std::uniform_real_distribution<double> anywhere(0, 1), exponent(-9, -2);
    for (const auto& [name, cage] : made_cages()) {
        CAPTURE(name);
        const std::unique_ptr<Surface> surface = quiet_cage(cage);
        for (Id face = 0; face < surface->face_count(); ++face) {
            std::vector<Vec2> places{{0, 0}, {1, 0}, {0, 1}, {1, 1}, {0.5, 0.5}, {0.5, 0}, {-1, 2}};
            for (int i = 0; i < 20; ++i) places.emplace_back(anywhere(random), anywhere(random));
            for (int i = 0; i < 5; ++i)
                places.emplace_back(std::pow(10, exponent(random)), std::pow(10, exponent(random)));
            for (const Vec2& uv : places) {
                const SurfacePoint full = surface->eval(face, uv),
                                   first = surface->eval_first_order(face, uv);
                const bool same = first.position == full.position && first.du == full.du &&
                                  first.dv == full.dv && first.normal == full.normal;
                REQUIRE(same);
            }
        }
    }
}

TEST_CASE("a face that is said to be flat lies in a plane, and a flat box's are", "[surfaces][law]") {
    std::mt19937 random(31);
    std::uniform_real_distribution<double> anywhere(0, 1);
    Cage box = cube(), twisted = cube(), smooth = cube();
    box.scheme = twisted.scheme = SubdivisionScheme::kBilinear;
    twisted.points[0] += Vec3(0.1, 0.2, 0.3);
    std::vector<std::pair<std::unique_ptr<Surface>, std::size_t>> surfaces;  // and how many faces are flat
    surfaces.emplace_back(quiet_cage(box), 6);
    surfaces.emplace_back(quiet_cage(twisted), 3);
    surfaces.emplace_back(quiet_cage(smooth), 0);
    surfaces.emplace_back(make_primitive_surface({.kind = PlanePrimitive{}}), 1);
    surfaces.emplace_back(make_primitive_surface({.kind = CylinderPrimitive{}}), 0);
    for (const auto& [surface, expected] : surfaces) {
        std::size_t flat = 0;
        for (Id face = 0; face < surface->face_count(); ++face) {
            if (!surface->is_flat(face)) continue;
            ++flat;
            const SurfacePoint middle = surface->eval(face, {0.5, 0.5});
            for (int i = 0; i < 50; ++i) {
                const SurfacePoint p = surface->eval(face, {anywhere(random), anywhere(random)});
                CHECK(std::fabs(dot(p.position - middle.position, middle.normal)) < 1e-13);
                CHECK(length(p.normal - middle.normal) < 1e-13);
            }
        }
        CHECK(flat == expected);
    }
}

TEST_CASE("a surface made while another of like faces is there is the same bit for bit", "[surfaces][law]") {
    const auto places = [](const Surface& surface) {
        std::vector<Vec3> all;
        for (Id face = 0; face < surface.face_count(); ++face)
            for (const Vec2& uv : {Vec2(0.1, 0.2), Vec2(0.01, 0.003), Vec2(0.6, 0.3)}) {
                const SurfacePoint point = surface.eval(face, uv);
                all.insert(all.end(), {point.position, point.du, point.duv, point.normal});
            }
        return all;
    };
    Cage creased = prism(5);
    add_crease(creased, {0, 2, 4}, 1.5);
    for (const Cage& cage : {creased, cube()}) {
        const std::vector<Vec3> alone = places(*quiet_cage(cage));
        Cage moved = cage;
        for (Vec3& point : moved.points) point = 1.3 * point + Vec3(0.2, -3, 1);
        const auto other = quiet_cage(moved);
        const std::vector<Vec3> of_moved = places(*other);
        CHECK(places(*quiet_cage(cage)) == alone);
        CHECK(of_moved != alone);
    }
}
