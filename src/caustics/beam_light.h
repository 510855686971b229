// The light that beams bring to a surface: a caustic without noise.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "base/util/error.h"
#include "base/util/parallel.h"
#include "caustics/beam_tree.h"
#include "caustics/beams/beam_grid.h"
#include "caustics/beams/beams.h"
#include "caustics/exact_arrivals.h"
#include "caustics/footprint.h"
#include "caustics/receiver_faces.h"
#include "shade/receiver.h"

namespace trilens {

class PlaneBeams;
struct FluxEnds;
class RefinedBeams;

/// What was left out of a light's beams.
struct BeamLosses {
    CutPaths most;           // at any ray
    std::size_t coarse = 0;  // parts of the light's film that the tolerance would have divided further
};

/// One light's beams over all optics, ready to be asked. Thread-safe to read.
///
/// A beam falls on a receiver's plane as a quadratic triangle, exact at its corners and the middles of its
/// sides, in flat pieces. Each carries the light of its part of the film, whatever its shape: over a
/// footprint that is the share of its area inside, so light is finite at folds, where pieces have no area.
class BeamLight {
  public:
    /// `space` and what it points to must live longer. `outlines`: points on each optic's surface, by optic.
    /// Throws Interrupted soon after `progress` says so.
    BeamLight(const LightSpace& space, const BeamSource& source, const BeamGridParams& params,
              const std::vector<std::vector<Vec3>>& outlines, const Progress& progress = {});

    ~BeamLight();
    BeamLight(const BeamLight&) = delete;
    BeamLight& operator=(const BeamLight&) = delete;

    /// The triangles that receivers may name: what falls on the plane of one is gathered when it is first
    /// asked for, and kept. Before any is asked for.
    void receive_on(std::shared_ptr<const ReceiverFaces> faces);

    /// Gathers it now. Throws Interrupted soon after `progress` says so.
    void gather(const ReceiverSide& on, const Progress& progress) const;
    /// Whether that would find nothing to do.
    bool is_gathered(const ReceiverSide& on) const;
    /// Beams that it would look at.
    std::size_t count_near(const ReceiverSide& on) const;

    /// Irradiance at the receiver, linear Rec.709, of all that comes over optics: of the beams as they are,
    /// or where the receiver asks for it of beams divided by exact rays until they are flat at its footprint.
    /// Throws Interrupted as the receiver has it.
    Vec3 irradiance(const Receiver& receiver) const;

    /// Beams that hold the point and whose way is free.
    std::size_t path_count(const Receiver& receiver) const;

    /// The same by exact paths, each found by Newton's method from the beams that come near: to rounding
    /// where there is no fold, infinite at folds. The receiver's footprint is not asked. Paths to which no
    /// beam leads are missed.
    Vec3 exact_irradiance(const Receiver& receiver) const;
    std::vector<ExactArrival> exact_arrivals(const Receiver& receiver) const;

    /// Calls use(beam, flux) for what each of the wanted beams (by beam, nonzero) brings to the receiver's
    /// footprint, which it has.
    void for_each_flux(const Receiver& receiver, const std::vector<char>& wanted,
                       const std::function<void(Id beam, const Vec3& flux)>& use) const;

    const Beams& beams() const { return beams_; }
    /// `objects`: the triangles that stop light.
    FluxEnds flux_ends(const TriangleScene& objects) const;
    const BeamLosses& losses() const { return losses_; }

  private:
    struct Piece;
    template <typename Use>
    auto part_user(const ReceiverPlane& plane, const Receiver& receiver, const Use& use) const;
    template <typename Use>
    void for_each_arrival(const Receiver& receiver, const Use& use) const;
    template <typename Use>
    void for_each_arrival_of(Id beam, const ReceiverPlane& plane, const Receiver& receiver,
                             const Use& use) const;
    std::optional<Vec3> light_of(const Piece& piece, const FootprintPart& here,
                                 const Receiver& receiver) const;
    bool is_plain(const Piece& piece, const Receiver& receiver) const;
    bool is_plain(const ReceiverPlane& plane, const Receiver& receiver) const;
    Vec3 left_of(const LightHistory& history, const Vec3& origin, const Receiver& receiver) const;
    bool comes(const ExactArrival& arrival, const Receiver& receiver) const;
    bool gathers_on(const ReceiverSide& on) const;
    double reach_beyond_faces() const;
    const PlaneBeams* plane_beams(const Receiver& receiver) const;
    const PlaneBeams* plane_beams(const ReceiverSide& on, const Progress& progress) const;
    bool is_hidden(const Piece& piece, const Vec3& from, const Vec3& origin) const;

    LightSpace space_;
    BeamSource source_;
    double tolerance_ = 0;
    Beams beams_;
    BeamTree tree_;
    std::unique_ptr<RefinedBeams> refined_;
    std::shared_ptr<const ReceiverFaces> faces_;
    std::unique_ptr<Lazy<PlaneBeams>[]> on_face_;  // by face, and side
    BeamLosses losses_;
};

}  // namespace trilens
