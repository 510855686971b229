// What callers hand in, looked at before it is used: sample grids, RayMeshes, triangles.
#pragma once

#include <cstddef>

#include "base/raymesh/ray_mesh.h"
#include "base/raymesh/sample_grid.h"
#include "base/raymesh/triangle_scene.h"

namespace trilens {

/// Numbers beyond this are taken for mistakes: products of four still fit in a double. As kLargestCoordinate
/// of scenes.
inline constexpr double kLargestNumber = 1e30;

/// Whether all three are numbers within kLargestNumber.
inline bool is_coordinate(const Vec3& v) {
    return glm::abs(v.x) <= kLargestNumber && glm::abs(v.y) <= kLargestNumber &&
           glm::abs(v.z) <= kLargestNumber;
}

/// What one SampleGrid may have at most: samples are counted with whole numbers of 31 bits.
inline constexpr std::size_t kMostSamples = 2147483647;
inline constexpr int kFarthestPixel = 1 << 30;  // from the film's top left, either way

/// Throws InputError (place "grid") unless the grid has samples, at most kMostSamples, of pixels within
/// kFarthestPixel.
void check_sample_grid(const SampleGrid& grid);

/// Throws InputError with the place of the first thing that makes it no RayMesh: "screen" where there is not
/// one entry per ray, "rays/3", "screen/3" for what is not finite or beyond kLargestNumber (of a screen
/// position also where it is not zero, but all of it within 1 / kLargestNumber), "facets/3" for a corner that
/// there is not.
void check_ray_mesh(const RayMesh& mesh);

/// Throws InputError (place "facets/3", "screen") unless all corners of its facets with rays are there,
/// whatever numbers they have.
void check_facet_corners(const RayMesh& mesh);

/// Throws InputError with the place of the first thing that makes them no scene: "object", "primitive" where
/// there is not one entry per triangle, "points/3" for what is not finite or beyond kLargestNumber,
/// "triangles/3" for a corner that is no point.
void check_triangle_scene(const TriangleScene& scene);

}  // namespace trilens
