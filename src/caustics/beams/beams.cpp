#include "caustics/beams/beams.h"

namespace trilens {

std::vector<Vec3> Beams::flux_by_history() const {
    std::vector<Vec3> flux(histories.size(), Vec3(0));
    for (const LightBeam& beam : beams) flux[beam.history] += beam.flux;
    return flux;
}

/// Each optic's light arrives once. Where glass divides rays: by reflection or refraction, whichever history
/// has more of it (total reflection ends the one). Without Fresnel's equations each ray goes one way.
Vec3 Beams::flux_arriving() const {
    std::map<Id, Vec3> by_optic;
    for (const auto& [step, flux] : arriving) {
        Vec3& most = by_optic.try_emplace(step.first, Vec3(0)).first->second;
        most = divides ? glm::max(most, flux) : most + flux;
    }
    Vec3 sum(0);
    for (const auto& [optic, flux] : by_optic) sum += flux;
    return sum;
}

}  // namespace trilens
