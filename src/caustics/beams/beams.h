// Beams: what leaves the optics through one triangle of the light's window by one history (Heckbert and
// Hanrahan, Beam Tracing Polygonal Objects, 1984; Watt, Light-Water Interaction using Backward Beam Tracing,
// 1990).
#pragma once

#include <array>
#include <limits>
#include <map>
#include <utility>
#include <vector>

#include "caustics/beams/beam_grid.h"

namespace trilens {

/// One exact ray at a beam's corner.
struct BeamEnd {
    Vec2 place{0};               // on the light's window
    Vec3 origin{0};              // on the last optic
    Vec3 direction{0};           // unit
    Vec3 arriving{0}, light{0};  // see LightPath
    // Ways to the next optic, and to the first object before it; nothing is known where the latter is 0.
    double optic = std::numeric_limits<double>::infinity(), object = 0;
    double film = 0;  // of the light's film per unit of place: LightWindow::density
    // Area across the ray that a unit of places covers at distance t: spread[0] + t spread[1] + t^2
    // spread[2], signed; 0 where beams fold. By the mean of the beams' slopes around the end, of second order
    // in their size.
    std::array<double, 3> spread{};

    /// Whether it does not only go on to another optic.
    bool falls() const { return std::isfinite(object) || !std::isfinite(optic); }
    /// The light's film per area across the ray at distance t.
    double concentration(double t) const {
        return film / std::fabs(spread[0] + t * (spread[1] + t * spread[2]));
    }
};

struct LightBeam {
    std::array<Id, 3> end{};
    Id history = kNone;
    double measure = 0;  // of the light's film
    Id window = 0;       // of Beams::windows
    Vec3 flux{0};        // that leaves with it, as its parts' exact rays have it
    // Across from its ends, the exact rays in the middles of its sides: of Beams::middles; kNone: not known.
    std::array<Id, 3> middle{kNone, kNone, kNone};
};

struct Beams {
    std::vector<BeamEnd> ends;
    std::vector<BeamEnd> middles;  // rays that told whether to divide
    std::vector<LightBeam> beams;
    std::vector<LightHistory> histories;
    std::vector<LightWindow> windows;
    // Light that comes to the first optics, by what happens there.
    std::map<std::pair<Id, Event>, Vec3> arriving;
    bool divides =
        true;  // whether glass reflects a part of each ray, or each goes one way (no Fresnel's law)

    /// Light that leaves the last optic of each history (of `histories`): lumen, or watt, as the light's
    /// intensity has it.
    std::vector<Vec3> flux_by_history() const;
    /// Light that comes to the first optics.
    Vec3 flux_arriving() const;
};

/// A beam's part of the film times the mean of of(end) over its ends.
template <typename Of>
Vec3 beam_integral(const Beams& beams, const LightBeam& beam, const Of& of) {
    Vec3 sum(0);
    for (const Id end : beam.end) sum += of(beams.ends[end]);
    return beam.measure / 3 * sum;
}

/// Three rays and the part of the light's film between them.
struct BeamCorners {
    std::array<const BeamEnd*, 3> end{};
    double measure = 0;
};
inline BeamCorners corners_of(const Beams& beams, const LightBeam& beam) {
    return {{&beams.ends[beam.end[0]], &beams.ends[beam.end[1]], &beams.ends[beam.end[2]]}, beam.measure};
}

/// The beams of a divided window, which is divided further where a history lies hidden between two others,
/// added to `beams`, but those all of whose rays go on to another optic and
/// meet no object before. Triangles on which a history ends are cut where it does, which is found along their
/// sides to a 2^-12th of them for the brightest path, and to twice as much for half as bright a one. Throws
/// Interrupted soon after `progress` says so.
void add_beams(BeamGrid& grid, Beams& beams, const Progress& progress = {});

}  // namespace trilens
