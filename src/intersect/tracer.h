// First hits of single rays with a triangle scene: THE door to Embree.
#pragma once

#include <memory>
#include <span>
#include <string>

#include "base/raymesh/ray_mesh.h"
#include "base/raymesh/sample_grid.h"
#include "base/raymesh/segments.h"
#include "base/raymesh/triangle_scene.h"

namespace trilens {

/// Triangles under an Embree tree (ROBUST). Embree's tree finds the candidates in float, none too
/// few; each is met in double on the original triangle (triangle_hit.h). So hits depend neither on the
/// instruction set nor on the number of threads, and triangles that share an edge leave no gap. Triangles
/// without area, or with coordinates that are not finite, are never seen. Promised for origins within 1e8
/// radii of the scene. Thread-safe to read.
class Tracer {
  public:
    /// `isa`: Embree's instruction set ("sse2", "sse4.2", "avx", "avx2", "avx512"), or empty for the best of
    /// this machine. The triangles are shared, not copied, and stay as they are while the tracer lives.
    /// Throws ComputationError where Embree fails.
    explicit Tracer(std::shared_ptr<const TriangleScene> scene, const std::string& isa = "");
    /// Keeps the triangles for itself.
    explicit Tracer(TriangleScene scene, const std::string& isa = "");
    ~Tracer();
    Tracer(Tracer&&) noexcept;
    Tracer& operator=(Tracer&&) noexcept;

    /// The first hit with t >= t_min (in units of the direction, which need not be unit). Among the hits
    /// within kDepthTie of the smallest t, the one with the smallest (object, primitive). A ray that is not
    /// finite, or has no direction, sees nothing.
    Hit first_hit(const Ray& ray, double t_min = 0) const;

    /// Whether anything lies on the ray with t_min < t < t_max.
    bool occluded(const Ray& ray, double t_min, double t_max) const;

    /// The segments on which something lies: for each what occluded(ray, 0, 1) says.
    Segments::Bits occluded(const Segments& segments) const;

  private:
    struct Data;
    std::unique_ptr<Data> data_;
};

/// Facets truth: for every sample that `owned` gives to a facet with rays, the first hit (t >= 0) of the
/// interpolated ray, written to hits[sample]; other entries are left alone. hits.size() == grid.size().
void trace_facets(const Tracer& tracer, const RayMesh& mesh, const FacetSamples& owned,
                  const SampleGrid& grid, std::span<Hit> hits);

/// Sets Embree's thread count for scenes built from now on; 0 means all.
void set_tracer_threads(int threads);

/// "Embree 3.13.5", the library that runs now: for `trilens info`.
std::string tracer_library_version();

}  // namespace trilens
