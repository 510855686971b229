// Fold curves: where what an optic shows turns over on the film, the images of the eye's caustics.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "base/raymesh/ray_mesh.h"
#include "base/raymesh/sample_grid.h"
#include "base/raymesh/triangle_scene.h"
#include "vector/lines.h"

namespace trilens {

/// One RayMesh, and the samples that end in it.
struct FoldView {
    const RayMesh& mesh;
    const SampleGrid& grid;                    // the whole film
    std::span<const Id> facet;                 // per sample: the facet of the mesh that it shows, or kNone
    std::function<Hit(const Ray&)> first_hit;  // with the objects
    std::function<Id(Id triangle)> object_of;
};

/// Curves on which the map from the film to what is seen changes its orientation. The derivatives of the rays
/// with respect to the film are those of the facets, at each corner the mean over the facets around it, and
/// between corners interpolated like the rays themselves: continuous, and of second order, where a facet's
/// own are of first order and jump at its edges. The sign of their determinant at what is seen (in the
/// environment: of the directions') is taken at the samples, each change between neighbours is found to 1e-6
/// pixels, and neighbours are joined. Between neighbours of different objects, or where the hit jumps (one
/// part of an object before another), there is none. Curves end up to a sample before the end of what the
/// mesh shows, and two that are nearer to each other than a sample may be lost. Throws InputError where
/// mesh, grid and facets do not fit together, UsageError without first_hit or object_of.
std::vector<FoldCurve> fold_curves(const FoldView& view);

}  // namespace trilens
