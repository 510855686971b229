#include "little_room.h"

#include <cmath>

#include "base/raymesh/rasterize.h"
#include "projector/projector.h"

namespace trilens::browser {
namespace {

constexpr int kShadowPixels = 768;
constexpr double kShadowSpan = 13;  // of the sun's film, scene units
const Vec3 kSun = normalize(Vec3(-0.55, 0.8, 0.5));
constexpr double kFloor = 9;  // half its side

/// Collects triangles object by object.
struct Builder {
    LittleRoom& room;

    Id point(const Vec3& at, const Vec3& normal = Vec3(0)) {
        room.scene.points.push_back(at);
        room.normal.push_back(normal);
        return static_cast<Id>(room.scene.points.size() - 1);
    }
    void triangle(const IdTriple& corners) {
        const Id object = static_cast<Id>(room.colour.size() - 1);
        room.scene.primitive.push_back(!room.scene.object.empty() && room.scene.object.back() == object
                                           ? room.scene.primitive.back() + 1
                                           : 0);
        room.scene.object.push_back(object);
        room.scene.triangles.push_back(corners);
    }
    void quad(const std::array<Vec3, 4>& corners) {
        const std::array<Id, 4> ids{point(corners[0]), point(corners[1]), point(corners[2]),
                                    point(corners[3])};
        triangle({ids[0], ids[1], ids[2]});
        triangle({ids[0], ids[2], ids[3]});
    }
    void begin(const Vec3& colour) { room.colour.push_back(colour); }

