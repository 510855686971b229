// Makes the workloads, the same with every compiler.
#include "workloads.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "camera/linear/linear_cameras.h"
#include "reflect/reflection.h"
#include "surfaces/surfaces.h"

namespace trilens_bench {

using namespace trilens;

namespace {

void add_triangle(TriangleScene& scene, const Vec3& a, const Vec3& b, const Vec3& c) {
    const Id first = static_cast<Id>(scene.points.size());
    scene.points.insert(scene.points.end(), {a, b, c});
    scene.triangles.push_back({first, first + 1, first + 2});
    scene.primitive.push_back(static_cast<Id>(scene.object.size()));
    scene.object.push_back(0);
}

void add_box(TriangleScene& scene, const Vec3& low, const Vec3& high) {
    const auto corner = [&](int k) {
        return Vec3(k & 1 ? high.x : low.x, k & 2 ? high.y : low.y, k & 4 ? high.z : low.z);
    };
    constexpr int kFaces[6][4] = {{0, 1, 3, 2}, {4, 6, 7, 5}, {0, 4, 5, 1},
                                  {2, 3, 7, 6}, {0, 2, 6, 4}, {1, 5, 7, 3}};
    for (const auto& f : kFaces) {
        add_triangle(scene, corner(f[0]), corner(f[1]), corner(f[2]));
        add_triangle(scene, corner(f[0]), corner(f[2]), corner(f[3]));
    }
}

}  // namespace

TriangleScene bumpy_room(int cells) {
    TriangleScene scene;
    const auto point = [&](int wall, int i, int j) {
        const double x = 2.0 * i / cells - 1, y = 2.0 * j / cells - 1, s = wall % 2 == 0 ? 1 : -1;
        const Vec3 p = wall < 2 ? Vec3(s, x, y) : wall < 4 ? Vec3(x, s, y) : Vec3(x, y, s);
        return 8.0 * p * (1 + 0.05 * std::sin(9 * p.x) * std::sin(7 * p.y + 1) * std::sin(8 * p.z + 2));
    };
    for (int wall = 0; wall < 6; ++wall) {
        for (int j = 0; j < cells; ++j) {
            for (int i = 0; i < cells; ++i) {
                add_triangle(scene, point(wall, i, j), point(wall, i + 1, j), point(wall, i + 1, j + 1));
                add_triangle(scene, point(wall, i, j), point(wall, i + 1, j + 1), point(wall, i, j + 1));
            }
        }
    }
    return scene;
}

TriangleScene soup(int count) {
    TriangleScene scene;
    add_box(scene, Vec3(-9), Vec3(9));
    std::uint64_t state = 7;
    const double size = 12 / std::sqrt(static_cast<double>(std::max(1, count)));
    const auto in_cube = [&](double half) {
        const double x = uniform(state, -half, half), y = uniform(state, -half, half);
        return Vec3(x, y, uniform(state, -half, half));
    };
    while (static_cast<int>(scene.size()) < count + 12) {
        const Vec3 centre = in_cube(8);
        if (length(centre) < 2 + 2 * size) continue;
        const Vec3 a = centre + in_cube(size), b = centre + in_cube(size);
        add_triangle(scene, a, b, centre + in_cube(size));
    }
    return scene;
}

TriangleScene city(int boxes) {
    TriangleScene scene;
    std::uint64_t state = 12345;
    add_box(scene, {-60, -2, -60}, {60, -1.5, 60});
    const int side = static_cast<int>(std::ceil(std::sqrt(static_cast<double>(boxes))));
    const double cell = 100.0 / side;
    int made = 0;
    for (int j = 0; j < side; ++j) {
        for (int i = 0; i < side && made < boxes; ++i) {
            const double x = -50 + (i + 0.5) * cell, z = -50 + (j + 0.5) * cell;
            const double w = cell * uniform(state, 0.25, 0.45), d = cell * uniform(state, 0.25, 0.45);
            const double tall = uniform(state, 0, 1);
            const double h = (1 + 5 * tall * tall) * 2 * std::sqrt(100.0 / std::max(100, side * 3));
            if (std::fabs(x) < 4.5 && std::fabs(z) < 4.5) continue;
            ++made;
            add_box(scene, {x - w, -1.45, z - d}, {x + w, -1.45 + h, z + d});
        }
    }
    return scene;
}

TriangleScene workload(const std::string& name, double triangles) {
    if (name == "room")
        return bumpy_room(std::max(1, static_cast<int>(std::lround(std::sqrt(triangles / 12)))));
    if (name == "soup") return soup(static_cast<int>(triangles));
    if (name == "city") return city(std::max(1, static_cast<int>(std::lround(triangles / 12))));
    throw std::invalid_argument("no workload '" + name + "': room, soup or city");
}

MirrorSphere mirror_sphere(int n, int width, int height) {
    PerspectiveParams params;
    params.look_at = {{0.3, 0.6, 3.1}, {0, 0, 0}, {0, 1, 0}};
    params.yfov_degrees = 45;
    params.width = width;
    params.height = height;
    const LinearCamera camera = make_perspective(params);
    const Primitive sphere;
    const SurfaceGrid grid = make_grid(*make_primitive_surface(sphere), n);
    MirrorSphere result{{0, 0, width, height, 1}, make_reflection(grid, camera)};
    for (std::size_t f = 0; f < result.mesh.facets.size(); ++f) {
        const auto at = [&](std::size_t k) { return grid.points[grid.corner_point[grid.facets[f][k]]]; };
        if (dot(cross(at(1) - at(0), at(2) - at(0)), at(0) - camera.eye) >= 0)
            result.mesh.facets[f] = {kNone, kNone, kNone};
    }
    return result;
}

}  // namespace trilens_bench
