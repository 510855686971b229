// Proves how far what a sample shows in a mirror is from where the exact surface shows it: Krawczyk's
// operator around the image that Newton's method finds (Neumaier, Interval Methods for Systems of Equations,
// chapter 5; Moore, A Test for Existence of Solutions to Nonlinear Systems, 1977).
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "render/engines/path_ends.h"
#include "specular/specular_point.h"

namespace trilens {

/// What a sample shows over one reflection.
struct ReflectedSight {
    SurfaceParameter start;  // of the mirror, where the facet has it
    Vec2 pixel{0};           // the sample's place on the film
    Ray ray;                 // the facet's mirrored ray, not unit
    double t = 0;            // of what it meets along it; infinity: the environment
    bool front = true;       // the camera looks at the mirror's front
};

/// One optic's samples, proven one by one. Thread-safe.
class SampleCertifier {
  public:
    /// Proves nothing for glass, for normals that are not the surface's own, for surfaces without bounds and
    /// for cameras that are not linear. `world` and `frame` must live longer.
    SampleCertifier(const World& world, const Frame& frame, std::size_t optic);

    /// A number of pixels within which, as is proven, there is one place of the film whose exact camera ray
    /// meets the mirror where it is mirrored straight to what the sample shows. Not asked is whether
    /// something stands in the way of that path. What lies in the environment is taken to be as far away as
    /// double tells from infinity, with room for the difference. None where nothing is proven.
    std::optional<double> displacement_bound(const ReflectedSight& sight) const;

  private:
    std::optional<SpecularPoint> image_of(const ReflectedSight& sight, const SpecularQuery& query) const;

    const World& world_;
    const Frame& frame_;
    std::size_t optic_;
    double size_ = 0;  // of what the camera sees the mirror in, scene units
    std::unique_ptr<const SurfaceBounder> bounder_;
};

/// Samples whose bound is needed, and those that have it.
struct CertifyParams {
    const SampleCertifier& certifier;
    const SurfaceGrid& facets;  // of the optic
    const SampleGrid& grid;
    double limit = 0;  // pixels
};

/// Proves what the samples of an optic show that facets speak for: OpticView::bound is set where it is at
/// most the limit. All others lose their ends and are added to `traced`, for their own paths to be followed.
/// `ends` are those of the optic's samples.
void certify_samples(const CertifyParams& params, SampleViews& views, PathEnds& ends,
                     std::vector<Id>& traced);

}  // namespace trilens
