// Form factors: which share of what one side of a triangle sends out arrives at each other side.
#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "base/raymesh/triangle_scene.h"
#include "base/util/error.h"
#include "intersect/tracer.h"
#include "projector/scene/prepared_scene.h"
#include "radiosity/hemicube.h"
#include "radiosity/settings.h"

namespace trilens {

struct FormFactorParams {
    FormFactorMethod method = FormFactorMethod::kHemicube;
    int resolution = 64;   // of hemicubes: pixels along an edge, even
    int subdivision = 1;   // n: a hemicube in the middle of each of a triangle's n x n parts
    int rays = 4096;       // of kRays, from each side: their places on it, too, are spread evenly
    double offset = 1e-5;  // how far above the surface rays start, world
};

// Triangle t has two sides: 2 t, where its corners turn anticlockwise, and 2 t + 1.
inline Id side_of(Id triangle, bool is_back) {
    return 2 * triangle + (is_back ? 1 : 0);
}

/// The form factors F_ij from one side i, of those j that are not zero, ascending.
struct FormFactorRow {
    std::vector<Id> side;
    std::vector<double> factor;
    double escaped = 0;  // what arrives nowhere; with the others the sum is 1

    std::size_t bytes() const {
        return sizeof *this + side.capacity() * sizeof(Id) + factor.capacity() * sizeof(double);
    }
};

/// Makes rows of form factors. Thread-safe; the same rows for any number of threads.
class FormFactors {
  public:
    /// The triangles are shared and stay as they are.
    FormFactors(std::shared_ptr<const TriangleScene> scene, const FormFactorParams& params);

    std::size_t side_count() const { return 2 * scene_->size(); }
    /// Of a triangle without area: everything escapes.
    FormFactorRow row(Id side) const;
    /// The irradiance at a point of a surface, where sides have this radiosity. Lifts the place by the
    /// offset.
    Vec3 irradiance_at(const HemicubePlace& place, std::span<const Vec3> radiosity) const;

  private:
    /// add(side, factor) of what a hemicube there sees; nothing: side_count().
    template <typename Add>
    void for_each_pixel(const HemicubePlace& place, const Add& add) const;
    /// The same of ray number `i` from there.
    template <typename Add>
    void follow_ray(const HemicubePlace& place, std::size_t i, const Add& add) const;
    HemicubePlace place_of(Id side, const Vec3& weights) const;
    Id side_seen(Id triangle, const Vec3& from) const;

    std::shared_ptr<const TriangleScene> scene_;
    FormFactorParams params_;
    Hemicube hemicube_;
    std::vector<Vec3> normals_;  // unit; zero where there is no area
    std::optional<PreparedScene> prepared_;
    std::optional<Tracer> tracer_;
};

/// Weights of the middles of a triangle's n x n equal parts.
std::vector<Vec3> middles_of_parts(int n);

/// The area of each triangle; 0 where has_no_area says so.
std::vector<double> triangle_areas(const TriangleScene& scene);

/// All rows.
struct FormFactorMatrix {
    std::vector<FormFactorRow> rows;
};

/// Throws Interrupted.
FormFactorMatrix make_matrix(const FormFactors& factors, const Progress& progress = {});

/// The nearest that both keep reciprocity, A_i F_ij = A_j F_ji, and give away all that does not escape: means
/// of both estimates, scaled by factors d_i d_j until each row's sum and its `escaped` make 1 within
/// `tolerance` (Sinkhorn and Knopp's scaling, kept symmetric). `area`: of each side. A row all of whose
/// others see nothing of it escapes as a whole. Where no factors do that, as where few rays missed small
/// sides, scaling ends once it brings no more, what rows lack escapes, and none gives away more than it has.
FormFactorMatrix made_reciprocal(const FormFactorMatrix& matrix, std::span<const double> area,
                                 double tolerance = 1e-12);

}  // namespace trilens
