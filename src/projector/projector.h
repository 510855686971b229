// Draws a scene through a RayMesh: the exact engine.
#pragma once

#include <memory>
#include <span>

#include "base/facet_samples.h"
#include "base/ray_mesh.h"
#include "base/sample_grid.h"
#include "base/triangle_scene.h"

namespace trilens {

/// A scene made ready for drawing: triangles with their edges' canonical orientation, and a tree over them.
/// Holds a reference to nothing: the scene is copied into structure-of-arrays form.
class PreparedScene {
  public:
    explicit PreparedScene(const TriangleScene& scene);
    ~PreparedScene();
    PreparedScene(PreparedScene&&) noexcept;
    PreparedScene& operator=(PreparedScene&&) noexcept;

    struct Data;
    const Data& data() const { return *data_; }

  private:
    std::unique_ptr<Data> data_;
};

/// The facets' samples by the top-left rule on the screen: a sample on an edge that two facets share belongs to
/// one of them. For meshes that do not fold over on the screen (cameras); where they do, the facet with the
/// smaller index wins.
FacetSamples rasterize_facets(const RayMesh& mesh, const SampleGrid& grid);

/// For every sample that `owned` gives to a facet with rays: the first triangle along the facet's interpolated ray
/// (t >= 0), written to hits[sample]; other entries of `hits` are left alone. hits.size() == grid.size().
/// Coverage is exact (conic edge functions, mathematics section 2), watertight across triangles that share an edge.
void draw(const PreparedScene& scene, const RayMesh& mesh, const FacetSamples& owned, const SampleGrid& grid,
          std::span<Hit> hits);

}  // namespace trilens
