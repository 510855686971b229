// Normal maps on optics: truth against mirrored rays by hand, facets against truth as they become finer,
// projector against rays of the same facets.
#include <cmath>
#include <string>

#include "laws/worlds.h"
#include "render/picture/picture.h"
#include "support/test.h"

using namespace trilens;
using namespace trilens_test;

namespace {

/// A mirror in the plane z = 0, 4 wide and high, seen from z = 3 before a wall at z = 6.
std::unique_ptr<World> mapped_mirror(const std::string& map, int n) {
    return world_from("mapped mirror",
                      R"({"version": 1, "film": {"width": 40, "height": 30},
        "cameras": [{"name": "main", "yfov": 40,
                     "lookAt": {"eye": [0.2, 0.1, 3], "at": [0, 0, 0], "up": [0, 1, 0]}}],
        "materials": [{"name": "chrome", "metallicFactor": 1, "normalTexture": )" +
                          map + R"(}, {"name": "wall", "unlit": true}],
        "meshes": [{"name": "mirror", "role": "optic", "material": "chrome", "primitive":
                      {"type": "plane", "normal": [0, 0, 1], "tangent": [1, 0, 0], "size": [4, 4]}},
                   {"name": "wall", "role": "object", "material": "wall", "primitive": {"type": "plane",
                     "center": [0, 0, 6], "normal": [0, 0, -1], "tangent": [1, 0, 0], "size": [400, 400]}}]})",
                      n);
}

Image drawn(const World& world, const EngineChoice& engine) {
    PictureRequest request;
    request.engine = engine;
    return draw_picture(world, request, {}, ignore, nullptr).image;
}

Vec3 seen_at(const Image& image, std::size_t pixel) {
    Vec3 at;
    for (int k = 0; k < 3; ++k)
        at[k] = double{image.find(std::string("reflectP.") + "XYZ"[k])->floats()[pixel]};
    return at;
}

double mean_distance(const Image& a, const Image& b) {
    const std::size_t pixels = a.find("G")->floats().size();
    double sum = 0;
    for (std::size_t p = 0; p < pixels; ++p) sum += length(seen_at(a, p) - seen_at(b, p));
    return sum / static_cast<double>(pixels);
}

/// Waves across and down, eight over the mirror, as the pattern is defined.
const char* const kRipples = R"({"pattern": "ripples", "count": [8, 8], "heights": true, "scale": 4})";

}  // namespace

TEST_CASE("a mirrored sphere with a normal map is the sphere's mirror image", "[laws][law]") {
    const auto picture_of = [](double scale) {
        const auto world = world_from("mirrored sphere",
                                      R"({"version": 1, "film": {"width": 40, "height": 30},
        "cameras": [{"yfov": 40, "lookAt": {"eye": [0, 0.1, 3], "at": [0, 0, 0], "up": [0, 1, 0]}}],
        "materials": [{"name": "chrome", "metallicFactor": 1, "normalTexture": {"pattern": "ripples",
                        "count": [3, 2], "heights": true, "scale": 1, "transform": {"offset": [0.07, 0]}}},
                      {"name": "wall", "unlit": true, "baseColorFactor": [0.2, 0.9, 0.4]}],
        "meshes": [{"name": "ball", "role": "optic", "material": "chrome", "primitive": {"type": "sphere"},
                    "transform": {"scale": [)" +
                                          std::to_string(scale) +
                                          R"(, 1, 1]}},
                   {"name": "wall", "role": "object", "material": "wall", "primitive": {"type": "plane",
                     "center": [0, 0, 6], "normal": [0, 0, -1], "tangent": [1, 0, 0], "size": [4000, 4000]}}]})",
                                      8);
        return drawn(*world, Engine::kExact);
    };
    const Image one = picture_of(1), other = picture_of(-1);
    std::size_t differ = 0, lopsided = 0;
    for (std::size_t y = 0; y < 30; ++y)
        for (std::size_t x = 0; x < 40; ++x) {
            const Vec3 seen = seen_at(one, 40 * y + x), as_mirrored = seen_at(other, 40 * y + 39 - x),
                       beside = seen_at(one, 40 * y + 39 - x);
            if (seen == Vec3(0)) continue;  // not in the ball
            differ += length(seen - Vec3(-as_mirrored.x, as_mirrored.y, as_mirrored.z)) > 1e-4 * length(seen);
            lopsided += length(seen - Vec3(-beside.x, beside.y, beside.z)) > 0.1;
        }
    CHECK(differ == 0);
    CHECK(lopsided > 10);
}

