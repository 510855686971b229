// Form factors by hemicubes and by rays against closed forms, and what all of them have in common.
#include <cmath>
#include <memory>
#include <numeric>

#include "radiosity/squares.h"
#include "support/test.h"

using namespace trilens;
using namespace trilens_test;

namespace {

struct TwoSquares {
    std::shared_ptr<const TriangleScene> scene;
    double exact = 0;
};

TwoSquares facing(int n) {
    auto scene = std::make_shared<TriangleScene>();
    add_square({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, n, *scene);
    add_square({0, 0, 1}, {0, 1, 0}, {1, 0, 0}, n, *scene);
    return {scene, facing_squares()};
}

TwoSquares in_a_corner(int n) {
    auto scene = std::make_shared<TriangleScene>();
    add_square({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, n, *scene);
    add_square({0, 0, 0}, {0, 0, 1}, {1, 0, 0}, n, *scene);
    return {scene, square_corner()};
}

double relative_error(const TwoSquares& squares, const FormFactorParams& params) {
    const FormFactors factors(squares.scene, params);
    const double found =
        between_halves(factors, triangle_areas(*squares.scene), static_cast<Id>(squares.scene->size() / 2));
    return std::fabs(found - squares.exact) / squares.exact;
}

FormFactorParams hemicubes(int resolution, int subdivision = 1) {
    return {FormFactorMethod::kHemicube, resolution, subdivision, 1, 1e-6};
}

FormFactorParams rays(int count) {
    return {FormFactorMethod::kRays, 2, 1, count, 1e-6};
}

}  // namespace

TEST_CASE("a hemicube's pixels take all that leaves a point", "[radiosity][law]") {
    for (const int resolution : {2, 10, 64}) {
        const Hemicube hemicube(resolution);
        const std::vector<double>& factors = hemicube.factors();
        CHECK(std::accumulate(factors.begin(), factors.end(), 0.0) == Approx(1).margin(1e-12));
        CHECK(*std::min_element(factors.begin(), factors.end()) > 0);
        CHECK(hemicube.owned().sample.size() == factors.size());
    }
}

TEST_CASE("a hemicube's rays go where their pixels' form factors say", "[radiosity][law]") {
    // The mean of cos over Lambert's distribution is 2/3, that of a direction along the surface 0.
    const Hemicube hemicube(32);
    const HemicubePlace place{{1, 2, 3}, {0, 0, 1}, {1, 0, 0}};
    const RayMesh mesh = hemicube.mesh(place);
    Vec3 mean(0);
    for (std::size_t f = 0; f < mesh.facets.size(); ++f) {
        const FacetWeights weights = facet_weights(mesh, f);
        for (const Id s : hemicube.owned().of(f)) {
            const Ray ray = sample_ray(mesh, f, weights, hemicube.grid().position(s));
            CHECK(ray.origin == place.origin);
            mean += hemicube.factors()[s] * normalize(ray.direction);
        }
    }
    CHECK(mean.z == Approx(2.0 / 3).margin(1e-3));
    CHECK(std::fabs(mean.x) < 1e-12);
    CHECK(std::fabs(mean.y) < 1e-12);
}

TEST_CASE("form factors of squares that face each other are the closed form", "[radiosity][law]") {
    CHECK(facing_squares() == Approx(0.199825).margin(1e-6));
    CHECK(relative_error(facing(4), hemicubes(128)) < 0.01);
    CHECK(relative_error(facing(8), hemicubes(128)) < 0.0025);
    CHECK(relative_error(facing(4), rays(4096)) < 0.003);
}

TEST_CASE("form factors of squares at right angles are the closed form", "[radiosity][law]") {
    CHECK(square_corner() == Approx(0.200044).margin(1e-6));
    const double coarse = relative_error(in_a_corner(4), hemicubes(128)),
                 fine = relative_error(in_a_corner(8), hemicubes(128)),
                 divided = relative_error(in_a_corner(4), hemicubes(128, 4));
    CHECK(coarse < 0.08);
    CHECK(fine < 0.04);
    CHECK(fine < 0.7 * coarse);
    CHECK(divided < 0.7 * coarse);  // what a hemicube in each triangle's middle leaves out
    CHECK(relative_error(in_a_corner(4), rays(4096)) < 0.003);
}

TEST_CASE("in a closed room all that a side sends arrives, by hemicube and by rays", "[radiosity][law]") {
    const auto scene = std::make_shared<const TriangleScene>(closed_cube(2));
    for (const FormFactorParams& params : {hemicubes(32), rays(512)}) {
        const FormFactors factors(scene, params);
        for (Id t = 0; t < scene->size(); ++t) {
            const FormFactorRow row = factors.row(side_of(t, false));
            CHECK(row.escaped == 0);
            CHECK(std::accumulate(row.factor.begin(), row.factor.end(), 0.0) == Approx(1).margin(1e-12));
            for (const Id side : row.side) CHECK(side % 2 == 0);  // fronts alone are seen
            CHECK(factors.row(side_of(t, true)).escaped == Approx(1));
        }
    }
}

TEST_CASE("form factors that are made reciprocal are, and still lose nothing", "[radiosity][law]") {
    const auto scene = std::make_shared<const TriangleScene>(closed_cube(3));
    const FormFactors factors(scene, hemicubes(32));
    std::vector<double> area;
    for (const double one : triangle_areas(*scene)) area.insert(area.end(), 2, one);
    const FormFactorMatrix drawn = make_matrix(factors), matrix = made_reciprocal(drawn, area);
    const auto at = [&](const FormFactorMatrix& from, Id i, Id j) {
        const FormFactorRow& row = from.rows[i];
        const auto found = std::lower_bound(row.side.begin(), row.side.end(), j);
        return found != row.side.end() && *found == j
                   ? row.factor[static_cast<std::size_t>(found - row.side.begin())]
                   : 0.0;
    };
    double before = 0, after = 0, moved = 0, sum = 0;
    for (Id i = 0; i < area.size(); ++i) {
        for (Id j = 0; j < area.size(); ++j) {
            before = std::max(before, std::fabs(area[i] * at(drawn, i, j) - area[j] * at(drawn, j, i)));
            after = std::max(after, std::fabs(area[i] * at(matrix, i, j) - area[j] * at(matrix, j, i)));
            moved += area[i] * std::fabs(at(drawn, i, j) - at(matrix, i, j));
            sum += area[i] * at(matrix, i, j);
        }
        const std::vector<double>& row = matrix.rows[i].factor;
        CHECK(std::accumulate(row.begin(), row.end(), matrix.rows[i].escaped) == Approx(1).margin(1e-9));
    }
    CHECK(before > 1e-5);
    CHECK(after < 1e-15);
    CHECK(moved < 0.1 * sum);
    CHECK(sum == Approx(6).margin(1e-6));  // the fronts' area: nothing escapes
}

TEST_CASE("form factors that nothing makes reciprocal still make no power", "[radiosity][law]") {
    // Two small sides give all that they have to one that says that nearly all of its own escapes.
    FormFactorMatrix drawn;
    drawn.rows.resize(3);
    drawn.rows[0] = {{1}, {0.05}, 0.95};
    drawn.rows[1] = {{0, 2}, {0.3, 0.7}, 0};
    drawn.rows[2] = {{1}, {1}, 0};
    for (const double small : {1.0, 1e-3, 1e-9}) {
        const FormFactorMatrix matrix = made_reciprocal(drawn, std::vector<double>{1, small, small});
        for (const FormFactorRow& row : matrix.rows) {
            INFO("small sides of " << small);
            const double sum = std::accumulate(row.factor.begin(), row.factor.end(), 0.0);
            CHECK(sum <= 1 + 1e-12);
            CHECK(sum + row.escaped == Approx(1).margin(1e-9));
            for (const double factor : row.factor) CHECK((factor >= 0 && std::isfinite(factor)));
        }
    }
}

TEST_CASE("a triangle without area sends nothing and is not seen", "[radiosity][bad-input]") {
    auto scene = std::make_shared<TriangleScene>(closed_cube(1));
    const auto first = static_cast<Id>(scene->points.size());
    for (const double t : {0.2, 0.5, 0.8}) scene->points.emplace_back(t, t, t);
    scene->triangles.push_back({first, first + 1, first + 2});
    scene->object.push_back(99);
    scene->primitive.push_back(0);
    const FormFactors factors(scene, hemicubes(16));
    const Id flat = static_cast<Id>(scene->size() - 1);
    CHECK(factors.row(side_of(flat, false)).escaped == 1);
    CHECK(factors.row(side_of(flat, false)).side.empty());
    for (Id t = 0; t < flat; ++t)
        for (const Id side : factors.row(side_of(t, false)).side) CHECK(side / 2 != flat);
}
