// The lights of a world whose light is followed over optics.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "caustics/beam_light.h"
#include "render/world/world.h"

namespace trilens {

/// Beams of the scene's lights.
struct CausticLights {
    PathWorld optics;                                               // as lights see them
    std::vector<std::vector<std::unique_ptr<BeamLight>>> by_light;  // its samples'; none: it is not followed
};

/// The light as sources whose rays start in a point or are parallel: its samples, of a sphere parts of its
/// surface; none for ambient light. `background`: what an environment's light is of.
std::vector<BeamSource> beam_sources(const Light& light, const Background& background);

/// Whether any light is followed over optics.
bool has_caustics(const World& world);

/// The beams of one light of the scene, of each of its samples, whether it says that it is followed or not.
/// Throws UsageError for a light that has none.
std::vector<std::unique_ptr<BeamLight>> make_beam_lights(const World& world, const PathWorld& optics,
                                                         std::size_t light, const BeamGridParams& params = {},
                                                         const Progress& progress = {});

/// Irradiance of all samples together.
Vec3 irradiance(const std::vector<std::unique_ptr<BeamLight>>& lights, const Receiver& receiver);

/// The scene's optics and depth, with first events of both kinds.
PathWorld optics_for_lights(const World& world);

/// Beams of all lights that are followed; made when first asked for.
std::unique_ptr<CausticLights> make_caustic_lights(const World& world);

/// Warns of what beams leave out.
void warn_of_lost_light(const World& world, const CausticLights& lights, const Warn& warn);

}  // namespace trilens
