// Dense cages, and those of many kinds of faces: a bounded number of bytes, the same points, and a refusal
// before it is too much.
#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <map>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "base/util/error.h"
#include "base/util/parallel.h"
#include "reference_subdivision.h"
#include "support/test.h"
#include "surfaces/patch_mesh.h"
#include "surfaces/surfaces.h"
#include "test_cages.h"

using namespace trilens;
using namespace trilens_test;

namespace {

/// A sphere with bumps of 20 * 4^levels triangles: an icosahedron of which each triangle is cut into four.
Cage bumpy_sphere(int levels) {
    const double a = 0.5257311121191336, b = 0.8506508083520399;
    std::vector<Vec3> points = {{-a, b, 0},  {a, b, 0},  {-a, -b, 0}, {a, -b, 0}, {0, -a, b},  {0, a, b},
                                {0, -a, -b}, {0, a, -b}, {b, 0, -a},  {b, 0, a},  {-b, 0, -a}, {-b, 0, a}};
    std::vector<std::vector<int>> faces = {{0, 11, 5}, {0, 5, 1},  {0, 1, 7},   {0, 7, 10}, {0, 10, 11},
                                           {1, 5, 9},  {5, 11, 4}, {11, 10, 2}, {10, 7, 6}, {7, 1, 8},
                                           {3, 9, 4},  {3, 4, 2},  {3, 2, 6},   {3, 6, 8},  {3, 8, 9},
                                           {4, 9, 5},  {2, 4, 11}, {6, 2, 10},  {8, 6, 7},  {9, 8, 1}};
    for (int level = 0; level < levels; ++level) {
        std::map<std::pair<int, int>, int> middles;
        const auto middle = [&](int p, int q) {
            const auto [place, is_new] =
                middles.try_emplace(std::minmax(p, q), static_cast<int>(points.size()));
            if (is_new) points.push_back(normalize(points[p] + points[q]));
            return place->second;
        };
        std::vector<std::vector<int>> finer;
        for (const auto& f : faces) {
            const int m0 = middle(f[0], f[1]), m1 = middle(f[1], f[2]), m2 = middle(f[2], f[0]);
            finer.insert(finer.end(), {{f[0], m0, m2}, {f[1], m1, m0}, {f[2], m2, m1}, {m0, m1, m2}});
        }
        faces = std::move(finer);
    }
    for (Vec3& p : points)
        p *= 1 + 0.05 * std::sin(11 * p.x) * std::sin(13 * p.y + 1) * std::sin(12 * p.z + 2);
    return make_cage(points, faces);
}

/// A cone over a polygon of n sides.
Cage cone(int n) {
    std::vector<Vec3> points = {{0, 0, 1}};
    std::vector<std::vector<int>> faces;
    for (int i = 0; i < n; ++i) {
        const double angle = 2 * 3.14159265358979 * i / n;
        points.emplace_back(std::cos(angle), std::sin(angle), 0);
        faces.push_back({0, i + 1, (i + 1) % n + 1});
    }
    return make_cage(points, faces);
}

/// Every triangle cut into three at a vertex in its middle.
Cage stellated(const Cage& cage) {
    std::vector<Vec3> points = cage.points;
    std::vector<std::vector<int>> faces;
    for (std::size_t f = 0; f < cage.face_vertex_counts.size(); ++f) {
        const auto corner = [&](std::size_t k) { return cage.face_vertex_indices[3 * f + k % 3]; };
        const int middle = static_cast<int>(points.size());
        points.push_back((cage.points[corner(0)] + cage.points[corner(1)] + cage.points[corner(2)]) / 3.0);
        for (std::size_t k = 0; k < 3; ++k) faces.push_back({corner(k), corner(k + 1), middle});
    }
    return make_cage(points, faces);
}

std::string dense_refusal(const Cage& cage, double memory) {
    try {
        make_limit_surface(cage, "dense", {}, memory);
    } catch (const InputError& error) {
        return error.what();
    }
    return "";
}

constexpr std::array<Vec2, 4> kCorners = {Vec2(0, 0), Vec2(1, 0), Vec2(1, 1), Vec2(0, 1)};

bool are_same(const SurfacePoint& a, const SurfacePoint& b) {
    return a.position == b.position && a.du == b.du && a.dv == b.dv && a.duu == b.duu && a.duv == b.duv &&
           a.dvv == b.dvv && a.normal == b.normal;
}

/// Corners, sides, both close to extraordinary vertices and far from them.
std::vector<Vec2> places_of_all_depths() {
    std::vector<Vec2> places(kCorners.begin(), kCorners.end());
    for (double off = 0.7; off > 0x1p-12; off *= 0.6)
        for (const Vec2& corner : kCorners) places.push_back(glm::abs(corner - off * Vec2(0.9, 0.4)));
    for (int k = 1; k < 8; ++k) places.emplace_back(k / 8.0, (k % 4) / 4.0);
    return places;
}

void append(Cage& cage, const Cage& other, const Vec3& offset) {
    const int first = static_cast<int>(cage.points.size());
    const auto add = [first](std::vector<int>& indices, const std::vector<int>& more) {
        for (const int index : more) indices.push_back(first + index);
    };
    for (const Vec3& p : other.points) cage.points.push_back(p + offset);
    cage.face_vertex_counts.insert(cage.face_vertex_counts.end(), other.face_vertex_counts.begin(),
                                   other.face_vertex_counts.end());
    add(cage.face_vertex_indices, other.face_vertex_indices);
    add(cage.crease_indices, other.crease_indices);
    cage.crease_lengths.insert(cage.crease_lengths.end(), other.crease_lengths.begin(),
                               other.crease_lengths.end());
    cage.crease_sharpnesses.insert(cage.crease_sharpnesses.end(), other.crease_sharpnesses.begin(),
                                   other.crease_sharpnesses.end());
}

constexpr int kSpokes = 40, kCreasedWheels = 27, kPlainWheels = 3;

/// Wheels with a crease along one spoke, each of a sharpness of its own (a float): no two of their faces have
/// a tree of patches of 0.7 MB in common. Then wheels without, whose faces are all of one kind, and a sheet.
Cage wheels_and_sheet(int sheet_side) {
    Cage cage;
    for (int k = 0; k < kCreasedWheels + kPlainWheels; ++k) {
        Cage one = wheel(kSpokes);
        if (k < kCreasedWheels) add_crease(one, {0, 1}, 0.25 + k / 64.0);
        append(cage, one, Vec3(3 * k, 0, 0));
    }
    append(cage, sheet(sheet_side, sheet_side), Vec3(0, 3, 0));
    return cage;
}

/// What a surface answered when it was first asked, at a few places per face.
struct FirstAnswers {
    static constexpr std::array<Vec2, 3> kPlaces = {Vec2(0.3, 0.6), Vec2(0x1p-5, 0x1p-8), Vec2(0, 0.9)};
    std::vector<std::array<SurfacePoint, kPlaces.size()>> at;

