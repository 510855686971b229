// Laws of shading: Lambert, two-sidedness, look-ups, the metal's and the medium's reflectance.
#include "shade/shade.h"

#include <cmath>

#include "shade/texture_filter.h"
#include "support/test.h"

using namespace trilens;

namespace {

/// One triangle in z = 0 around the origin, facing +z.
TriangleScene one_triangle() {
    TriangleScene scene;
    scene.points = {{-1, -1, 0}, {1, -1, 0}, {0, 1, 0}};
    scene.triangles = {{0, 1, 2}};
    scene.object = {0};
    scene.primitive = {0};
    return scene;
}

Hit middle() {
    return {0, 1.0, Vec2(0.25, 0.5)};
}

ShadeScene lit_by(const TriangleScene& triangles, const Light& light) {
    ShadeScene shading;
    shading.triangles = &triangles;
    shading.material = {0};
    Material grey;
    grey.base_color_factor = Vec3(0.5);
    shading.materials = {grey};
    shading.lights = {light};
    return shading;
}

}  // namespace

TEST_CASE("a diffuse surface follows Lambert's cosine law from both sides", "[shade]") {
    const TriangleScene triangles = one_triangle();
    for (double angle = 0; angle < 1.5; angle += 0.1) {
        Light light;
        light.intensity = 3;
        light.kind = DirectionalLight{.direction = Vec3(std::sin(angle), 0, -std::cos(angle))};
        const ShadeScene shading = lit_by(triangles, light);
        const Vec3 front = shade_hit(shading, middle(), {Vec3(0, 0, 1), Vec3(0, 0, -1)});
        CHECK(front.x == Approx(0.5 * 3 * std::cos(angle) / 3.14159265358979).epsilon(1e-12));
        const Vec3 back = shade_hit(shading, middle(), {Vec3(0, 0, -1), Vec3(0, 0, 1)});
        CHECK(back == Vec3(0));
    }
}

TEST_CASE("a point light falls off with the square of the distance", "[shade]") {
    const TriangleScene triangles = one_triangle();
    Light light;
    light.intensity = 10;
    light.kind = PointLight{Vec3(0, 0, 2)};
    const double near = shade_hit(lit_by(triangles, light), middle(), {Vec3(0, 0, 1), Vec3(0, 0, -1)}).x;
    light.kind = PointLight{Vec3(0, 0, 4)};
    const double far = shade_hit(lit_by(triangles, light), middle(), {Vec3(0, 0, 1), Vec3(0, 0, -1)}).x;
    CHECK(near == Approx(4 * far).epsilon(1e-12));
    CHECK(near > 0);
}

TEST_CASE("a shadow removes exactly the light that it hides", "[shade]") {
    const TriangleScene triangles = one_triangle();
    Light light;
    light.kind = DirectionalLight{.direction = Vec3(0, 0, -1)};
    light.shadows = true;
    ShadeScene shading = lit_by(triangles, light);
    Light ambient;
    ambient.color = Vec3(0.25);
    shading.lights.push_back(ambient);
    bool hidden = false;
    shading.occluded = [&](const Segments& segments) {
        CHECK(segments.ray(0).origin.z > 0);
        CHECK(segments.ray(0).direction.z > 0);
        return hidden ? segments.all() : 0;
    };
    const double lit = shade_hit(shading, middle(), {Vec3(0, 0, 1), Vec3(0, 0, -1)}).x;
    hidden = true;
    const double dark = shade_hit(shading, middle(), {Vec3(0, 0, 1), Vec3(0, 0, -1)}).x;
    CHECK(dark == Approx(0.5 * 0.25));
    CHECK(lit - dark == Approx(0.5 / 3.14159265358979));
}

TEST_CASE("texture look-up returns texels at their centres, repeats, and has v upward", "[shade]") {
    Texture texture;
    texture.width = 2;
    texture.height = 2;
    texture.rgb = {1, 0, 0, 0, 1, 0, 0, 0, 1, 1, 1, 1};  // top row red, green; bottom row blue, white
    CHECK(lookup(texture, {}, {0.25, 0.75}) == Vec3(1, 0, 0));
    CHECK(lookup(texture, {}, {0.75, 0.75}) == Vec3(0, 1, 0));
    CHECK(lookup(texture, {}, {0.25, 0.25}) == Vec3(0, 0, 1));
    CHECK(lookup(texture, {}, {1.75, -0.75}) == Vec3(1, 1, 1));
    CHECK(lookup(texture, {}, {0.5, 0.75}) == Vec3(0.5, 0.5, 0));
}

TEST_CASE("a latitude-longitude picture has -Z in its middle and +X to the right", "[shade]") {
    Texture sky;
    sky.width = 4;
    sky.height = 2;
    sky.rgb.assign(24, 0.0f);
    auto set = [&](int x, int y, float r) { sky.rgb[static_cast<std::size_t>(3 * (4 * y + x))] = r; };
    for (int x = 0; x < 4; ++x)
        for (int y = 0; y < 2; ++y) set(x, y, static_cast<float>(x + 10 * y));
    CHECK(lookup_latitude_longitude(sky, {0, 1, -1e-9}).x == Approx(1.5).margin(1e-6));
    CHECK(lookup_latitude_longitude(sky, {0, -1, -1e-9}).x == Approx(11.5).margin(1e-6));
    CHECK(lookup_latitude_longitude(sky, {1, 0, 0}).x == Approx(7.5).margin(1e-6));

    Background background;
    background.environment = std::make_shared<Texture>(sky);
    background.rotate_cos = 0;
    background.rotate_sin = 1;
    const Vec3 turned = shade_background(background, {1, 0, 0});
    CHECK(turned.x == Approx(lookup_latitude_longitude(sky, {0, 0, 1}).x));
}

TEST_CASE("metal is its own colour head-on and white at grazing", "[shade]") {
    const Vec3 gold(1.0, 0.7, 0.3);
    CHECK(metal_reflectance(gold, 1) == gold);
    CHECK(metal_reflectance(gold, 0) == Vec3(1));
    CHECK(metal_reflectance(gold, 0.5).y > 0.7);
}

TEST_CASE("absorption multiplies along the path", "[shade]") {
    Material green;
    green.attenuation_color = Vec3(0.5, 0.9, 0.25);
    green.attenuation_distance = 2;
    CHECK(volume_transmittance(green, 2).x == Approx(0.5));
    const Vec3 twice = volume_transmittance(green, 3) * volume_transmittance(green, 4);
    CHECK(twice.z == Approx(volume_transmittance(green, 7).z));
    CHECK(volume_transmittance(Material{}, 100) == Vec3(1));
}
