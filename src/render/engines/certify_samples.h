// Proves how far what a sample shows through facets is from where the exact surfaces show it: Krawczyk's
// operator around the path of light that Newton's method finds (Neumaier, Interval Methods for Systems of
// Equations, chapter 5; Moore, A Test for Existence of Solutions to Nonlinear Systems, 1977).
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "render/engines/path_ends.h"
#include "render/frame/image_chain.h"
#include "specular/chain/path_chain.h"

namespace trilens {

/// What a sample shows over one history of reflections and refractions.
struct ProjectedSight {
    std::span<const Step> steps;  // at least one
    Colours colours = kAllColours;
    SurfaceParameter start;  // of the first optic, where the facet has it
    bool front = true;       // the camera looks at its front there
    Vec2 pixel{0};           // the sample's place on the film
    Ray ray;                 // the facet's last ray, not unit
    double t = 0;            // of what it meets along it; infinity: the environment
};

/// Proves samples one by one. Thread-safe.
class SampleCertifier {
  public:
    /// Proves nothing over optics whose normals are not the surface's own, or whose surface has no bounds,
    /// and for cameras that are not linear. `world` and `frame` must live longer.
    SampleCertifier(const World& world, const Frame& frame);

    /// A number of pixels within which, as is proven, there is one place of the film whose exact camera ray
    /// goes over the same steps to what the sample shows. Not asked is whether something stands in the way of
    /// that path. None where nothing is proven.
    std::optional<double> displacement_bound(const ProjectedSight& sight) const;

  private:
    bool knows(std::span<const Step> steps) const;
    std::optional<SolvedChain> path_of(const ProjectedSight& sight) const;
    std::optional<ChainBox> box_around(const SolvedChain& path, std::span<const Step> steps,
                                       double half) const;

    const World& world_;
    const Frame& frame_;
    std::vector<std::unique_ptr<const SurfaceBounder>> bounders_;  // per optic; null: it proves nothing
};

/// Samples whose bound is needed, and those that have it.
struct CertifyParams {
    const SampleCertifier& certifier;
    const SurfaceGrid& facets;  // of the optic
    const SampleGrid& grid;
    double limit = 0;  // pixels
};

/// Proves what the samples of an optic show that facets speak for: OpticView::bound is set where that of each
/// of its ends is at most the limit, to the largest. All others lose their ends and are added to `traced`,
/// for their own paths to be followed. `ends` are those of the optic's samples.
void certify_samples(const CertifyParams& params, SampleViews& views, PathEnds& ends,
                     std::vector<Id>& traced);

}  // namespace trilens
