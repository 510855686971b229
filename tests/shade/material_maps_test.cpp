// Normal, occlusion, roughness and emission maps at points of a triangle, against what they must come to.
#include <cmath>
#include <numbers>

#include "support/draw.h"
#include "support/shaded_triangle.h"
#include "support/test.h"

using namespace trilens;
using trilens_test::Draw;

namespace {

std::shared_ptr<const Texture> one_texel(const Vec3& value) {
    return std::make_shared<Texture>(Texture{
        1, 1, {static_cast<float>(value.x), static_cast<float>(value.y), static_cast<float>(value.z)}, {}});
}

/// A triangle in the plane z = 0 whose u runs along `u` and whose v along `v`, both in that plane.
struct MappedTriangle : trilens_test::ShadedTriangle {
    Hit hit{0, 1.0, {0.3, 0.3}};

    MappedTriangle(const Vec3& u, const Vec3& v, const Light& light)
        : trilens_test::ShadedTriangle({{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}}, light) {
        // uv of a point p: solves p = s u + t v.
        const double area = u.x * v.y - u.y * v.x;
        const auto uv_of = [&](const Vec3& p) {
            return Vec2((p.x * v.y - p.y * v.x) / area, (u.x * p.y - u.y * p.x) / area);
        };
        shading.uvs = {{uv_of(triangles.points[0]), uv_of(triangles.points[1]), uv_of(triangles.points[2])}};
    }
    Vec3 seen(const Vec3& from) const { return shade_hit(shading, hit, {from, -from}); }
};

Light from_above(const Vec3& toward) {
    Light light;
    light.kind = DirectionalLight{.direction = -toward};
    light.intensity = std::numbers::pi;
    return light;
}

}  // namespace

TEST_CASE("a normal map turns the normal along u and v, from both sides and under mirrored uvs",
          "[shade][oracle]") {
    Draw draw(31);
    for (int trial = 0; trial < 300; ++trial) {
        // Any slopes, any turn of uv about the normal, mirrored or not, of any size.
        const double turn = draw.uniform(0, 6.3), size = draw.log_uniform(0.01, 100);
        const bool mirrored = draw.uniform(0, 1) < 0.5;
        const Vec3 u = size * Vec3(std::cos(turn), std::sin(turn), 0),
                   v = (mirrored ? -size : size) * Vec3(-std::sin(turn), std::cos(turn), 0);
        const double side = trial % 2 ? 1 : -1;  // that is looked at
        const Vec3 mapped = normalize(Vec3(draw.uniform(-0.5, 0.5), draw.uniform(-0.5, 0.5), 1));
        Vec3 toward = draw.unit();
        if (toward.z * side < 0) toward.z = -toward.z;
        MappedTriangle triangle(u, v, from_above(toward));
        const double scale = draw.uniform(0, 1.5);
        triangle.material().normal_scale = scale;
        triangle.material().normal_texture.picture = one_texel((mapped + Vec3(1)) / 2.0);
        // By hand: +X of the map along u, +Y along v, +Z along the front's normal; seen from behind, turned
        // over.
        const Vec3 normal = side * normalize(scale * mapped.x * normalize(u) +
                                             scale * mapped.y * normalize(v) + mapped.z * Vec3(0, 0, 1));
        const double seen = triangle.seen({0, 0, side}).x;
        CHECK(seen == Approx(std::max(dot(normal, toward), 0.0)).margin(1e-6));
    }
}

TEST_CASE("a normal map lies along the corners' tangents where there are some, whatever uv say",
          "[shade][oracle]") {
    Draw draw(32);
    for (int trial = 0; trial < 300; ++trial) {
        const double side = trial % 2 ? 1 : -1, hand = trial % 4 < 2 ? 1 : -1;
        Vec3 toward = draw.unit();
        if (toward.z * side < 0) toward.z = -toward.z;
        MappedTriangle triangle({1, 0, 0}, {0, 1, 0}, from_above(toward));
        const Vec3 mapped = normalize(Vec3(draw.uniform(-0.5, 0.5), draw.uniform(-0.5, 0.5), 1));
        triangle.material().normal_texture.picture = one_texel((mapped + Vec3(1)) / 2.0);
        // Any smooth normals on the front, any tangents.
        triangle.shading.normals.resize(1);
        triangle.shading.tangents.resize(1);
        const Vec3 weights(0.4, 0.3, 0.3);
        Vec3 normal(0), tangent(0);
        for (int k = 0; k < 3; ++k) {
            const auto corner = static_cast<std::size_t>(k);
            const Vec3 n = normalize(Vec3(draw.uniform(-0.4, 0.4), draw.uniform(-0.4, 0.4), 1)),
                       t = normalize(Vec3(1, draw.uniform(-1, 1), draw.uniform(-0.3, 0.3)));
            triangle.shading.normals[0][corner] = n;
            triangle.shading.tangents[0][corner] = Vec4(t, hand);
            normal += weights[k] * n;
            tangent += weights[k] * t;
        }
        normal = normalize(normal);
        tangent = normalize(tangent - dot(tangent, normal) * normal);
        const Vec3 lit = side * normalize(mapped.x * tangent + hand * mapped.y * cross(normal, tangent) +
                                          mapped.z * normal);
        const double seen = triangle.seen({0, 0, side}).x;
        CHECK(seen == Approx(std::max(dot(lit, toward), 0.0)).margin(1e-6));
    }
}