    void box(const Vec3& low, const Vec3& high) {
        const auto corner = [&](int k) {
            return Vec3(k & 1 ? high.x : low.x, k & 2 ? high.y : low.y, k & 4 ? high.z : low.z);
        };
        for (const std::array<int, 4>& side :
             {std::array{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 4, 6, 2}, {1, 3, 7, 5}, {2, 6, 7, 3}, {0, 1, 5, 4}})
            quad({corner(side[0]), corner(side[1]), corner(side[2]), corner(side[3])});
    }
    /// A body of revolution about the vertical through `foot`: radii and heights from below.
    void turned(const Vec3& foot, const std::vector<Vec2>& profile, bool smooth) {
        constexpr int kSides = 40;
        for (std::size_t j = 0; j + 1 < profile.size(); ++j)
            for (int i = 0; i < kSides; ++i) {
                std::array<Id, 4> ids;
                for (int k = 0; k < 4; ++k) {
                    const double angle = 2 * 3.14159265358979323846 * (i + (k == 1 || k == 2)) / kSides;
                    const std::size_t row = j + (k >= 2);
                    const Vec2 along = profile[std::min(row + 1, profile.size() - 1)] -
                                       profile[row > 0 && smooth ? row - 1 : (smooth ? row : j)];
                    const Vec2 slope = smooth ? along : profile[j + 1] - profile[j];
                    const Vec3 out(std::cos(angle), 0, std::sin(angle));
                    ids[static_cast<std::size_t>(k)] =
                        point(foot + profile[row].x * out + Vec3(0, profile[row].y, 0),
                              normalize_or_zero(slope.y * out - Vec3(0, slope.x, 0)));
                }
                triangle({ids[0], ids[2], ids[1]});
                triangle({ids[0], ids[3], ids[2]});
            }
    }
};

std::vector<Vec2> ball_profile(double radius) {
    std::vector<Vec2> profile;
    for (int j = 0; j <= 24; ++j) {
        const double angle = 3.14159265358979323846 * j / 24;
        profile.push_back({radius * std::sin(angle), radius * (1 - std::cos(angle))});
    }
    return profile;
}

/// How much of the sun comes to a point: the four pixels of its shadow map around it, mixed.
double sun_at(const LittleRoom& room, const Vec3& point, const Vec3& normal) {
    const Vec3 screen = screen_from_world(room.sun, point + 0.02 * normal);
    const double x = screen.x - 0.5, y = screen.y - 0.5, left = std::floor(x), top = std::floor(y);
    const double depth = dot(point + 0.02 * normal - room.sun.eye, -kSun);
    double lit = 0;
    for (int k = 0; k < 4; ++k) {
        const int i = static_cast<int>(left) + (k & 1), j = static_cast<int>(top) + (k >> 1);
        const double share = (k & 1 ? x - left : 1 - x + left) * (k >> 1 ? y - top : 1 - y + top);
        if (i < 0 || j < 0 || i >= kShadowPixels || j >= kShadowPixels ||
            double{room.lit[static_cast<std::size_t>(j * kShadowPixels + i)].t_high} > depth - 0.02)
            lit += share;
    }
    return lit;
}

}  // namespace

LittleRoom make_room() {
    LittleRoom room;
    Builder build{room};
    build.begin({0.62, 0.60, 0.56});
    build.quad({Vec3(-kFloor, 0, -kFloor), Vec3(-kFloor, 0, kFloor), Vec3(kFloor, 0, kFloor),
                Vec3(kFloor, 0, -kFloor)});
    build.begin({0.75, 0.11, 0.08});
    build.box({-2.9, 0, 1.1}, {-2.1, 0.8, 1.9});
    build.begin({0.90, 0.62, 0.10});
    build.turned({0.7, 0, 2.1}, ball_profile(0.55), true);
    build.begin({0.10, 0.26, 0.62});
    build.turned({2.6, 0, 1.2}, {{0, 0}, {0.6, 0}, {0.03, 1.7}, {0, 1.72}}, false);
    build.begin({0.12, 0.45, 0.16});
    build.turned({-1.1, 0, 3.3}, {{0, 0}, {0.32, 0}, {0.32, 1.5}, {0, 1.5}}, false);
    build.begin({0.16, 0.13, 0.11});  // the mirror's foot
    build.turned({0, 0, 0}, {{0, 0}, {0.6, 0}, {0.6, 0.07}, {0.09, 0.12}, {0.09, 0.3}, {0, 0.3}}, false);
    for (const IdTriple& corner : room.scene.triangles) {
        const auto at = [&](int k) { return room.scene.points[corner[static_cast<std::size_t>(k)]]; };
        const Vec3 normal = normalize_or_zero(cross(at(1) - at(0), at(2) - at(0)));
        room.flat.push_back(room.normal[corner[0]] == Vec3(0) ? normal : Vec3(0));
    }
    room.ready = std::make_unique<PreparedScene>(room.scene);

    OrthographicParams sun;
    sun.look_at = {20.0 * kSun, Vec3(0), Vec3(0, 1, 0)};
    sun.world_height = kShadowSpan;
    sun.width = sun.height = kShadowPixels;
    room.sun = make_orthographic(sun);
    const SampleGrid film{0, 0, kShadowPixels, kShadowPixels, 1};
    const RayMesh rays = make_camera_mesh(room.sun, kShadowPixels, kShadowPixels);
    room.lit.resize(film.size());
    find_visible(*room.ready, rays, rasterize_facets(rays, film), film, room.lit);
    return room;
}

Vec3 sky(const Vec3& direction) {
    const Vec3 unit = normalize_or_zero(direction);
    const double up = std::max(0.0, unit.y), glow = std::max(0.0, dot(unit, kSun));
    const Vec3 horizon(0.72, 0.80, 0.88), zenith(0.16, 0.36, 0.72);
    const double second = glow * glow, fourth = second * second, eighth = fourth * fourth,
                 sixteenth = eighth * eighth, fortieth = sixteenth * sixteenth * eighth;
    return horizon + (zenith - horizon) * std::sqrt(up) + fortieth * Vec3(0.35, 0.3, 0.2);
}

Vec3 light_of(const LittleRoom& room, const Hit& hit) {
    const IdTriple& corner = room.scene.triangles[hit.triangle];
    const Vec3 at = position(room.scene, hit);
    Vec3 normal = room.flat[hit.triangle];
    if (normal == Vec3(0))
        normal = normalize_or_zero((1 - hit.barycentric.x - hit.barycentric.y) * room.normal[corner[0]] +
                                   hit.barycentric.x * room.normal[corner[1]] +
                                   hit.barycentric.y * room.normal[corner[2]]);

    const Id object = room.scene.object[hit.triangle];
    Vec3 colour = room.colour[object];
    if (object == 0) {
        // The floor: squares of one unit, and a haze towards its rim.
        const bool dark = (static_cast<int>(std::floor(at.x)) + static_cast<int>(std::floor(at.z))) & 1;
        if (dark) colour *= 0.22;
        const double far = std::clamp(length(Vec2(at.x, at.z)) / kFloor, 0.0, 1.0);
        colour += (Vec3(0.5, 0.52, 0.54) - colour) * far * far;
    }
    const double cosine = dot(normal, kSun);
    const double sun = cosine > 0 ? cosine * sun_at(room, at, normal) : 0;
    return colour * (Vec3(1.05, 1.0, 0.9) * sun + Vec3(0.30, 0.36, 0.44) * (0.65 + 0.35 * normal.y));
}

}  // namespace trilens::browser
