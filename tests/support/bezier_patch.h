// Spline patches for tests: a bumpy bicubic one, random NURBS, and surfaces of revolution.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "scene/data/patches.h"
#include "support/draw.h"

namespace trilens_test {

/// Control points in a square lattice from -1.5 to 1.5, each moved by at most so much.
inline trilens::BezierPatch random_patch(std::uint64_t seed, double along, double up) {
    Draw draw(seed);
    trilens::BezierPatch patch;
    for (std::size_t k = 0; k < 16; ++k)
        patch[k] =
            trilens::Vec3(static_cast<double>(k % 4) - 1.5, static_cast<double>(k / 4) - 1.5, 0) +
            trilens::Vec3(draw.uniform(-along, along), draw.uniform(-along, along), draw.uniform(-up, up));
    return patch;
}

/// A bumpy sheet with weights of 0.4 to 2.5 and knots of many steps, some of them double, none at the ends
/// more often than once.
inline trilens::SplineGrid random_nurbs(std::uint64_t seed, std::array<int, 2> degree,
                                        std::array<int, 2> points) {
    Draw draw(seed);
    trilens::SplineGrid grid;
    grid.columns = points[0];
    grid.degree = degree;
    for (int j = 0; j < points[1]; ++j)
        for (int i = 0; i < points[0]; ++i) {
            grid.points.emplace_back(i, j, draw.uniform(-0.5, 0.5));
            grid.weights.push_back(draw.uniform(0.4, 2.5));
        }
    for (std::size_t axis = 0; axis < 2; ++axis) {
        double knot = draw.uniform(-3, 3);
        for (int k = 0; k < points[axis] + degree[axis] + 1; ++k) {
            grid.knots[axis].push_back(knot);
            if (degree[axis] < 2 || k % 4 != 1) knot += draw.uniform(0.2, 1.5);
        }
    }
    return grid;
}

/// Points (radius, height) of a profile with weights turned about z in four quarters of circles of degree 2;
/// v goes along the profile, of Bezier arcs of degree 2.
inline trilens::SplineGrid revolved(const std::vector<trilens::Vec3>& profile) {
    const double half = std::sqrt(0.5);
    const std::array<trilens::Vec2, 9> around{
        {{1, 0}, {1, 1}, {0, 1}, {-1, 1}, {-1, 0}, {-1, -1}, {0, -1}, {1, -1}, {1, 0}}};
    trilens::SplineGrid grid;
    grid.columns = 9;
    grid.degree = {2, 2};
    for (const trilens::Vec3& at : profile)
        for (std::size_t k = 0; k < 9; ++k) {
            grid.points.emplace_back(at.x * around[k].x, at.x * around[k].y, at.y);
            grid.weights.push_back(at.z * (k % 2 == 0 ? 1 : half));
        }
    const auto arcs = [](int count) {
        std::vector<double> knots{0};
        for (int k = 0; k <= count; ++k) knots.insert(knots.end(), 2, k);
        knots.push_back(count);
        return knots;
    };
    grid.knots = {arcs(4), arcs((static_cast<int>(profile.size()) - 1) / 2)};
    return grid;
}

/// A sphere about the origin, from its lowest point to its highest, fronts outward.
inline trilens::SplineGrid nurbs_sphere(double radius) {
    const double half = std::sqrt(0.5), r = radius;
    return revolved({{0, -r, 1}, {r, -r, half}, {r, 0, 1}, {r, r, half}, {0, r, 1}});
}

/// A torus about z; fronts outward.
inline trilens::SplineGrid nurbs_torus(double large, double r) {
    const double half = std::sqrt(0.5);
    return revolved({{large, -r, 1},
                     {large + r, -r, half},
                     {large + r, 0, 1},
                     {large + r, r, half},
                     {large, r, 1},
                     {large - r, r, half},
                     {large - r, 0, 1},
                     {large - r, -r, half},
                     {large, -r, 1}});
}

}  // namespace trilens_test