    void ask(const Surface& surface, Id face) {
        auto& answers = at.emplace_back();
        for (std::size_t k = 0; k < kPlaces.size(); ++k) answers[k] = surface.eval(face, kPlaces[k]);
    }
    bool are_given_again(const Surface& surface, Id face) const {
        for (std::size_t k = 0; k < kPlaces.size(); ++k)
            if (!are_same(surface.eval(face, kPlaces[k]), at[face][k])) return false;
        return true;
    }
};

/// Limit points of each face's corners, from the reference refined once: creases of less than 1 are gone
/// there.
std::vector<std::array<Vec3, 4>> limits_of_corners(const Cage& cage) {
    const ReferenceMesh mesh = refine(reference_mesh(cage));
    std::vector<std::array<Vec3, 4>> limits(cage.face_vertex_counts.size());
    for (const ReferenceMesh::Face& part : mesh.faces)
        for (std::size_t k = 0; k < 4; ++k)
            for (std::size_t corner = 0; corner < 4; ++corner)
                if (part.uv[k] == kCorners[corner])
                    limits[static_cast<std::size_t>(part.cage_face)][corner] =
                        *limit_point(mesh, part.vertices[k]);
    return limits;
}

double farthest_off(const Surface& surface, Id face, const std::array<Vec3, 4>& limits) {
    double worst = 0;
    for (std::size_t corner = 0; corner < 4; ++corner)
        worst = std::max(worst, length(surface.eval(face, kCorners[corner]).position - limits[corner]));
    return worst;
}

}  // namespace

