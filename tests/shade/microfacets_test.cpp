// GGX's microfacets against numerical integrals that know nothing of how they are sampled.
#include "shade/microfacets.h"

#include <cmath>
#include <functional>
#include <numbers>

#include "support/test.h"

using namespace trilens;

namespace {

const Vec3 kMeanNormal{0, 0, 1};

Vec3 tilted_by(double cosine, double around) {
    const double sine = std::sqrt(std::max(1 - cosine * cosine, 0.0));
    return {sine * std::cos(around), sine * std::sin(around), cosine};
}

/// The integral of `of` times D N.H over all microfacets' normals H. Over u, with tan^2 = alpha^2 u / (1 -
/// u), and the angle about the normal that measure is even.
double over_microfacets(double alpha, const std::function<double(const Vec3&)>& of) {
    constexpr int kRings = 3000, kSectors = 240;
    double sum = 0;
    for (int i = 0; i < kRings; ++i)
        for (int j = 0; j < kSectors; ++j) {
            // The tail is long: 1 - u is the square of what goes in even steps.
            const double left = 1 - (i + 0.5) / kRings, u = 1 - left * left;
            const double slope2 = alpha * alpha * u / (1 - u);
            sum += 2 * left *
                   of(tilted_by(1 / std::sqrt(1 + slope2), 2 * std::numbers::pi * (j + 0.5) / kSectors));
        }
    return sum / (kRings * kSectors);
}

/// As appendix B of the glTF 2.0 specification has it.
double written_distribution(double alpha, double cosine) {
    const double a2 = alpha * alpha;
    return a2 / (std::numbers::pi * std::pow(cosine * cosine * (a2 - 1) + 1, 2));
}
double written_masking(double alpha, double cosine) {
    const double tan2 = 1 / (cosine * cosine) - 1;
    return cosine > 0 ? 2 / (1 + std::sqrt(1 + alpha * alpha * tan2)) : 0;
}

constexpr double kRoughnesses[] = {0.05, 0.1, 0.2, 0.3, 0.6};
constexpr double kCosines[] = {0.1, 0.35, 0.7, 0.99};

/// The mean of `of` over samples of the visible normals.
double over_samples(const RoughSurface& surface, const std::function<double(const Vec3&)>& of) {
    constexpr std::size_t kCount = 16384;
    double sum = 0;
    for (std::size_t k = 0; k < kCount; ++k)
        sum += of(visible_normal(surface, RoughWay{k, kCount, 5}.place(0)));
    return sum / kCount;
}

}  // namespace

TEST_CASE("visible normals are distributed as their density, which is one in all", "[shade][oracle][thorough]") {
    for (const double roughness : kRoughnesses)
        for (const double cosine : kCosines) {
            INFO("roughness " << roughness << ", cosine " << cosine);
            const double alpha = roughness * roughness;
            const RoughSurface surface{kMeanNormal, tilted_by(cosine, 0.8), alpha};
            const auto integral = [&](const std::function<double(const Vec3&)>& of) {
                return over_microfacets(alpha, [&](const Vec3& half) {
                    return of(half) * visible_density(surface, half) /
                           (written_distribution(alpha, half.z) * half.z);
                });
            };
            CHECK(integral([](const Vec3&) { return 1.0; }) == Approx(1).epsilon(2e-3));
            const std::function<double(const Vec3&)> moments[] = {
                [&](const Vec3& h) { return h.x / (alpha + std::fabs(h.x)); },
                [&](const Vec3& h) { return h.y / (alpha + std::fabs(h.y)); },
                [&](const Vec3& h) { return h.z; },
                [&](const Vec3& h) { return h.x > 0.3 * alpha ? 1.0 : 0.0; },
                [&](const Vec3& h) { return std::fabs(h.y) < 0.7 * alpha ? 1.0 : 0.0; },
            };
            for (const auto& moment : moments)
                CHECK(over_samples(surface, moment) == Approx(integral(moment)).epsilon(5e-3).margin(5e-3));
        }
}

TEST_CASE("the white furnace of rough mirrors: samples weighed by masking reflect GGX's albedo, at most all",
          "[shade][law][oracle]") {
    for (const double roughness : kRoughnesses)
        for (const double cosine : kCosines) {
            INFO("roughness " << roughness << ", cosine " << cosine);
            const double alpha = roughness * roughness;
            const RoughSurface surface{kMeanNormal, tilted_by(cosine, 0.8), alpha};
            const auto outward = [&](const Vec3& half) {
                return 2 * dot(surface.view, half) * half - surface.view;
            };
            // BRDF times cosine, over half vectors: D G1 G1 V.H / N.V.
            const double albedo = over_microfacets(alpha, [&](const Vec3& half) {
                const double seen = dot(surface.view, half), out = outward(half).z;
                if (!(seen > 0 && out > 0)) return 0.0;
                return written_masking(alpha, cosine) * written_masking(alpha, out) * seen /
                       (cosine * half.z);
            });
            const double sampled = over_samples(surface, [&](const Vec3& half) {
                const double out = outward(half).z;
                return out > 0 ? ggx_masking(alpha * alpha, out) : 0.0;
            });
            CHECK(sampled == Approx(albedo).epsilon(2e-3));
            CHECK(sampled <= 1);
            CHECK(sampled > (roughness <= 0.2 ? 0.9 : 0.5));
        }
}

TEST_CASE("ways over rough surfaces cover the square evenly at every meeting, whatever moves them",
          "[shade]") {
    for (const std::size_t count : {16u, 100u, 256u})
        for (const std::size_t shift : {0u, 7u, 300u})
            for (std::size_t meeting = 0; meeting < 9; ++meeting) {
                Vec2 sum(0), squares(0);
                for (std::size_t k = 0; k < count; ++k) {
                    const Vec2 place = RoughWay{k, count, shift}.place(meeting);
                    CHECK((place.x >= 0 && place.x < 1 && place.y >= 0 && place.y < 1));
                    sum += place;
                    squares += place * place;
                }
                INFO(count << " ways, shift " << shift << ", meeting " << meeting);
                const double room = meeting == 0 ? 1.1 / double(count) : 6.0 / double(count);
                for (int c = 0; c < 2; ++c) {
                    CHECK(sum[c] / double(count) == Approx(0.5).margin(room));
                    CHECK(squares[c] / double(count) == Approx(1.0 / 3).margin(room));
                }
            }
}
