// Edge conics against the geometry they stand for.
#include "trilinear/facet/scene_edge.h"

#include <random>

#include "support/test.h"

using namespace trilens;

namespace {

std::mt19937_64 engine(21);
double uniform(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(engine);
}
Vec3 random_vector(double half) {
    return {uniform(-half, half), uniform(-half, half), uniform(-half, half)};
}

AffineRays random_rays() {
    AffineRays rays;
    for (std::size_t k = 0; k < 3; ++k) {
        rays.origin[k] = random_vector(1);
        rays.direction[k] = random_vector(1);
        rays.weight[k] = uniform(-1, 1);
    }
    return rays;
}

}  // namespace

TEST_CASE("an edge conic is the signed volume between the ray and the edge, times the square of the weight",
          "[trilinear][oracle][law]") {
    for (int i = 0; i < 2000; ++i) {
        const double scale = std::exp(uniform(std::log(1e-4), std::log(1e4)));
        AffineRays rays = random_rays();
        for (Vec3& o : rays.origin) o *= scale;
        const Vec3 a = random_vector(2 * scale), b = random_vector(2 * scale);
        const EdgeConic conic = edge_conic(line_quadratic(rays), a, b);
        const double u = uniform(-1, 1), v = uniform(-1, 1), w = rays.weight_at(u, v);
        const Vec3 pa = w * a - rays.origin_at(u, v), pb = w * b - rays.origin_at(u, v);
        CHECK(w * conic.at(u, v) ==
              Approx(triple(rays.direction_at(u, v), pa, pb)).margin(1e-12 * scale * scale * 100));
    }
}

TEST_CASE("an edge conic is antisymmetric to the last bit", "[trilinear][law]") {
    for (int i = 0; i < 2000; ++i) {
        const LineQuadratic line = line_quadratic(random_rays());
        const Vec3 a = random_vector(3), b = random_vector(3);
        const EdgeConic there = edge_conic(line, a, b), back = edge_conic(line, b, a);
        for (std::size_t k = 0; k < 6; ++k) CHECK(there.c[k] == -back.c[k]);
    }
}

TEST_CASE("a triangle's conics have one sign where the ray's line meets it, and are its barycentrics",
          "[trilinear]") {
    for (int i = 0; i < 2000; ++i) {
        const AffineRays rays = random_rays();
        const double u = uniform(-1, 1), v = uniform(-1, 1), w = rays.weight_at(u, v);
        if (std::fabs(w) < 0.05) continue;
        const Vec3 p0 = random_vector(3), p1 = random_vector(3), weights = glm::abs(random_vector(1)) + 0.01;
        const Vec3 b = weights / (weights.x + weights.y + weights.z);
        // The third corner makes the ray's point at t = 2 have the barycentrics b.
        const Vec3 hit = (rays.origin_at(u, v) + 2.0 * rays.direction_at(u, v)) / w;
        const Vec3 p2 = (hit - b.x * p0 - b.y * p1) / b.z;
        const LineQuadratic line = line_quadratic(rays);
        const double s12 = edge_conic(line, p1, p2).at(u, v), s20 = edge_conic(line, p2, p0).at(u, v),
                     s01 = edge_conic(line, p0, p1).at(u, v), sum = s12 + s20 + s01;
        const Vec3 n = cross(p1 - p0, p2 - p0), d = rays.direction_at(u, v);
        if (std::fabs(dot(n, d)) < 1e-3 * length(n) * length(d)) continue;
        CHECK(s12 / sum == Approx(b.x).margin(1e-6));
        CHECK(s20 / sum == Approx(b.y).margin(1e-6));
        CHECK(s01 / sum == Approx(b.z).margin(1e-6));
        CHECK(sum == Approx(w * dot(n, d)).epsilon(1e-6));
    }
}

TEST_CASE("a pinhole's edge conics are lines", "[trilinear]") {
    AffineRays rays = random_rays();
    const Vec3 eye = random_vector(1);
    rays.weight = {1, 0, 0};
    rays.origin = {eye, Vec3(0), Vec3(0)};
    const Vec3 a = random_vector(2), b = random_vector(2);
    const EdgeConic conic = edge_conic(line_quadratic(rays), a, b);
    CHECK(conic.c[3] == 0);
    CHECK(conic.c[4] == 0);
    CHECK(conic.c[5] == 0);
}

TEST_CASE("the range over the square holds every value in it", "[trilinear][law]") {
    for (int i = 0; i < 500; ++i) {
        EdgeConic conic;
        for (double& c : conic.c) c = uniform(-1, 1);
        const Range range = range_over_square(conic);
        bool held = true;
        for (int j = 0; j <= 20; ++j) {
            for (int k = 0; k <= 20; ++k) {
                const double value = conic.at(j / 10.0 - 1, k / 10.0 - 1);
                held = held && value >= range.low - 1e-14 && value <= range.high + 1e-14;
            }
        }
        CHECK(held);
    }
}