TEST_CASE("A dense cage's face is the same from a few patch points as from all of them", "[surfaces][law]") {
    constexpr Id kWithAll = 60;  // of one kind: fewer than what is made of few points takes
    for (const SubdivisionScheme scheme : {SubdivisionScheme::kCatmullClark, SubdivisionScheme::kLoop}) {
        Cage cage = scheme == SubdivisionScheme::kLoop ? stellated(bumpy_sphere(5)) : bumpy_sphere(5);
        cage.scheme = scheme;
        const auto first = make_limit_surface(cage, "sphere", {}, 1e9),
                   later = make_limit_surface(cage, "sphere", {}, 1e9);
        const Id count = static_cast<Id>(first->face_count());
        REQUIRE(count == 3 * 20480);
        for (Id face = 0; face < count; ++face) later->eval(face, Vec2(0.3, 0.2));
        CHECK(later->bytes_held() < 100e6);
        for (Id face = count - kWithAll; face < count; ++face)
            for (const Vec2& uv : places_of_all_depths()) {
                CAPTURE(face, uv.x, uv.y);
                const SurfacePoint with_all = first->eval(face, uv), with_few = later->eval(face, uv);
                REQUIRE(are_same(with_all, with_few));
                const SurfacePoint at_first_order = later->eval_first_order(face, uv);
                REQUIRE(at_first_order.position == with_all.position);
                REQUIRE(at_first_order.normal == with_all.normal);
            }
    }
}

TEST_CASE("Vertices that no face has change nothing of a cage's surface", "[surfaces][law]") {
    const Cage cage = bumpy_sphere(2);
    Cage more = cage;
    for (int k = 0; k < 5; ++k) more.points.emplace_back(k, 2 * k, 3);
    const auto surface = make_limit_surface(cage, "sphere", {}, 1e9),
               with = make_limit_surface(more, "sphere", {}, 1e9);
    REQUIRE(with->face_count() == surface->face_count());
    for (Id face = 0; face < surface->face_count(); ++face)
        for (const Vec2& uv : {Vec2(0.3, 0.6), Vec2(0, 0), Vec2(1, 0.5)})
            REQUIRE(are_same(with->eval(face, uv), surface->eval(face, uv)));
    // Nor is it refined for their sake.
    CHECK(static_cast<double>(with->bytes_held()) < 1.01 * static_cast<double>(surface->bytes_held()));
}

TEST_CASE("A cage of 20,480 triangles is evaluated everywhere in less than 80 MB", "[surfaces][law]") {
    const Cage cage = bumpy_sphere(5);
    REQUIRE(cage.face_vertex_counts.size() == 20480);
    constexpr double kMost = 80e6;  // all points of all patches together would take 720 MB
    const auto surface = make_limit_surface(cage, "sphere", {}, 700e6);
    REQUIRE(surface->face_count() == 3 * 20480);
    CHECK(surface->bytes_held() < 25e6);  // nothing is made before it is asked for

    // The reference refined once has the sub-faces' corners as its vertices.
    const ReferenceMesh mesh = refine(reference_mesh(cage));
    std::vector<Vec3> limits;
    for (int v = 0; v < static_cast<int>(mesh.points.size()); ++v) limits.push_back(*limit_point(mesh, v));
    REQUIRE(mesh.faces.size() == surface->face_count());

    double worst = 0;
    std::vector<SurfacePoint> first_time;
    for (Id face = 0; face < surface->face_count(); ++face) {
        const ReferenceMesh::Face& of = mesh.faces[face];
        REQUIRE(static_cast<Id>(3 * of.cage_face + of.sub_face) == face);
        for (std::size_t k = 0; k < 4; ++k) {
            const SurfacePoint point = surface->eval(face, of.uv[k]);
            worst = std::max(worst, length(point.position - limits[of.vertices[k]]));
        }
        first_time.push_back(surface->eval(face, Vec2(0.3, 0.6)));
        if (face % 4096 == 0) REQUIRE(static_cast<double>(surface->bytes_held()) < kMost);
    }
    CHECK(worst < 1e-12);
    CHECK(static_cast<double>(surface->bytes_held()) < kMost);

    // Points that are made once more are the same bit for bit.
    for (Id face = 0; face < surface->face_count(); face += 17)
        REQUIRE(are_same(surface->eval(face, Vec2(0.3, 0.6)), first_time[face]));
    CHECK(static_cast<double>(surface->bytes_held()) < kMost);
}

