// First hits of single rays with a triangle scene: THE door to Embree.
#pragma once

#include <memory>
#include <span>
#include <string>

#include "base/facet_samples.h"
#include "base/ray_mesh.h"
#include "base/sample_grid.h"
#include "base/triangle_scene.h"

namespace trilens {

/// An Embree scene (ROBUST) over a copy of the triangles. Embree finds candidates in float; each is solved again in
/// double on the original triangle, so t and barycentrics do not depend on the instruction set.
class Tracer {
  public:
    explicit Tracer(const TriangleScene& scene);
    ~Tracer();
    Tracer(Tracer&&) noexcept;
    Tracer& operator=(Tracer&&) noexcept;

    /// The first hit with t >= t_min (in units of the direction, which need not be unit), ties as kDepthTie says.
    Hit first_hit(const Ray& ray, double t_min = 0) const;

    /// Whether anything lies on the ray with t_min < t < t_max.
    bool occluded(const Ray& ray, double t_min, double t_max) const;

  private:
    struct Data;
    std::unique_ptr<Data> data_;
};

/// Facets truth: for every sample that `owned` gives to a facet with rays, the first hit of the interpolated ray,
/// written to hits[sample]; other entries are left alone. hits.size() == grid.size().
void trace_facets(const Tracer& tracer, const RayMesh& mesh, const FacetSamples& owned, const SampleGrid& grid,
                  std::span<Hit> hits);

/// Sets Embree's thread count for scenes built from now on; 0 means all.
void set_tracer_threads(int threads);

/// "Embree 3.13.5": for `trilens info`.
std::string tracer_library_version();

}  // namespace trilens
