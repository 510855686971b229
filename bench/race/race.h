// One race: the projector against Embree's packets, on the same interpolated rays in the same run.
#pragma once

#include <algorithm>
#include <cstddef>
#include <string>
#include <vector>

#include "base/raymesh/ray_mesh.h"
#include "base/raymesh/sample_grid.h"
#include "base/raymesh/triangle_scene.h"
#include "base/util/error.h"

namespace trilens_bench {

using namespace trilens;

struct RaceParams {
    int repeats = 9;
    std::string isa;  // for both sides: "avx512", "avx2", "sse4.2"; empty: the best of this machine
};

/// Where the two sides see different triangles. Embree's rays and triangles are floats: it may differ by what
/// they round.
struct Mismatches {
    std::size_t pixels = 0;
    std::size_t edge = 0;         // both triangles are met within a hair of an edge
    std::size_t depth = 0;        // both are met, at one depth but for a hair
    std::size_t unexplained = 0;  // of them all
};

/// Medians over the repeats, milliseconds of wall time; ratios are medians of each round's own ratio, above 1
/// where the projector is faster.
struct RaceResult {
    std::size_t pixels = 0, facets = 0, triangles = 0, seen = 0;
    // Projector: its tree; facets' rays and samples in vectors; hits by sample.
    double prepare_ms = 0, samples_ms = 0, written_ms = 0;
    // What is seen, left in vectors' order: the same exact triangles, but t within bounds, and no place on
    // them.
    double visible_ms = 0;
    // Samples in vectors made while drawing, as draw() does it, hits by sample: what a user waits for.
    double whole_ms = 0;
    // Embree: its tree; a ray per sample in packets; hits left in packets' order; hits by sample.
    double build_ms = 0, rays_ms = 0, trace_ms = 0, trace_written_ms = 0;
    struct Ratios {
        double visible = 0, written = 0, with_build = 0, whole = 0;
    } ratio;
    double slowest_ratio = 0, fastest_ratio = 0;  // of `written` over the rounds
    Mismatches mismatches;
    // How the projector draws the samples: in vectors that facets share; decided exactly, where floats left
    // open; without bounds, one ray at a time. Shares of `pixels`.
    double shared = 0, ambiguous = 0, unbounded = 0;
    double depth_complexity = 0;  // depths at which a ray meets the scene, mean of some of the rays
    std::string projector_isa, embree_configuration;
    int rays_at_once = 0, threads = 0;
};

/// Rays that look at the scene: the samples of a mesh's facets.
struct RaceView {
    const RayMesh* mesh = nullptr;
    const FacetSamples* owned = nullptr;
};

struct RaceCourse {
    const TriangleScene& scene;
    std::vector<RaceView> views;
    const SampleGrid& grid;
};

/// All times and counts are sums over the views. Throws UsageError for an instruction set that one of the
/// sides does not have and for less than one repeat, InputError where scene, grid and views do not fit
/// together.
RaceResult race(const RaceCourse& course, const RaceParams& params);

// What is timed, and how several times make one.

using namespace trilens;

/// How long work() takes, in milliseconds.
template <typename Work>
double milliseconds(const Work& work) {
    const Stopwatch watch;
    work();
    return 1000 * watch.seconds();
}

/// The middle one by size, the upper of two; `values` is not empty.
inline double median(std::vector<double> values) {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

}  // namespace trilens_bench
