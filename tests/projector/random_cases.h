// Random RayMeshes and scenes of every kind that the projector must draw, at any scale and place.
#pragma once

#include <cmath>
#include <random>
#include <vector>

#include "base/raymesh/ray_mesh.h"
#include "base/raymesh/sample_grid.h"
#include "base/raymesh/triangle_scene.h"

namespace trilens_test {

using namespace trilens;

/// The same draws with every compiler: take each in a statement or a braced list of its own.
struct Random {
    std::mt19937_64 engine;

    explicit Random(std::uint64_t seed) : engine(seed) {}
    double uniform(double low, double high) {
        return low + (high - low) * (static_cast<double>(engine() >> 11) * 0x1p-53);
    }
    double log_uniform(double low, double high) { return std::exp(uniform(std::log(low), std::log(high))); }
    int below(int n) { return static_cast<int>(engine() % static_cast<std::uint64_t>(n)); }
    Vec3 in_cube(double half) { return {uniform(-half, half), uniform(-half, half), uniform(-half, half)}; }
};

/// Where the case lies and how large it is.
struct Frame {
    double scale = 1;
    Vec3 offset{0};

    Vec3 operator()(const Vec3& p) const { return offset + scale * p; }
};

inline Frame random_frame(Random& random) {
    Frame frame;
    frame.scale = random.log_uniform(1e-4, 1e4);
    if (random.below(2) == 0) frame.offset = random.in_cube(frame.scale * random.log_uniform(1, 1e4));
    return frame;
}

enum class Rays { kPinhole, kParallel, kFlatMirror, kCurved, kWild, kCount };
enum class Screen { kAffine, kPerspective, kSliver, kBehind, kCount };

/// The three corners of a facet on the screen, homogeneous.
inline std::vector<Vec3> random_screen(Random& random, const SampleGrid& grid, Screen kind) {
    std::vector<Vec3> screen;
    const double unit = random.log_uniform(1e-4, 1e4);  // of depth
    for (int k = 0; k < 3; ++k) {
        double x = random.uniform(grid.x0 - 4, grid.x1 + 4), y = random.uniform(grid.y0 - 4, grid.y1 + 4);
        if (kind == Screen::kSliver && k == 2) {
            const double at = random.uniform(0, 1), off = random.log_uniform(1e-6, 4);
            x = screen[0].x + at * (screen[1].x - screen[0].x) + off;
            y = screen[0].y + at * (screen[1].y - screen[0].y) - off;
        }
        double w = kind == Screen::kPerspective || kind == Screen::kBehind ? random.uniform(0.5, 2) : 1;
        if (kind == Screen::kBehind && k == 2) w = -w;
        screen.push_back(Vec3(x, y, 1) * w);
    }
    if (kind != Screen::kSliver) {
        for (Vec3& corner : screen) corner *= unit;
    }
    return screen;
}

/// One facet near the frame's origin whose rays go roughly along +z, except the wild.
inline RayMesh random_facet(Random& random, const SampleGrid& grid, const Frame& frame, Rays rays,
                            Screen screen) {
    RayMesh mesh;
    mesh.screen = random_screen(random, grid, screen);
    mesh.facets = {{0, 1, 2}};
    const Vec3 eye = Vec3(0, 0, -3) + random.in_cube(0.5), common(random.in_cube(0.3) + Vec3(0, 0, 1));
    const double length_scale = random.log_uniform(1e-4, 1e4);
    for (int k = 0; k < 3; ++k) {
        const double angle = 2.0943951 * k + random.uniform(-0.5, 0.5);
        Vec3 origin(std::cos(angle), std::sin(angle), random.uniform(-0.2, 0.2));
        Vec3 direction = common;
        if (rays == Rays::kPinhole) {
            direction = origin - eye;
            origin = eye;
        }
        if (rays == Rays::kFlatMirror) {
            origin.z = 0;
            direction = origin - eye;
            direction.z = -direction.z;
        }
        if (rays == Rays::kCurved) direction = Vec3(0, 0, 1) + random.in_cube(0.6);
        if (rays == Rays::kWild) direction = random.in_cube(1);
        mesh.rays.push_back({frame(origin), length_scale * frame.scale * direction});
    }
    return mesh;
}

inline void add_triangle(TriangleScene& scene, const Vec3& a, const Vec3& b, const Vec3& c) {
    const Id first = static_cast<Id>(scene.points.size());
    scene.points.insert(scene.points.end(), {a, b, c});
    scene.triangles.push_back({first, first + 1, first + 2});
    scene.object.push_back(0);
    scene.primitive.push_back(static_cast<Id>(scene.primitive.size()));
}

struct Place {
    Vec3 centre{0};
    double half = 1;
};

/// A triangle with corners in the cube around the place.
inline void add_random_triangle(TriangleScene& scene, Random& random, const Frame& frame,
                                const Place& place) {
    const Vec3 a = place.centre + random.in_cube(place.half);
    const Vec3 b = place.centre + random.in_cube(place.half);
    const Vec3 c = place.centre + random.in_cube(place.half);
    add_triangle(scene, frame(a), frame(b), frame(c));
}

/// Triangles around the frame's origin, of sizes from specks to far larger than the facet.
inline TriangleScene random_triangles(Random& random, const Frame& frame, int count) {
    TriangleScene scene;
    for (int i = 0; i < count; ++i) {
        const double reach = random.log_uniform(0.5, 8), half = reach * random.log_uniform(0.02, 2);
        const Vec3 centre = random.in_cube(reach);
        add_random_triangle(scene, random, frame, {centre, half});
        scene.object.back() = static_cast<Id>(random.below(3));
    }
    return scene;
}

/// Every sample of the grid, given to facet 0, whether or not the facet covers it.
inline FacetSamples all_samples(const SampleGrid& grid) {
    return group_by_facet(std::vector<Id>(grid.size(), 0), 1);
}

}  // namespace trilens_test
