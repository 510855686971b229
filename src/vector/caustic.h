// Caustics: the surfaces in the world on which neighbouring rays of a RayMesh meet, and how its rays change
// over the film.
#pragma once

#include <array>
#include <cmath>
#include <functional>
#include <span>
#include <vector>

#include "base/raymesh/ray_mesh.h"
#include "base/raymesh/sample_grid.h"
#include "base/raymesh/triangle_scene.h"
#include "vector/lines.h"

namespace trilens {

struct CausticParams {
    const RayMesh& mesh;
    std::vector<char> seen;  // per facet: whether it takes part; empty: all do
    double size = 1;         // of the scene, world units: places farther than kFarCaustic of it are left out
};
inline constexpr double kFarCaustic = 10;

/// The sheets that are not empty: a point for each corner that has a root, found with the rays' derivatives
/// at the corners (ray_slopes.h), so of second order in the facets' size inside of the mesh and of first at
/// its border. Complex roots that rounding or the facets' size may have made of a double one (by a thousandth
/// of the equation's own terms) count as that. Rays are followed through whatever stands before the caustic.
/// Throws InputError where `mesh` or `seen` do not fit together.
std::vector<CausticSheet> caustic_sheets(const CausticParams& params);

// How the rays of a RayMesh change over the film, continuously from facet to facet; the film's samples as
// rows and columns.

/// How a mesh's rays change with the film's x and y.
struct RaySlope {
    Vec3 origin_x{0}, origin_y{0}, direction_x{0}, direction_y{0};

    void add(const RaySlope& other, double share) {
        origin_x += share * other.origin_x, origin_y += share * other.origin_y;
        direction_x += share * other.direction_x, direction_y += share * other.direction_y;
    }
};

/// Inside a facet, where its unnormalised weights are `e`.
RaySlope slope_in_facet(const RayMesh& mesh, std::size_t facet, const FacetWeights& weights, const Vec3& e);

/// Per corner the mean over the facets around it, of second order in their size; zero where all of them are
/// edge-on or behind the camera.
std::vector<RaySlope> corner_slopes(const RayMesh& mesh);

struct SampleLattice {
    const SampleGrid& grid;

    int columns() const { return grid.width() * grid.side; }
    int rows() const { return grid.height() * grid.side; }
    bool holds(int column, int row) const {
        return column >= 0 && row >= 0 && column < columns() && row < rows();
    }
    std::size_t sample(int column, int row) const {
        return grid.sample_at(static_cast<std::size_t>(column), static_cast<std::size_t>(row));
    }
    int column(std::size_t sample) const {
        return static_cast<int>(std::lround((grid.position(sample).x - grid.x0) * grid.side - 0.5));
    }
    int row(std::size_t sample) const {
        return static_cast<int>(std::lround((grid.position(sample).y - grid.y0) * grid.side - 0.5));
    }
};

// Fold curves: where what an optic shows turns over on the film, the images of the eye's caustics.

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
