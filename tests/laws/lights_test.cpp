// Pictures lit by areas and environments, on matt and rough surfaces, against a path tracer of its own that
// knows the scene as rectangles and finds light by rays at random.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "laws/agreement.h"
#include "laws/worlds.h"
#include "render/picture/picture.h"
#include "support/draw.h"
#include "support/test.h"

using namespace trilens;
using namespace trilens_test;

namespace {

constexpr double kPi = std::numbers::pi;
constexpr int kLitWidth = 20, kLitHeight = 15;
constexpr double kRoughness = 0.5;

/// A floor with a wall that hides part of a lamp and of the sky; `samples` of each light.
std::unique_ptr<World> lit_room(int samples) {
    const std::string n = std::to_string(samples);
    return world_from("room",
                      R"({"version": 1, "film": {"width": 20, "height": 15},
        "cameras": [{"name": "main", "yfov": 40, "lookAt": {"eye": [0, 3, 5], "at": [0, 0, 0], "up": [0, 1, 0]}}],
        "background": {"color": [0.3, 0.4, 0.6]},
        "materials": [{"name": "floor", "baseColorFactor": [0.7, 0.5, 0.3], "metallicFactor": 0.5,
                       "roughnessFactor": 0.5},
                      {"name": "wall", "baseColorFactor": [0.6, 0.6, 0.6]}],
        "lights": [{"type": "rectangle", "position": [-2, 2.5, -1], "direction": [2, -2.5, 1], "size": [1.5, 1],
                    "intensity": 6, "shadows": true, "visible": false, "samples": )" +
                          n + R"(},
                   {"type": "environment", "shadows": true, "samples": )" +
                          n + R"(}],
        "meshes": [{"name": "floor", "role": "object", "material": "floor",
                    "points": [[-40, 0, 40], [40, 0, 40], [40, 0, -40], [-40, 0, -40]],
                    "faceVertexCounts": [4], "faceVertexIndices": [0, 1, 2, 3]},
                   {"name": "wall", "role": "object", "material": "wall",
                    "points": [[-0.5, 0, 1], [-0.5, 0, -1], [-0.5, 1, -1], [-0.5, 1, 1]],
                    "faceVertexCounts": [4], "faceVertexIndices": [0, 1, 2, 3]}]})",
                      8);
}

/// Distance along a ray to a rectangle about `middle` with these half sides; 0: it misses.
double meet(const Ray& ray, const Vec3& middle, const Vec3& a, const Vec3& b) {
    const Vec3 normal = cross(a, b);
    const double t = dot(middle - ray.origin, normal) / dot(ray.direction, normal);
    const Vec3 off = ray.origin + t * ray.direction - middle;
    const bool inside = std::fabs(dot(off, a)) < dot(a, a) && std::fabs(dot(off, b)) < dot(b, b);
    return t > 1e-6 && inside ? t : 0;
}

double to_wall(const Ray& ray) {
    return meet(ray, {-0.5, 0.5, 0}, {0, 0.5, 0}, {0, 0, 1});
}

/// Light along a ray that leaves a surface.
Vec3 seen_light(const Ray& ray) {
    if (to_wall(ray) > 0) return Vec3(0);  // what it reflects is not followed
    const Vec3 shines = normalize(Vec3(2, -2.5, 1)), up = normalize(Vec3(0, 1, 0) - shines.y * shines);
    const double lamp = meet(ray, {-2, 2.5, -1}, 0.75 * cross(up, shines), 0.5 * up);
    if (lamp > 0) return dot(ray.direction, shines) < 0 ? Vec3(6) : Vec3(0.3, 0.4, 0.6);
    return ray.direction.y > 0 ? Vec3(0.3, 0.4, 0.6) : Vec3(0);
}