TEST_CASE("Once the budget of patches is full, they are made again, bit for bit, on any thread",
          "[surfaces][law]") {
    constexpr Id kCreased = kCreasedWheels * kSpokes, kWheels = kCreased + kPlainWheels * kSpokes;
    constexpr double kBudget = static_cast<double>(kMostPatchBytes);
    // The larger one is dense: the faces of its plain wheels are made of few points.
    for (const int sheet_side : {4, 145}) {
        CAPTURE(sheet_side);
        const Cage cage = wheels_and_sheet(sheet_side);
        const auto surface = make_limit_surface(cage, "wheels", {}, 1e9);
        const Id count = static_cast<Id>(surface->face_count());
        REQUIRE(count == cage.face_vertex_counts.size());
        const double at_first = static_cast<double>(surface->bytes_held());
        const auto held = [&] { return static_cast<double>(surface->bytes_held()) - at_first; };
        const auto limits = limits_of_corners(cage);

        double worst = 0, most = 0, filled = 0;
        FirstAnswers first;
        for (Id face = 0; face < count; ++face) {
            worst = std::max(worst, farthest_off(*surface, face, limits[face]));
            first.ask(*surface, face);
            if (face % 16 == 0) most = std::max(most, held());
            if (face == kCreased - 4 * kSpokes) filled = held();
            // Patches of 160 faces, 0.7 MB each, have been made since it was full.
            if (face == kCreased - 1) CHECK(std::fabs(held() - filled) < 1e6);
        }
        CHECK(filled > 0.8 * kBudget);

        // Faces whose patches stayed, and others whose patches must be made once more.
        for (Id face = 0; face < count; face += face < kWheels ? 7 : 101) {
            CAPTURE(face);
            REQUIRE(first.are_given_again(*surface, face));
            worst = std::max(worst, farthest_off(*surface, face, limits[face]));
        }
        CHECK(worst < 1e-12);
        std::atomic<int> others = 0;
        parallel_for(4, 1, [&](std::size_t begin, std::size_t end) {
            for (std::size_t task = begin; task < end; ++task) {
                std::mt19937 random(static_cast<unsigned>(task));
                for (int i = 0; i < 150; ++i)
                    others += !first.are_given_again(*surface, random() % (i % 2 ? kWheels : count));
            }
        });
        CHECK(others == 0);
        CHECK(std::max(most, held()) < kBudget);
    }
}

TEST_CASE("What would not fit is refused with the estimate and what to do", "[surfaces][bad-input]") {
    const std::string dense = dense_refusal(bumpy_sphere(4), 200e6);
    CAPTURE(dense);
    CHECK(dense.rfind("dense: the limit surface of 5120 faces needs about 0.56", 0) == 0);
    CHECK(dense.find(" GiB of memory, and there are 0.186 GiB; use a cage of fewer faces") !=
          std::string::npos);
    CHECK(dense_refusal(bumpy_sphere(4), 700e6).empty());

    const std::string fan = dense_refusal(cone(4000), 4e9);
    CAPTURE(fan);
    CHECK(fan.rfind("dense: the limit surface around a vertex of 4000 faces needs about 5.", 0) == 0);
    CHECK(fan.find("; split that vertex") != std::string::npos);
    CHECK(dense_refusal(cone(60), 700e6).empty());

    Cage linear = cone(4000);  // has no patches to refine
    linear.scheme = SubdivisionScheme::kBilinear;
    CHECK(dense_refusal(linear, 1e9).empty());
}

TEST_CASE("What is not refused holds no more than the memory that it was given", "[surfaces][bad-input]") {
    for (const auto& [name, cage] : small_cages()) {
        CAPTURE(name);
        // The least memory that is accepted is the estimate.
        double low = 1, high = 1e9;
        REQUIRE(dense_refusal(cage, high).empty());
        while (high > 1.05 * low) {
            const double middle = std::sqrt(low * high);
            (dense_refusal(cage, middle).empty() ? high : low) = middle;
        }
        const auto surface = make_limit_surface(cage, name, {}, high);
        for (Id face = 0; face < surface->face_count(); ++face)
            for (const Vec2& corner : kCorners) surface->eval(face, corner);
        CAPTURE(surface->bytes_held(), high);
        CHECK(static_cast<double>(surface->bytes_held()) < high);
        CHECK(surface->bytes_held() > 0);
    }
}

TEST_CASE("A resolution is lowered until its grid has few enough facets", "[surfaces]") {
    for (const auto& [name, cage] : small_cages()) {
        CAPTURE(name);
        const auto surface = make_limit_surface(cage, name, {});
        for (const std::size_t most : {std::size_t{1}, std::size_t{100}, std::size_t{2000}}) {
            const int n = resolution_within(*surface, 16, most);
            CAPTURE(most, n);
            CHECK((n == 1 || count_facets(*surface, n) <= most));
            CHECK((n == 16 || count_facets(*surface, n + 1) > most));
        }
    }
}
