// Adaptive subdivision: beams divided by exact rays until what falls on a footprint is flat.
#pragma once

#include <array>
#include <functional>
#include <memory>

#include "base/util/parallel.h"
#include "caustics/footprint.h"
#include "caustics/light_paths.h"

namespace trilens {

/// The exact rays at the middles of a beam's sides, and the four beams that they make.
struct BeamDivision {
    std::array<BeamEnd, 3> middle;  // of the side across from each corner
    std::array<Lazy<BeamDivision>, 4> part;
};

/// Beams as exact rays have them: each is divided where, and as far as, a footprint asks, and what was traced
/// is kept. What is found does not depend on who asked before. Thread-safe.
class RefinedBeams {
  public:
    RefinedBeams() = default;
    /// `beams` must live longer, and what `space` points to.
    RefinedBeams(const LightSpace& space, const BeamSource& source, const Beams& beams);

    /// The exact rays at the middles of a beam's sides, across from its ends.
    const std::array<BeamEnd, 3>& middles(Id beam) const;

    using Use = std::function<void(const BeamCorners&, const FallenBeam&)>;
    /// The pieces of a beam that may come to the plane's footprint: bent by less than a hundredth of its
    /// side, or so small that it does not matter. `guess`: how far, in the plane's coordinates, a beam's rays
    /// may fall from its triangle.
    void for_each_piece(Id beam, const ReceiverPlane& plane, double guess, const Use& use) const;

    /// The same of the beam as a quadratic surface through its corners and the middles of its sides, which
    /// are exact, in 16 flat pieces; of the flat triangle where the plane lies so askew that a quadratic
    /// says nothing. It is all of the beam that comes to the footprint.
    void for_each_curved_piece(Id beam, const ReceiverPlane& plane, const Use& use) const;

  private:
    struct Visit;
    BeamEnd middle(Id beam, const BeamEnd& a, const BeamEnd& b) const;
    std::unique_ptr<BeamDivision> divide(Id beam, const std::array<const BeamEnd*, 3>& end) const;

    LightSpace space_;
    BeamSource source_;
    const Beams* beams_ = nullptr;
    std::unique_ptr<Lazy<BeamDivision>[]> division_;  // by beam
};

}  // namespace trilens
