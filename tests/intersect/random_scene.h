// Random triangles and rays for the tests of truth: fixed seeds, any scale.
#pragma once

#include <cmath>
#include <cstdint>
#include <random>

#include "base/raymesh/ray_mesh.h"
#include "base/raymesh/triangle_scene.h"

namespace trilens_test {

/// Random numbers that are the same with every standard library.
class Random {
  public:
    explicit Random(std::uint64_t seed) : engine_(seed) {}

    double uniform(double low, double high) {
        return low + (high - low) * (static_cast<double>(engine_() >> 11) * 0x1p-53);
    }
    double log_uniform(double low, double high) { return std::exp(uniform(std::log(low), std::log(high))); }
    std::size_t below(std::size_t count) { return static_cast<std::size_t>(engine_() % count); }
    trilens::Vec3 in_box(double half) {
        return {uniform(-half, half), uniform(-half, half), uniform(-half, half)};
    }
    trilens::Vec3 direction() {
        for (;;) {
            const trilens::Vec3 v = in_box(1);
            if (dot(v, v) > 1e-3 && dot(v, v) < 1) return normalize(v);
        }
    }

  private:
    std::mt19937_64 engine_;
};

inline void add_triangle(trilens::TriangleScene& scene, const trilens::IdTriple& corners, trilens::Id object,
                         trilens::Id primitive) {
    scene.triangles.push_back(corners);
    scene.object.push_back(object);
    scene.primitive.push_back(primitive);
}

/// `count` separate triangles of sizes 0.02 to 1 around the origin, all multiplied by `scale`.
inline trilens::TriangleScene random_triangles(Random& random, int count, double scale) {
    trilens::TriangleScene scene;
    for (int i = 0; i < count; ++i) {
        const trilens::Vec3 centre = random.in_box(1);
        const double size = random.log_uniform(0.02, 1);
        for (int k = 0; k < 3; ++k) scene.points.push_back(scale * (centre + random.in_box(size)));
        const auto first = static_cast<trilens::Id>(3 * i);
        add_triangle(scene, {first, first + 1, first + 2}, static_cast<trilens::Id>(i % 3),
                     static_cast<trilens::Id>(i / 3));
    }
    return scene;
}

/// A closed sphere of rows x 2 rows latitude-longitude quads as triangles, no point twice.
inline trilens::TriangleScene sphere_of_triangles(int rows, const trilens::Vec3& centre, double radius) {
    using trilens::Id;
    trilens::TriangleScene scene;
    const int columns = 2 * rows;
    for (int i = 1; i < rows; ++i) {
        for (int j = 0; j < columns; ++j) {
            const double theta = M_PI * i / rows, phi = 2 * M_PI * j / columns;
            scene.points.push_back(centre + radius * trilens::Vec3(std::sin(theta) * std::cos(phi),
                                                                   std::cos(theta),
                                                                   std::sin(theta) * std::sin(phi)));
        }
    }
    const Id top = static_cast<Id>(scene.points.size()), bottom = top + 1;
    scene.points.push_back(centre + trilens::Vec3(0, radius, 0));
    scene.points.push_back(centre - trilens::Vec3(0, radius, 0));
    const auto at = [&](int i, int j) { return static_cast<Id>((i - 1) * columns + j % columns); };
    Id next = 0;
    for (int j = 0; j < columns; ++j) {
        add_triangle(scene, {top, at(1, j), at(1, j + 1)}, 0, next++);
        add_triangle(scene, {bottom, at(rows - 1, j + 1), at(rows - 1, j)}, 0, next++);
        for (int i = 1; i + 1 < rows; ++i) {
            add_triangle(scene, {at(i, j), at(i + 1, j), at(i + 1, j + 1)}, 0, next++);
            add_triangle(scene, {at(i, j), at(i + 1, j + 1), at(i, j + 1)}, 0, next++);
        }
    }
    return scene;
}

}  // namespace trilens_test
