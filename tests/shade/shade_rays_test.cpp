// Many rays shaded together against the same rays shaded one by one.
#include <cmath>
#include <memory>
#include <random>

#include "shade/shade.h"
#include "support/test.h"

using namespace trilens;

namespace {

struct Random {
    std::mt19937 engine;
    double uniform(double low, double high) {
        return std::uniform_real_distribution<double>(low, high)(engine);
    }
    std::size_t below(std::size_t count) { return engine() % count; }
    Vec3 in_box(double half) { return {uniform(-half, half), uniform(-half, half), uniform(-half, half)}; }
    Vec3 unit() { return normalize(in_box(1) + Vec3(1e-9)); }
};

TriangleScene any_triangles(Random& random, double size) {
    TriangleScene scene;
    for (Id t = 0; t < 12; ++t) {
        for (int k = 0; k < 3; ++k) scene.points.push_back(random.in_box(size));
        if (t == 3) scene.points.back() = scene.points[scene.points.size() - 2];  // without area
        scene.triangles.push_back({3 * t, 3 * t + 1, 3 * t + 2});
        scene.object.push_back(0);
        scene.primitive.push_back(t);
    }
    return scene;
}

LightKind any_kind(Random& random, double size) {
    const Vec3 position = random.in_box(2 * size), direction = random.unit();
    const int samples = 1 + static_cast<int>(random.below(9));
    switch (random.below(8)) {
        case 0:
            return PointLight{position};
        case 1:
            return DirectionalLight{direction, random.below(2) ? random.uniform(0, 90) : 0, samples};
        case 2:
            return SpotLight{position, direction, random.uniform(0, 30), random.uniform(31, 90)};
        case 3:
            return RectangleLight{position, direction, Vec2(size, 2 * size), random.unit(), samples};
        case 4:
            return DiskLight{position, direction, random.uniform(0, size), samples};
        case 5:
            return SphereLight{position, random.uniform(0, size), samples};
        case 6:
            return EnvironmentLight{samples};
        default:
            return AmbientLight{random.uniform(0, size), samples};
    }
}

Light any_light(Random& random, double size) {
    Light light;
    light.color = {random.uniform(0, 1), random.uniform(0, 1), random.uniform(0, 1)};
    light.intensity = random.uniform(0, 10);
    light.kind = any_kind(random, size);
    light.shadows = random.below(3) > 0;
    return light;
}

ShadeScene any_scene(Random& random, const TriangleScene& triangles, double size) {
    ShadeScene shading;
    shading.triangles = &triangles;
    shading.size = size;
    auto texture = std::make_shared<Texture>();
    texture->width = 5, texture->height = 3;
    for (int i = 0; i < 45; ++i) texture->rgb.push_back(static_cast<float>(random.uniform(0, 1)));
    for (int m = 0; m < 4; ++m) {
        Material material;
        material.base_color_factor = {random.uniform(0, 1), random.uniform(0, 1), random.uniform(0, 1)};
        if (m % 2) material.base_color_texture = texture;
        material.unlit = m == 3;
        shading.materials.push_back(material);
    }
    for (std::size_t t = 0; t < triangles.size(); ++t)
        shading.material.push_back(static_cast<Id>(random.below(4)));
    shading.uvs.resize(random.below(13));
    for (auto& corners : shading.uvs)
        for (Vec2& uv : corners) uv = {random.uniform(-3, 3), random.uniform(-1e6, 1e6)};
    shading.normals.resize(random.below(13));
    for (auto& corners : shading.normals)
        for (Vec3& normal : corners) normal = random.below(9) ? random.unit() : Vec3(0);
    for (std::size_t l = random.below(5); l > 0; --l) shading.lights.push_back(any_light(random, size));
    shading.background.color = random.in_box(1) + Vec3(1);
    prepare_lights(shading);
    if (random.below(4) > 0)
        shading.occluded = [](const Segments& segments) {
            Segments::Bits hidden = 0;
            for (std::size_t i = 0; i < segments.count; ++i) {
                const auto [from, way] = segments.ray(i);
                if (std::sin(1e3 * (from.x + from.y + way.z)) > 0.3) hidden |= Segments::bit(i);
            }
            return hidden;
        };
    return shading;
}

bool same(const Vec3& a, const Vec3& b) {
    for (int k = 0; k < 3; ++k)
        if (!(a[k] == b[k] || (std::isnan(a[k]) && std::isnan(b[k])))) return false;
    return true;
}

}  // namespace

TEST_CASE("rays shaded together have the colours that they have alone", "[shade][oracle]") {
    Random random{std::mt19937(8)};
    int lit = 0, background = 0;
    for (int trial = 0; trial < 400; ++trial) {
        const double size = std::pow(10, random.uniform(-4, 4));
        const TriangleScene triangles = any_triangles(random, size);
        const ShadeScene shading = any_scene(random, triangles, size);
        std::vector<Hit> hits(random.below(100));
        std::vector<Ray> rays(hits.size());
        std::vector<SeenAlong> seen;
        for (std::size_t i = 0; i < hits.size(); ++i) {
            rays[i] = {random.in_box(size), random.below(20) ? random.in_box(size) : Vec3(0)};
            hits[i].barycentric = {random.uniform(0, 0.5), random.uniform(0, 0.5)};
            if (random.below(10)) hits[i].triangle = static_cast<Id>(random.below(triangles.size()));
            seen.push_back({&hits[i], &rays[i]});
        }
        std::vector<Vec3> light(hits.size());
        shade_rays(shading, seen, light);
        for (std::size_t i = 0; i < hits.size(); ++i) {
            const Vec3 alone = hits[i].seen() ? shade_hit(shading, hits[i], rays[i])
                                              : shade_background(shading.background, rays[i].direction);
            CHECK(same(light[i], alone));
            lit += hits[i].seen() && alone.x > 0;
            background += !hits[i].seen();
        }
    }
    CHECK(lit > 3000);
    CHECK(background > 500);
}
