// Light sampling in SIMD lanes: what one sample of a light sends to all points of a batch.
#pragma once

#include <cstddef>
#include <variant>

#include "shade/lights/light_sample.h"
#include "shade/shade.h"
#include "shade/shade_batch.h"

namespace trilens {

// One sample of a light, with all that is the same at every point.

/// Beyond the scene: a directional light's, an environment's.
struct FarLightLanes {
    Vec3 toward{0}, far{0};  // toward: unit; far: the same direction, longer than the scene
    double irradiance = 0;   // on a surface that faces it
};

/// A point's light, all around or in a cone about a direction.
struct PointLightLanes {
    Vec3 position{0};
    double intensity = 0;
    bool is_spot = false;
    Vec3 direction{0};                      // of the cone, unit
    double outer_cosine = 0, fall_off = 1;  // the outer cone's; the inner one's less that
};

/// A part of a flat light; shadow rays end at `target`.
struct FlatLightLanes {
    FlatPart part;
    Vec3 target{0};
};

/// A place on the disk that a point sees of a sphere.
struct SphereLightLanes {
    SphereLight light;
    double intensity = 0;
    Vec2 disk{0};  // of radius 1
};

/// A direction above a point's own plane: `above` has it about +Z.
struct HemisphereLightLanes {
    Vec3 above{0};  // unit
    double intensity = 0, count = 1;
    double far = 0;  // length of shadow rays
};

/// One sample of a light as all points of a batch are asked about it.
struct LightLanes {
    std::variant<FarLightLanes, PointLightLanes, FlatLightLanes, SphereLightLanes, HemisphereLightLanes> kind;
    Vec3 color{1};  // as LightSample has it
};

/// Sample `sample` < sample_count() of a light of the scene.
LightLanes light_lanes(const ShadeScene& scene, std::size_t light, std::size_t sample);

/// What would come of it, white, where nothing is in the way: the batch's way, irradiance and lit. The same
/// bits as light_sample() gives for each point.
void find_light(ShadeBatch& batch, const LightLanes& light, bool casts_shadows);

}  // namespace trilens
