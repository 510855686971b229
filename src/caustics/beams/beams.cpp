#include "caustics/beams/beams.h"

#include <algorithm>
#include <cmath>

namespace trilens {

std::vector<Vec3> Beams::flux_by_history() const {
    std::vector<Vec3> flux(histories.size(), Vec3(0));
    for (const LightBeam& beam : beams) flux[beam.history] += beam.flux;
    return flux;
}

/// Each optic's light arrives once: by reflection or refraction, whichever history has more of it (total
/// reflection ends the one, and without Fresnel's equations glass has only the other).
Vec3 Beams::flux_arriving() const {
    std::map<Id, Vec3> by_optic;
    for (const auto& [step, flux] : arriving) {
        Vec3& most = by_optic.try_emplace(step.first, Vec3(0)).first->second;
        most = glm::max(most, flux);
    }
    Vec3 sum(0);
    for (const auto& [optic, flux] : by_optic) sum += flux;
    return sum;
}

namespace {

/// Light of the beams whose ends are such, and of those of which some are as much as these carry.
template <typename Is>
Vec3 flux_where(const Beams& beams, const Is& is) {
    Vec3 sum(0);
    for (const LightBeam& beam : beams.beams) {
        const auto count =
            std::count_if(beam.end.begin(), beam.end.end(), [&](Id end) { return is(beams.ends[end]); });
        if (count == 3) {
            sum += beam.flux;
        } else if (count > 0) {
            sum +=
                beam_integral(beams, beam, [&](const BeamEnd& end) { return is(end) ? end.light : Vec3(0); });
        }
    }
    return sum;
}

}  // namespace

Vec3 Beams::flux_on_objects() const {
    return flux_where(*this, [](const BeamEnd& end) { return std::isfinite(end.object); });
}

Vec3 Beams::flux_away() const {
    return flux_where(
        *this, [](const BeamEnd& end) { return !std::isfinite(end.object) && !std::isfinite(end.optic); });
}

}  // namespace trilens
