// Adaptive subdivision: beams divided by exact rays until what falls on a footprint is flat.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <unordered_map>
#include <vector>

#include "base/util/parallel.h"
#include "caustics/beams/light_paths.h"
#include "caustics/curved_beam.h"
#include "caustics/footprint.h"

namespace trilens {

/// The exact rays at the middles of a beam's sides, and the four beams that they make.
struct BeamDivision {
    std::array<BeamEnd, 3> middle;  // of the side across from each corner
    std::array<Lazy<BeamDivision>, 4> part;
};

/// The divisions that were asked for last, some 2^17 of them; what is not there was forgotten. Thread-safe.
class RecentDivisions {
  public:
    using Make = std::function<void(BeamDivision&)>;
    /// `place`: which part of the beam, kWholeBeam or of place_of_part. `make` fills in what is not known.
    std::shared_ptr<const BeamDivision> get(Id beam, std::uint32_t place, const Make& make);

  private:
    static constexpr std::size_t kShards = 64, kMostInShard = 2048;
    struct Shard {
        std::mutex lock;
        std::unordered_map<std::uint64_t, std::shared_ptr<const BeamDivision>> known;
    };
    std::array<Shard, kShards> shard_;
};

inline constexpr std::uint32_t kWholeBeam = 1;
constexpr std::uint32_t place_of_part(std::uint32_t whole, std::size_t part) {
    return 4 * whole + static_cast<std::uint32_t>(part);
}

/// The corner triangles of a division, and the one between the middles.
std::array<BeamEnds, 4> quarters(const BeamEnds& end, const BeamEnds& middle);

/// Beams as exact rays have them: each is divided where, and as far as, a footprint asks, and what was traced
/// is kept, of footprints up to kMostKept divisions, and the most recent of what they ask beyond. What is
/// found does not depend on who asked before. Thread-safe.
class RefinedBeams {
  public:
    RefinedBeams() = default;
    /// `beams` must live longer, and what `space` points to. Throws Interrupted soon after `progress` says
    /// so.
    RefinedBeams(const LightSpace& space, const BeamSource& source, const Beams& beams,
                 const Progress& progress = {});

    /// The exact rays at the middles of a beam's sides, across from its ends.
    BeamEnds side_middles(Id beam) const {
        const std::array<Id, 3>& side = side_[beam];
        return {&side_middle_[side[0]], &side_middle_[side[1]], &side_middle_[side[2]]};
    }
    /// The exact ray of the beam's history in the middle between two others, in either order.
    BeamEnd middle(Id beam, const BeamEnd& a, const BeamEnd& b) const;
    /// Finds what the ray of an end in air meets; of one in glass nothing.
    void look_ahead(Id beam, BeamEnd& end) const;
    /// A part of a beam, with its part of the film.
    BeamCorners corners(Id beam, const BeamEnds& end) const;

    /// The light that arrives at optics over the square of the scene's size: irradiance, the sum of its
    /// colours.
    double mean_light() const { return mean_light_; }

    using Use = UsePiece;
    /// The pieces of a beam that may come to the plane's footprint: bent by less than a hundredth of its
    /// side, or so small that it does not matter. `guess`: how far, in the plane's coordinates, a beam's rays
    /// may fall from its triangle.
    void for_each_piece(Id beam, const ReceiverPlane& plane, double guess, const Use& use) const;

    /// The pieces of the beam as a curved one (CurvedBeam); of the flat triangle where that does not fall.
    /// It is all of the beam that comes to the footprint.
    void for_each_curved_piece(Id beam, const ReceiverPlane& plane, const Use& use) const;

  private:
    struct Visit;
    const BeamDivision& division(Id beam) const;
    const BeamDivision& division(Id beam, const BeamEnds& end, const Lazy<BeamDivision>& of) const;
    void find_sides(const Progress& progress);
    void divide(Id beam, const BeamEnds& end, BeamDivision& into) const;
    struct Part;
    const BeamDivision& division_for_now(Id beam, const Part& part,
                                         std::shared_ptr<const BeamDivision>& own) const;

    LightSpace space_;
    BeamSource source_;
    const Beams* beams_ = nullptr;
    double mean_light_ = 0;
    std::vector<std::array<Id, 3>> side_;             // of each beam, across from its ends: of side_middle_
    std::vector<BeamEnd> side_middle_;                // neighbours share them
    std::unique_ptr<Lazy<BeamDivision>[]> division_;  // by beam
    std::unique_ptr<std::atomic<std::size_t>> kept_;  // divisions that footprints asked for
    std::unique_ptr<RecentDivisions> recent_;         // and those beyond kMostKept
};

}  // namespace trilens
