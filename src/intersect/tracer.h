// Watertight ray/triangle intersection in double (Woop, Benthin and Wald, JCGT 2(1), 2013), and how near a
// triangle in the plane comes to the origin.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "base/math/vec.h"
#include "base/raymesh/ray_mesh.h"
#include "base/raymesh/sample_grid.h"
#include "base/raymesh/segments.h"
#include "base/raymesh/triangle_scene.h"

namespace trilens {

/// Where a ray's line meets a triangle.
struct TriangleHit {
    double t = 0;         // in units of the direction; any sign
    Vec2 barycentric{0};  // weights of the second and third corner
};

/// A ray made ready for many triangles: the frame in which it runs along its largest axis from the origin.
class ShearedRay {
  public:
    explicit ShearedRay(const Ray& ray);

    /// Where the ray's whole line meets the triangle, edges and corners included; none for a triangle that it
    /// sees edge-on or that has no area. Two triangles with a shared edge (same bits of both corners) never
    /// both miss a ray through it: each edge's sign is the same in both, and rounding turns a sign to zero at
    /// most, which counts as a hit. Depends on the corners' order only through rounding of t and the weights.
    std::optional<TriangleHit> meet(const std::array<Vec3, 3>& corner) const;

  private:
    Vec3 origin_{0};
    int x_ = 0, y_ = 1, z_ = 2;  // axes; the direction is largest along z_
    double shear_x_ = 0, shear_y_ = 0, scale_z_ = 0;
};

/// Whether the triangle has no area: corners that are not finite, coincide, or lie on one line to rounding.
bool has_no_area(const std::array<Vec3, 3>& corner);

/// The corners, in either sense; they may lie on a line or in one point.
using PlaneTriangle = std::array<Vec2, 3>;

/// Whether the origin is farther than this from the triangle for sure, by one edge's line; no division, no
/// root. What rounding does to areas is far below the room that is left for it; where it may have turned the
/// triangle's own, the triangle is as good as its edge.
inline bool is_surely_beyond(const PlaneTriangle& p, double distance) {
    constexpr double kRelative = 1 + 1e-6, kEdgeRounding = 1e-13;
    const std::array<double, 3> areas{cross(p[0], p[1]), cross(p[1], p[2]), cross(p[2], p[0])};
    const double sum = areas[0] + areas[1] + areas[2];
    for (std::size_t k = 0; k < 3; ++k) {
        const Vec2 &a = p[k], &b = p[(k + 1) % 3];
        const double outside = sum > 0 ? -areas[k] : areas[k];
        const double edge = std::fabs(b.x - a.x) + std::fabs(b.y - a.y);  // or more
        if (outside > kRelative * distance * edge + kEdgeRounding * (dot(a, a) + dot(b, b))) return true;
    }
    return false;
}

/// Whether a surface over the triangle, seen along the ray through the origin, surely hides the origin, where
/// its border strays no farther from the triangle's edges than `stray`: farther inside, the border goes
/// around the origin once, and a disc covers what its border goes around.
inline bool surely_covers_origin(const PlaneTriangle& p, double stray) {
    double least = std::numeric_limits<double>::infinity(), most = -least;
    for (std::size_t k = 0; k < 3; ++k) {
        const Vec2 &a = p[k], &b = p[(k + 1) % 3];
        const double height = cross(a, b) / length(b - a);
        least = std::min(least, height);
        most = std::max(most, height);
    }
    return least > stray || most < -stray;
}

/// The triangle's point that is nearest to the origin: weights of its corners, and how far it is; 0 where the
/// origin lies inside.
struct NearestToOrigin {
    Vec3 weights{0};
    double distance = std::numeric_limits<double>::infinity();
};
NearestToOrigin nearest_to_origin(const PlaneTriangle& p);

// First hits of single rays with a triangle scene: THE door to Embree.

/// Triangles under an Embree tree (ROBUST). Embree's tree finds the candidates in float, none too
/// few; each is met in double on the original triangle. So hits depend neither on the
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

    /// The first hit with t_min <= t <= t_max (in units of the direction, which need not be unit). Among the
    /// hits within kDepthTie of the smallest t, of which some may lie beyond t_max, the one with the smallest
    /// (object, primitive). A ray that is not finite, or has no direction, sees nothing.
    Hit first_hit(const Ray& ray, double t_min = 0,
                  double t_max = std::numeric_limits<double>::infinity()) const;

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