TEST_CASE("occlusion dims light from around, and emission adds to what is reflected", "[shade]") {
    Light ambient;
    ambient.intensity = 0.5;
    MappedTriangle triangle({1, 0, 0}, {0, 1, 0}, ambient);
    triangle.material().base_color_factor = Vec3(0.5);
    CHECK(triangle.seen({0, 0, 1}).x == Approx(0.25));
    triangle.material().occlusion_texture.picture = one_texel({0.4, 1, 1});
    CHECK(triangle.seen({0, 0, 1}).x == Approx(0.1).epsilon(1e-6));
    triangle.material().occlusion_strength = 0.5;
    CHECK(triangle.seen({0, 0, 1}).x == Approx(0.25 * 0.7).epsilon(1e-6));
    triangle.material().emissive_factor = {2, 0, 0};
    triangle.material().emissive_texture.picture = one_texel({0.25, 1, 1});
    CHECK(triangle.seen({0, 0, 1}).x == Approx(0.25 * 0.7 + 0.5).epsilon(1e-6));
    CHECK(triangle.seen({0, 0, 1}).y == Approx(0.25 * 0.7).epsilon(1e-6));

    // A lamp's light is not dimmed.
    MappedTriangle lit({1, 0, 0}, {0, 1, 0}, from_above({0, 0, 1}));
    lit.material().occlusion_texture.picture = one_texel({0, 1, 1});
    CHECK(lit.seen({0, 0, 1}).x == Approx(1));
}

TEST_CASE("a metallic-roughness map is a factor: green of roughness, blue of metallic", "[shade]") {
    const Light lamp = from_above(normalize(Vec3(0.3, 0.1, 1)));
    MappedTriangle mapped({1, 0, 0}, {0, 1, 0}, lamp), plain({1, 0, 0}, {0, 1, 0}, lamp);
    mapped.material().base_color_factor = plain.material().base_color_factor = {0.9, 0.6, 0.2};
    mapped.material().roughness_factor = 0.8;
    mapped.material().metallic_factor = 0.5;
    mapped.material().metallic_roughness_texture.picture = one_texel({0, 0.5, 0.75});
    plain.material().roughness_factor = 0.4;
    plain.material().metallic_factor = 0.375;
    for (int k = 0; k < 3; ++k)
        CHECK(mapped.seen({0, 0, 1})[k] == Approx(plain.seen({0, 0, 1})[k]).epsilon(1e-6));
}

TEST_CASE("the white furnace: light from everywhere leaves matt and polished surfaces as it came",
          "[shade][law]") {
    Light ambient, environment;
    environment.kind = EnvironmentLight{};
    for (const Light& light : {ambient, environment})
        for (const Brdf brdf : {Brdf::kLambert, Brdf::kMetallicRoughness}) {
            MappedTriangle triangle({1, 0, 0}, {0, 1, 0}, light);
            triangle.shading.background.color = Vec3(1);
            prepare_lights(triangle.shading);
            triangle.material().brdf = brdf;
            triangle.material().metallic_factor = 1;
            for (const Vec3& from : {Vec3(0, 0, 1), Vec3(0.6, 0, 0.8), Vec3(0.995, 0, 0.1)}) {
                const Vec3 seen = triangle.seen(from);
                INFO("environment " << std::holds_alternative<EnvironmentLight>(light.kind) << ", BRDF "
                                    << name_of(brdf));
                CHECK(seen.x == Approx(light.intensity).epsilon(brdf == Brdf::kLambert ? 0.02 : 1e-9));
            }
        }
}
