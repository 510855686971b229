// The metallic-roughness BRDF against the formulas of glTF's appendix B, numerical integrals and furnaces.
#include "shade/metallic_roughness.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "support/draw.h"
#include "support/test.h"

using namespace trilens;
using trilens_test::Draw;

namespace {

constexpr double kBrdfPi = std::numbers::pi;
const Vec3 kUp{0, 0, 1};

Vec3 direction(double cosine, double around) {
    const double sine = std::sqrt(std::max(1 - cosine * cosine, 0.0));
    return {sine * std::cos(around), sine * std::sin(around), cosine};
}

/// The BRDF as appendix B of the glTF 2.0 specification writes it, term by term; the normal is +Z.
Vec3 written_brdf(const SurfaceLook& look, const Vec3& view, const Vec3& light) {
    const double alpha = look.roughness * look.roughness, a2 = alpha * alpha;
    const Vec3 half = normalize(view + light);
    const double d = a2 / (kBrdfPi * std::pow(half.z * half.z * (a2 - 1) + 1, 2));
    const auto g1 = [&](double cosine) {
        return 2 * cosine / (cosine + std::sqrt(a2 + (1 - a2) * cosine * cosine));
    };
    const double specular = d * g1(light.z) * g1(view.z) / (4 * light.z * view.z);
    const double schlick = std::pow(1 - dot(view, half), 5);
    const double r = (1 - look.ior) / (1 + look.ior);
    const Vec3 f0 = glm::min(r * r * look.specular_color, Vec3(1));
    const Vec3 fr = f0 + (Vec3(1) - f0) * schlick;
    const Vec3 dielectric = (1 - look.specular * std::max({fr.x, fr.y, fr.z})) * look.base / kBrdfPi +
                            look.specular * fr * specular;
    const Vec3 metal = specular * (look.base + (Vec3(1) - look.base) * schlick);
    return glm::mix(dielectric, metal, look.metallic);
}

SurfaceLook any_look(Draw& draw) {
    SurfaceLook look;
    look.base = glm::abs(draw.in_cube(1));
    look.metallic = draw.uniform(-0.5, 1.5);
    look.metallic = std::clamp(look.metallic, 0.0, 1.0);
    look.roughness = draw.uniform(0.05, 1);
    look.ior = draw.uniform(1, 2.5);
    look.specular = draw.uniform(0, 1);
    look.specular_color = glm::abs(draw.in_cube(2));
    return look;
}

/// Integral of `of` over the directions above the surface, by the midpoint rule in the cosine and the angle.
Vec3 over_hemisphere(const std::function<Vec3(const Vec3&)>& of, int rings = 400, int sectors = 400) {
    Vec3 sum(0);
    for (int i = 0; i < rings; ++i)
        for (int j = 0; j < sectors; ++j)
            sum += of(direction((i + 0.5) / rings, 2 * kBrdfPi * (j + 0.5) / sectors));
    return 2 * kBrdfPi / (rings * sectors) * sum;
}

/// What a surface reflects of a radiance by its lobe and, for the matt part, by directions.
Vec3 reflected(const SurfaceLook& look, const Vec3& view, const std::function<Vec3(const Vec3&)>& radiance,
               std::size_t samples) {
    const ViewedSurface surface{kUp, view, look.roughness};
    ArrivedLight arrived;
    for (std::size_t k = 0; k < samples; ++k) {
        const LobeDirection lobe = lobe_direction(surface, k, samples);
        if (lobe.glossy == 0) continue;
        arrived.glossy += lobe.glossy * radiance(lobe.toward);
        arrived.glossy_grazing += lobe.grazing * radiance(lobe.toward);
        CHECK(lobe.side > 0);
    }
    const Vec3 matt = over_hemisphere(
        [&](const Vec3& toward) { return arrived_from(surface, toward, toward.z * radiance(toward)).matt; },
        60, 60);
    const Vec3 grazing = over_hemisphere(
        [&](const Vec3& toward) {
            return arrived_from(surface, toward, toward.z * radiance(toward)).matt_grazing;
        },
        60, 60);
    arrived.matt = matt;
    arrived.matt_grazing = grazing;
    return outgoing_radiance(look, arrived);
}

}  // namespace

TEST_CASE("light from a direction leaves as appendix B of glTF has it", "[shade][oracle]") {
    Draw draw(12);
    for (int trial = 0; trial < 2000; ++trial) {
        const SurfaceLook look = any_look(draw);
        const Vec3 view = direction(draw.uniform(0.01, 1), draw.uniform(0, 6.28)),
                   light = direction(draw.uniform(0.01, 1), draw.uniform(0, 6.28));
        const Vec3 seen = outgoing_radiance(
            look, arrived_from({kUp, view, look.roughness}, light, light.z * Vec3(1, 2, 3)));
        const Vec3 written = light.z * Vec3(1, 2, 3) * written_brdf(look, view, light);
        for (int k = 0; k < 3; ++k) CHECK(seen[k] == Approx(written[k]).epsilon(1e-9).margin(1e-12));
    }
}