TEST_CASE("a rippled mirror shows what rays mirrored at its waves' slopes meet", "[laws][law]") {
    const auto world = mapped_mirror(kRipples, 8);
    const Image truth = drawn(*world, Engine::kLimitTruth);
    // Heights (2 + cos + cos) / 4 of 128 texels a wave, times 4.
    const double turn = 2 * 3.14159265358979 * 8 / 4, texel = 4.0 / 1024;
    double worst = 0;
    for (int y = 0; y < 30; ++y)
        for (int x = 0; x < 40; ++x) {
            const Vec3 eye(0.2, 0.1, 3), ahead = normalize(-eye),
                                         right = normalize(cross(ahead, Vec3(0, 1, 0))),
                                         up = cross(right, ahead);
            const double half = std::tan(20 * 3.14159265358979 / 180);
            const Vec3 way =
                ahead + half * ((x + 0.5) / 15 - 40.0 / 30) * right + half * (1 - (y + 0.5) / 15) * up;
            const Vec3 at = eye - eye.z / way.z * way;
            const double du = -texel * turn * std::sin(turn * (at.x + 2)),
                         dv = -texel * turn * std::sin(turn * (at.y + 2));
            const Vec3 normal = normalize(Vec3(-du, -dv, 1));
            const Vec3 mirrored = way - 2 * dot(way, normal) * normal;
            const Vec3 expected = at + 6 / mirrored.z * mirrored;
            worst = std::max(worst, length(seen_at(truth, static_cast<std::size_t>(40 * y + x)) - expected));
        }
    INFO("worst " << worst);
    CHECK(worst < 0.01);  // the picture's slopes are straight between its texels
}

TEST_CASE("facets take ripples the better the finer they are, and are divided for them", "[laws][law]") {
    const auto world = mapped_mirror(kRipples, 8);
    const Image truth = drawn(*world, Engine::kLimitTruth);
    PictureRequest request;
    const auto off = [&](int n, double max_error) {
        request.frame.resolution = n;
        request.frame.max_error = max_error;
        return mean_distance(draw_picture(*world, request, {}, ignore, nullptr).image, truth);
    };
    const double coarse = off(16, kAnyError), middle = off(64, kAnyError), fine = off(256, kAnyError);
    const double divided = off(16, 0.5);
    INFO("n 16 " << coarse << ", 64 " << middle << ", 256 " << fine << ", divided " << divided);
    CHECK(middle < coarse / 8);
    CHECK(fine < middle / 8);
    CHECK(divided < coarse / 100);
    // The same rays traced.
    request.frame.max_error = kAnyError;
    request.frame.resolution = 64;
    const Image projected = draw_picture(*world, request, {}, ignore, nullptr).image;
    request.engine = Engine::kFacetsTruth;
    const Image traced = draw_picture(*world, request, {}, ignore, nullptr).image;
    CHECK(projected.find("reflectID.object")->ids() == traced.find("reflectID.object")->ids());
    CHECK(mean_distance(projected, traced) < 1e-5);
}

TEST_CASE(
    "a mirror's tangents turn its normal map: those of its uv change nothing, a left hand turns v about",
    "[laws][law]") {
    const auto world = world_from("tangents",
                                  std::string(R"({"version": 1,
        "cameras": [{"name": "main", "yfov": 40, "lookAt": {"eye": [0, 0, 3], "at": [0, 0, 0]}}],
        "materials": [{"name": "chrome", "metallicFactor": 1, "normalTexture": )") +
                                      kRipples + R"(}],
        "meshes": [{"name": "mirror", "role": "optic", "material": "chrome", "subdivisionScheme": "none",
                    "points": [[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]],
                    "faceVertexCounts": [4], "faceVertexIndices": [0, 1, 2, 3],
                    "uvs": [[0, 0], [1, 0], [1, 1], [0, 1]]}]})",
                                  1);
    const auto normals_with = [&](const Vec4& tangent) {
        Scene scene = world->scene;
        if (tangent != Vec4(0)) scene.meshes[0].cage_tangents.assign(6, tangent);
        const auto surface = make_optic_surface(scene, 0, ignore);
        std::vector<Vec3> normals;
        for (int k = 0; k < 40; ++k)
            normals.push_back(surface->eval(static_cast<Id>(k % 2), {0.02 * k, 0.01 * (k % 7)}).normal);
        return normals;
    };
    const std::vector<Vec3> plain = normals_with(Vec4(0)), right = normals_with({1, 0, 0, 1}),
                            left = normals_with({1, 0, 0, -1}), turned = normals_with({0, 1, 0, 1});
    double tilt = 0;
    for (std::size_t k = 0; k < plain.size(); ++k) {
        const Vec3& n = plain[k];
        tilt = std::max(tilt, std::fabs(n.y));
        CHECK(length(right[k] - n) < 1e-12);
        CHECK(length(left[k] - Vec3(n.x, -n.y, n.z)) < 1e-12);
        CHECK(length(turned[k] - Vec3(-n.y, n.x, n.z)) < 1e-12);
    }
    CHECK(tilt > 0.01);
}
