// Laws of limit surfaces: they are what subdivision converges to, and their derivatives are derivatives.
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

std::unique_ptr<Surface> quietly(const Cage& cage) {
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
    const auto surface = quietly(cage);
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

TEST_CASE("A limit surface is what a second implementation of subdivision converges to", "[surfaces]") {
    for (const auto& [name, cage] : small_cages()) {
        CAPTURE(name);
        const Comparison result = compare_with_reference(cage, 3);
        // "dart": OpenSubdiv cannot do it, so its crease is not quite infinitely sharp (limit_patches.cpp).
        CHECK(result.worst < (name == "dart" ? 1e-4 : 1e-11));
        CHECK(result.compared > 4 * result.skipped);
    }
}

TEST_CASE("The limit surfaces of the shapes on file are what subdivision converges to", "[surfaces]") {
    TRILENS_NEEDS_DATA("cages/catmark_cube.obj");
    for (const std::string& name : cage_files()) {
        CAPTURE(name);
        const Comparison result = compare_with_reference(read_cage(name), name == "catmark_car" ? 1 : 2);
        CAPTURE(result.compared, result.skipped);
        CHECK(result.worst < 1e-9);
        CHECK(result.compared > result.skipped);
    }
}
