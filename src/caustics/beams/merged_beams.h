// Coarsening: where one quadratic beam stands for the many that other histories need.
#pragma once

#include <span>

#include "caustics/beams/beam_grid.h"

namespace trilens {

/// A history's exact ray at a place in a triangle.
struct MergeSample {
    Vec3 weights{0};  // of the triangle's corners
    const LightPath* path = nullptr;
};

struct MergeParams {
    double tolerance = 0;  // how far light may fall from its place, world units
    double size = 1;       // of the scene
    double brightest = 0;  // path of the light: the sum of its colours
    double faint = 0;      // irradiance, the sum of its colours, that may fall beside its place
};

/// Whether the quadratic through a triangle's corners and the middles of its sides has all of the samples:
/// where they fall, on what, and what they carry. The first three are its corners; where the middles, or any
/// others, are not among them all have to be nearly straight. `measure`: of the light's film in the triangle.
bool is_one_beam(std::span<const MergeSample> samples, double measure, const MergeParams& params);

}  // namespace trilens