TEST_CASE("the lobe's directions integrate the BRDF", "[shade][oracle]") {
    Draw draw(5);
    const auto radiance = [](const Vec3& toward) {
        return Vec3(1 + toward.x, 1 + toward.y * toward.z, 0.5 + toward.z);
    };
    for (const double roughness : {0.3, 0.5, 0.8, 1.0})
        for (const double cosine : {0.2, 0.6, 0.95}) {
            SurfaceLook look = any_look(draw);
            look.roughness = roughness;
            const Vec3 view = direction(cosine, 0.7);
            const Vec3 truth = over_hemisphere([&](const Vec3& toward) {
                return toward.z * radiance(toward) * written_brdf(look, view, toward);
            });
            const Vec3 seen = reflected(look, view, radiance, 4096);
            INFO("roughness " << roughness << ", cosine " << cosine);
            for (int k = 0; k < 3; ++k) CHECK(seen[k] == Approx(truth[k]).epsilon(5e-3));
            // Sixteen will do for a picture.
            const Vec3 few = reflected(look, view, radiance, 16);
            for (int k = 0; k < 3; ++k) CHECK(few[k] == Approx(truth[k]).epsilon(0.15));
        }
}

TEST_CASE("the white furnace: no surface gives back more than comes", "[shade][law]") {
    const auto white = [](const Vec3&) { return Vec3(1); };
    SurfaceLook matt;
    CHECK(outgoing_radiance(matt, {.matt = Vec3(1)}) == Vec3(1));  // Lambert's gives back all of it
    double greatest = 0;
    for (const double roughness : {0.1, 0.3, 0.6, 1.0}) {
        SurfaceLook metal;
        metal.metallic = 1;
        metal.roughness = roughness;
        SurfaceLook cover = metal;
        cover.metallic = 0;
        Vec3 all_views(0);
        for (double cosine = 0.025; cosine < 1; cosine += 0.05) {
            const Vec3 view = direction(cosine, 0.3);
            const double of_metal = reflected(metal, view, white, 1024).x;
            CHECK(of_metal <= 1 + 1e-3);
            if (cosine > 0.5 && roughness <= 0.3)
                CHECK(of_metal > 0.97);  // Smith's loses what is reflected twice
            const Vec3 of_cover = reflected(cover, view, white, 1024);
            greatest = std::max(greatest, of_cover.x);
            all_views += 2 * cosine * 0.05 * of_cover;  // light that leaves, over all directions
        }
        INFO("roughness " << roughness << ": of all light " << all_views.x);
        CHECK(all_views.x <= 1.045);  // see below
        CHECK(all_views.x > 0.85);
    }
    // Appendix B's dielectrics dim the matt part by the half vector's Fresnel term, which at grazing views is
    // not that of the mirror direction: there they give back more than comes, as the specification has it.
    INFO("greatest albedo of a dielectric " << greatest);
    CHECK(greatest > 1);
    CHECK(greatest < 2);
}

TEST_CASE("a polished surface reflects what lies in the mirrored direction, by Fresnel's term",
          "[shade][oracle]") {
    Draw draw(8);
    const auto radiance = [](const Vec3& toward) {
        return Vec3(1 + toward.x, 1 + toward.y * toward.z, 0.5 + toward.z);
    };
    for (int trial = 0; trial < 100; ++trial) {
        SurfaceLook look = any_look(draw);
        look.brdf = Brdf::kMetallicRoughness;
        look.roughness = 0;
        look.metallic = 1;
        const Vec3 view = direction(draw.uniform(0.01, 1), draw.uniform(0, 6.28));
        ArrivedLight arrived;
        for (std::size_t k = 0; k < 16; ++k) {
            const LobeDirection lobe = lobe_direction({kUp, view, 0}, k, 16);
            CHECK(lobe.side == 0);
            arrived.glossy += lobe.glossy * radiance(lobe.toward);
            arrived.glossy_grazing += lobe.grazing * radiance(lobe.toward);
        }
        const Vec3 mirrored(-view.x, -view.y, view.z);
        const Vec3 schlick = look.base + (Vec3(1) - look.base) * std::pow(1 - view.z, 5);
        const Vec3 seen = outgoing_radiance(look, arrived) - look.emissive,
                   truth = schlick * radiance(mirrored);
        for (int k = 0; k < 3; ++k) CHECK(seen[k] == Approx(truth[k]).epsilon(1e-9).margin(1e-12));
        // Roughness goes to it without a step.
        const LobeDirection nearly = lobe_direction({kUp, view, 2e-3}, 7, 16);
        CHECK(length(nearly.toward - mirrored) < 1e-3);
        CHECK(16 * (nearly.glossy + nearly.grazing) == Approx(1).epsilon(2e-2));
    }
    SurfaceLook look;
    CHECK(look.is_matt());
    look.brdf = Brdf::kMetallicRoughness;
    CHECK(!look.is_matt());
    look.brdf = Brdf::kLambert;
    look.roughness = 0.5;
    CHECK(look.is_matt());
}

TEST_CASE("a lobe is widened by the part of a light that a sample stands for", "[shade]") {
    // The lobe seen over a light of 0.2 radians: one wide sample or 400 narrow ones have the same sum.
    const ViewedSurface surface{kUp, direction(0.8, 0), 0.15};
    const Vec3 mirror(-surface.view.x, -surface.view.y, surface.view.z);
    double sum = 0, wide = 0;
    const int side = 41;
    const Vec3 u = normalize(cross(mirror, kUp)), v = cross(u, mirror);
    for (int i = 0; i < side; ++i)
        for (int j = 0; j < side; ++j) {
            const Vec3 off = 0.2 * (2.0 * i / (side - 1) - 1) * u + 0.2 * (2.0 * j / (side - 1) - 1) * v;
            if (length(off) > 0.2) continue;
            sum += arrived_from(surface, normalize(mirror + off), Vec3(1)).glossy.x /
                   (side * side * kBrdfPi / 4);
        }
    wide = arrived_from(surface, mirror, Vec3(1), 0.2).glossy.x;
    CHECK(wide == Approx(sum).epsilon(0.35));
    CHECK(arrived_from(surface, mirror, Vec3(1)).glossy.x > 4 * sum);
}