/// The floor's BRDF: half metal, half dielectric, by appendix B of glTF.
Vec3 floor_brdf(const Vec3& view, const Vec3& light) {
    const Vec3 base(0.7, 0.5, 0.3), half = normalize(view + light);
    const double a2 = std::pow(kRoughness, 4);
    const auto g1 = [&](double c) { return 2 * c / (c + std::sqrt(a2 + (1 - a2) * c * c)); };
    const double specular = a2 / (kPi * std::pow(half.y * half.y * (a2 - 1) + 1, 2)) * g1(light.y) *
                            g1(view.y) / (4 * light.y * view.y);
    const double p = std::pow(1 - dot(view, half), 5), f = 0.04 + 0.96 * p;
    return 0.5 * ((1 - f) * base / kPi + Vec3(f * specular)) + 0.5 * specular * (base + (Vec3(1) - base) * p);
}

/// The light that a camera's ray sees, by `count` rays on from there.
Vec3 path_traced(const Ray& ray, int count, Draw& draw) {
    const double down = -ray.origin.y / ray.direction.y, wall = to_wall(ray);
    const bool on_wall = wall > 0 && wall < down;
    const Vec3 at = ray.origin + (on_wall ? wall : down) * ray.direction;
    const Vec3 normal = on_wall ? Vec3(ray.direction.x > 0 ? -1 : 1, 0, 0) : Vec3(0, 1, 0);
    Vec3 sum(0);
    for (int k = 0; k < count; ++k) {
        const Vec3 toward = normalize(normal + draw.unit());  // in proportion to the cosine
        const Ray on{at + 1e-9 * normal, toward};
        const Vec3 light = on_wall && toward.y < 0 ? Vec3(0) : seen_light(on);
        sum += light * (on_wall ? Vec3(0.6) : kPi * floor_brdf(-ray.direction, toward));
    }
    return sum / double(count);
}

/// Of every pixel's middle.
std::vector<Vec3> reference() {
    Draw draw(77);
    std::vector<Vec3> picture;
    const Vec3 eye(0, 3, 5), ahead = normalize(-eye), right(1, 0, 0), up = cross(right, ahead);
    const double half = std::tan(20 * kPi / 180);
    for (int y = 0; y < kLitHeight; ++y)
        for (int x = 0; x < kLitWidth; ++x) {
            const double dx = (2 * (x + 0.5) / kLitWidth - 1) * half * kLitWidth / kLitHeight,
                         dy = (1 - 2 * (y + 0.5) / kLitHeight) * half;
            picture.push_back(path_traced({eye, normalize(ahead + dx * right + dy * up)}, 20000, draw));
        }
    return picture;
}

double rms_off(const Image& image, const std::vector<Vec3>& truth) {
    double sum = 0;
    const std::array<const char*, 3> names{"R", "G", "B"};
    for (int k = 0; k < 3; ++k) {
        const std::vector<float>& values = image.find(names[static_cast<std::size_t>(k)])->floats();
        for (std::size_t i = 0; i < truth.size(); ++i) {
            const double off = double{values[i]} / truth[i][k] - 1;
            sum += off * off / (3.0 * static_cast<double>(truth.size()));
        }
    }
    return std::sqrt(sum);
}

}  // namespace

TEST_CASE("soft shadows, the sky's light and rough reflections converge to a path tracer's",
          "[laws][law][oracle][thorough]") {
    const std::vector<Vec3> truth = reference();
    double before = 1;
    struct Limit {
        int samples;
        double off;
    };
    for (const Limit& limit : {Limit{16, 0.10}, {64, 0.05}, {1024, 0.025}}) {
        const std::unique_ptr<World> world = lit_room(limit.samples);
        PictureRequest request;
        request.engine = {Engine::kLimitTruth};
        const double traced = rms_off(draw_picture(*world, request, {}, ignore, nullptr).image, truth);
        request.engine = {Engine::kExact};
        const double projected = rms_off(draw_picture(*world, request, {}, ignore, nullptr).image, truth);
        INFO(limit.samples << " samples: traced " << traced << ", projected " << projected);
        CHECK(traced < limit.off);
        CHECK(traced < before);
        CHECK(projected == Approx(traced).epsilon(1e-3));
        before = traced;
    }
}
