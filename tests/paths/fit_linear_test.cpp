// The L2 projection against dense least squares, and what it must leave alone.
#include "paths/facets/fit_nodes.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "intersect/random_scene.h"
#include "support/test.h"

using namespace trilens;
using namespace trilens_test;

namespace {

/// Facets of a grid of side x side cells.
std::vector<IdTriple> grid_facets(Id side) {
    std::vector<IdTriple> facets;
    for (Id j = 0; j < side; ++j)
        for (Id i = 0; i < side; ++i) {
            const Id a = j * (side + 1) + i, b = a + 1, c = b + side + 1, d = a + side + 1;
            facets.push_back({a, b, c});
            facets.push_back({a, c, d});
        }
    return facets;
}

FitValue random_value(Random& random) {
    FitValue value;
    for (double& v : value) v = random.uniform(-3, 3);
    return value;
}

Vec3 random_fit_weights(Random& random) {
    const Vec3 e(random.uniform(0.05, 1), random.uniform(0.05, 1), random.uniform(0.05, 1));
    return e / (e.x + e.y + e.z);
}

/// Solves A x = b by elimination with pivots, A dense.
std::vector<double> solve(std::vector<std::vector<double>> a, std::vector<double> b) {
    const std::size_t n = b.size();
    for (std::size_t k = 0; k < n; ++k) {
        std::size_t pivot = k;
        for (std::size_t r = k; r < n; ++r)
            if (std::fabs(a[r][k]) > std::fabs(a[pivot][k])) pivot = r;
        std::swap(a[k], a[pivot]);
        std::swap(b[k], b[pivot]);
        for (std::size_t r = k + 1; r < n; ++r) {
            const double f = a[r][k] / a[k][k];
            for (std::size_t c = k; c < n; ++c) a[r][c] -= f * a[k][c];
            b[r] -= f * b[k];
        }
    }
    for (std::size_t k = n; k-- > 0;) {
        for (std::size_t c = k + 1; c < n; ++c) b[k] -= a[k][c] * b[c];
        b[k] /= a[k][k];
    }
    return b;
}

/// The least-squares values from the normal equations, one part at a time.
std::vector<FitValue> least_squares(const std::vector<FitSample>& samples, std::size_t corners) {
    std::vector<FitValue> values(corners);
    for (std::size_t p = 0; p < kFitParts; ++p) {
        std::vector<std::vector<double>> a(corners, std::vector<double>(corners, 0.0));
        std::vector<double> b(corners, 0.0);
        for (const FitSample& s : samples)
            for (int i = 0; i < 3; ++i) {
                const Id row = s.corners[static_cast<std::size_t>(i)];
                b[row] += s.measure * s.weights[i] * s.value[p];
                for (int j = 0; j < 3; ++j)
                    a[row][s.corners[static_cast<std::size_t>(j)]] += s.measure * s.weights[i] * s.weights[j];
            }
        const std::vector<double> x = solve(a, b);
        for (std::size_t c = 0; c < corners; ++c) values[c][p] = x[c];
    }
    return values;
}

/// The nodes of the rule that integrates cubics over a triangle.
std::vector<FitSample> cubic_rule(const std::vector<IdTriple>& facets, Random& random) {
    std::vector<FitSample> samples;
    for (const IdTriple& facet : facets) {
        const double area = random.uniform(0.5, 2);
        for (int k = 0; k < 3; ++k) {
            Vec3 corner(0), middle(0.5);
            corner[k] = 1;
            middle[k] = 0;
            samples.push_back({facet, corner, area / 20, random_value(random)});
            samples.push_back({facet, middle, area * 2 / 15, random_value(random)});
        }
        samples.push_back({facet, Vec3(1.0 / 3), area * 9 / 20, random_value(random)});
    }
    return samples;
}

double worst(const std::vector<FitValue>& a, const std::vector<FitValue>& b) {
    double most = 0;
    for (std::size_t c = 0; c < a.size(); ++c)
        for (std::size_t p = 0; p < kFitParts; ++p) most = std::max(most, std::fabs(a[c][p] - b[c][p]));
    return most;
}

}  // namespace

TEST_CASE("the fit is the least-squares solution that elimination finds", "[paths][oracle]") {
    Random random(31);
    for (const Id side : {1u, 2u, 5u}) {
        const std::vector<IdTriple> facets = grid_facets(side);
        const std::size_t corners = (side + 1) * (side + 1);
        const std::vector<FitSample> samples = cubic_rule(facets, random);
        std::vector<FitValue> values(corners);
        for (FitValue& value : values) value = random_value(random);
        fit_linear(samples, values);
        CHECK(worst(values, least_squares(samples, corners)) < 1e-8);
    }
}

TEST_CASE("three uneven samples a facet are fitted as well, more slowly", "[paths]") {
    Random random(32);
    const std::vector<IdTriple> facets = grid_facets(4);
    std::vector<FitSample> samples;
    for (const IdTriple& facet : facets)
        for (int k = 0; k < 3; ++k) {
            Vec3 weights(1.0 / 6);
            weights[k] = 2.0 / 3;
            samples.push_back({facet, 0.8 * weights + 0.2 * random_fit_weights(random),
                               random.uniform(0.8, 1.25), random_value(random)});
        }
    std::vector<FitValue> values(25, FitValue{});
    fit_linear(samples, values);
    CHECK(worst(values, least_squares(samples, values.size())) < 1e-3);
}

TEST_CASE("linear functions stay as they are, and so do corners without samples", "[paths][law]") {
    Random random(33);
    const std::vector<IdTriple> facets = grid_facets(3);
    std::vector<FitValue> values(17);
    for (FitValue& value : values) value = random_value(random);
    std::vector<FitSample> samples;
    for (const IdTriple& facet : facets)
        for (int i = 0; i < 4; ++i) {
            FitSample sample{facet, random_fit_weights(random), random.uniform(0.1, 3), {}};
            for (std::size_t p = 0; p < kFitParts; ++p)
                for (int k = 0; k < 3; ++k)
                    sample.value[p] += sample.weights[k] * values[facet[static_cast<std::size_t>(k)]][p];
            samples.push_back(sample);
        }
    std::vector<FitValue> fitted = values;
    fit_linear(samples, fitted);
    CHECK(worst(fitted, values) < 1e-13);
    CHECK(fitted[16] == values[16]);
}

TEST_CASE("where samples leave a choice the fit satisfies them and does not run away", "[paths]") {
    // One sample on one facet: any change along its weights will do.
    FitSample sample{{0, 1, 2}, Vec3(0.5, 0.3, 0.2), 2, {}};
    sample.value.fill(1);
    std::vector<FitValue> values(3, FitValue{});
    fit_linear(std::vector{sample}, values);
    double reached = 0;
    for (int k = 0; k < 3; ++k) reached += sample.weights[k] * values[static_cast<std::size_t>(k)][0];
    CHECK(reached == Approx(1).epsilon(1e-9));
    for (const FitValue& value : values) CHECK(std::fabs(value[0]) < 2);
}
