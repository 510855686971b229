// The hemicube over a point of a surface: a RayMesh of five pinhole cameras, and the form factor of each
// pixel.
// Source: Cohen, Greenberg, The Hemi-Cube: A Radiosity Solution for Complex Environments, SIGGRAPH 1985.
#pragma once

#include <vector>

#include "base/math/vec.h"
#include "base/raymesh/ray_mesh.h"
#include "base/raymesh/sample_grid.h"

namespace trilens {

/// Where a hemicube stands: unit vectors at right angles, world.
struct HemicubePlace {
    Vec3 origin{0};
    Vec3 normal{0, 1, 0};   // through the middle of its top
    Vec3 tangent{1, 0, 0};  // through the middle of a side
};

/// Half a cube about a point: the top of `resolution` x `resolution` pixels, above its four sides of half as
/// many, one under the other on one film.
class Hemicube {
  public:
    /// `resolution`: pixels along an edge, even and positive.
    explicit Hemicube(int resolution);

    /// Its five cameras, two facets each.
    RayMesh mesh(const HemicubePlace& place) const;
    const SampleGrid& grid() const { return grid_; }
    const FacetSamples& owned() const { return owned_; }
    /// Of each sample: the share of what leaves the point, evenly in all directions as Lambert has it, that
    /// leaves through its pixel. Integrals over the pixels in closed form: their sum is 1.
    const std::vector<double>& factors() const { return factors_; }

  private:
    SampleGrid grid_;
    FacetSamples owned_;
    std::vector<double> factors_;
};

}  // namespace trilens
