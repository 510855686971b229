// The thesis' engine: outlines of projected triangles, filled and depth-buffered (Vallance 2005, chapters 3
// to 5).
#pragma once

#include <array>
#include <functional>
#include <span>
#include <vector>

#include "base/math/box.h"
#include "base/raymesh/ray_mesh.h"
#include "base/raymesh/sample_grid.h"
#include "base/util/ids.h"
#include "projector/classic/classic_params.h"
#include "projector/scene/prepared_scene.h"
#include "trilinear/facet/facet.h"

namespace trilens {

/// The contract of draw(), but for coverage: a sample sees a triangle where the triangle's outlines in the
/// sample's facet hold it, so a sample beyond its facet's border may see nothing. A sample exactly on an
/// outline goes by the rule that facets go by; triangles with the same vertices along an edge leave no gap
/// there. Slices put a shared edge's vertices at other places for each of its triangles, and may leave some.
/// t and the barycentrics are those of the sample's ray in the triangle's plane; where a coarse outline
/// reaches beyond the triangle, those of a point on the triangle's border.
/// With Clip::kUnclipped every facet projects every triangle.
void draw_classic(const PreparedScene& scene, const RayMesh& mesh, const FacetSamples& owned,
                  const SampleGrid& grid, std::span<Hit> hits, const ClassicParams& params);

// A scanline filler: which samples of a facet lie inside polygons on the screen, by the even-odd rule.

/// Samples in rows of the film from top to bottom, each row from left to right. A sample's place is its index
/// into `sample` and `x`.
struct SampleRows {
    struct Row {
        double y = 0;
        std::size_t first = 0, end = 0;  // places
    };
    std::vector<Row> row;
    std::vector<Id> sample;
    std::vector<double> x;

    std::size_t size() const { return sample.size(); }
};

SampleRows make_sample_rows(std::span<const Id> samples, const SampleGrid& grid);

/// A closed polygon on the screen: homogeneous (x w, y w, w) in pixels, the last vertex joined to the first.
using ScreenPolygon = std::vector<Vec3>;

/// Fills polygons over one facet's samples. Vertices nearer than `least_depth` are cut away; that must be
/// less than the facet's depth at every sample.
class PolygonFiller {
  public:
    PolygonFiller(const SampleRows& rows, double least_depth) : rows_(rows), least_depth_(least_depth) {}

    void add(const ScreenPolygon& polygon);

    /// Calls body for each run [first, end) of places that an odd number of the polygons added since the last
    /// fill holds. A sample exactly on a side belongs to the polygon on its right, or below. The same side
    /// gives the same bits in both of its directions.
    void fill(const std::function<void(std::size_t first, std::size_t end)>& body);

  private:
    struct Crossing {
        std::size_t row = 0;
        double x = 0;
    };
    void add_side(const Vec2& a, const Vec2& b);

    const SampleRows& rows_;
    double least_depth_;
    std::vector<Crossing> crossing_;
    std::vector<Vec2> flat_;
};

// Frustum culling for a facet: the space that its rays can reach, bounded by planes. Boxes beyond one of them
// are never hit.

/// The rays over the parallelogram that two edges of a facet span start in the hull of the four origins at
/// its corners and go along the cone of the four directions there. Positions are from centre().
class FacetFrustum {
  public:
    explicit FacetFrustum(const TrilinearFacet& facet);

    /// Whether no ray of the facet meets the box. May say no although none does.
    bool misses(const Box& box) const;

    /// The first corner ray's origin, in the world.
    const Vec3& centre() const { return centre_; }

  private:
    struct Plane {
        Vec3 normal{0};     // unit but for a tiny turn, into the frustum
        double offset = 0;  // every point of the frustum has normal . x >= offset
    };
    void add_plane(const Vec3& normal);
    void add_axis();

    Vec3 centre_{0};
    std::array<Vec3, 4> origin_{}, direction_{}, unit_direction_{};  // around the parallelogram
    double origin_size_ = 0;
    std::array<Plane, 17> plane_{};
    std::size_t planes_ = 0;
    Vec3 axis_{0};
    double least_cosine_ = 0;  // between the axis and a direction; 0: too wide for an axis to mean anything
};

}  // namespace trilens
