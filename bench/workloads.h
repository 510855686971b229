// Scenes of any size that speed is measured on, and the mirror that shows them.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "base/raymesh/ray_mesh.h"
#include "base/raymesh/sample_grid.h"
#include "base/raymesh/triangle_scene.h"
#include "bench/race/race.h"

namespace trilens_bench {

/// A closed bumpy room of 12 cells^2 triangles around the origin, half size 8.
trilens::TriangleScene bumpy_room(int cells);

/// `count` triangles strewn between a ball of radius 2 and a cube of half size 8, inside a closed box; their
/// sizes make the same share of rays hit them whatever their number.
trilens::TriangleScene soup(int count);

/// Ground and `boxes` boxes of 12 triangles around the origin, hollow in the middle: depth complexity.
trilens::TriangleScene city(int boxes);

/// The named workload of about so many triangles: "room", "soup" or "city". Throws std::invalid_argument.
trilens::TriangleScene workload(const std::string& name, double triangles);

/// The facets that face the eye of a mirror sphere of radius 1, n x n per face of its cage.
struct MirrorSphere {
    trilens::SampleGrid grid;
    trilens::RayMesh mesh;
};
MirrorSphere mirror_sphere(int n, int width, int height);

// Medians of repeated runs.

/// The median of `repeats` runs of `work`, milliseconds of wall time.
inline double median_ms(int repeats, const std::function<void()>& work) {
    std::vector<double> times;
    for (int i = 0; i < repeats; ++i) times.push_back(milliseconds(work));
    return median(std::move(times));
}

/// Reproducible uniform numbers, the same with every compiler.
inline double uniform(std::uint64_t& state, double low, double high) {
    state = state * 6364136223846793005u + 1442695040888963407u;
    return low + (high - low) * (static_cast<double>(state >> 11) * 0x1p-53);
}

}  // namespace trilens_bench
