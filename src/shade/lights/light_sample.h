// Light sampling: each kind of light as points or directions that stand for it, the same at every point of
// the scene's surfaces but for what the point itself sees of the light.
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "base/description/light.h"
#include "base/math/vec.h"

namespace trilens {

/// One of the samples of a light, as a point of a surface sees it.
struct LightSample {
    Vec3 toward{0};  // unit, to the light
    Vec3 target{0};  // where shadow rays end, world
    // On a surface that faces the sample, unhindered, of a white light; zero: nothing comes from there.
    double irradiance = 0;
    Vec3 color{1};      // of this sample beside the light's own
    double spread = 0;  // radians from the middle to the border of the part of the light that it stands for
};

/// A point that light comes to.
struct LitPoint {
    Vec3 position{0}, normal{0, 1, 0};  // normal: unit, on the side that is looked at
    double scene_size = 1;              // how far it is at most to what could stand in the way, about
};

/// The background as directions, each with the irradiance that it stands for.
struct EnvironmentSamples {
    Background background;  // that they are of, and how many were asked for
    int count = 0;
    std::vector<Vec3> toward, irradiance;  // toward: unit, world
};

/// The background's light as `count` directions or fewer, by median cut: regions of the sphere are divided
/// until there are as many, always that with most light, across its longer side, into halves of equal light;
/// each region's direction and irradiance are those of its vector irradiance, so that surfaces above whose
/// horizon it lies as a whole get exactly its light. Regions end at the texels of a picture of 512 x 256.
/// Source: Debevec, A Median Cut Algorithm for Light Probe Sampling, 2005; Arvo, The Irradiance Jacobian for
/// Partially Occluded Polyhedral Sources, 1994 (vector irradiance).
EnvironmentSamples environment_samples(const Background& background, int count);

/// The place in the unit square of one of `count` that cover it evenly: Hammersley's points, each in the
/// middle of its stratum along both sides. Source: Niederreiter, Random Number Generation and Quasi-Monte
/// Carlo Methods, 1992, chapter 3.
Vec2 stratified_place(std::size_t sample, std::size_t count);

// Samples of each kind; `sample` < the kind's count; `intensity`: the light's.

LightSample sample_light(const DirectionalLight& light, double intensity, const LitPoint& at,
                         std::size_t sample);
LightSample sample_light(const PointLight& light, double intensity, const LitPoint& at, std::size_t sample);
LightSample sample_light(const SpotLight& light, double intensity, const LitPoint& at, std::size_t sample);
LightSample sample_light(const RectangleLight& light, double intensity, const LitPoint& at,
                         std::size_t sample);
LightSample sample_light(const DiskLight& light, double intensity, const LitPoint& at, std::size_t sample);
LightSample sample_light(const SphereLight& light, double intensity, const LitPoint& at, std::size_t sample);
LightSample sample_light(const AmbientLight& light, double intensity, const LitPoint& at, std::size_t sample);

/// One sample of `environment`, which environment_samples() made for the light.
LightSample sample_environment(const EnvironmentSamples& environment, double intensity, const LitPoint& at,
                               std::size_t sample);

// What they share.

/// Two unit vectors at right angles to a unit `normal` and to each other; the three are right-handed.
/// Source: Duff et al., Building an Orthonormal Basis, Revisited, JCGT 2017.
struct TangentBasis {
    Vec3 first, second;
};
TangentBasis tangent_basis(const Vec3& normal);

/// Place `index` of a sequence that covers the unit square evenly however many are taken: an additive
/// recurrence of the plane's golden ratio. Source: Roberts, The Unreasonable Effectiveness of Quasirandom
/// Sequences, 2018.
Vec2 recurrent_place(std::size_t index);

/// A unit disk's place for one in the unit square, areas in proportion.
/// Source: Shirley, Chiu, A Low Distortion Map Between Disk and Square, 1997.
Vec2 disk_place(const Vec2& square);

/// A part of a flat light that shines to one side.
struct FlatPart {
    Vec3 position, normal;  // normal: unit, on the side that shines
    double radiance = 0, area = 0;
};

/// One sample's part of a flat light of this radiance.
FlatPart part_of(const RectangleLight& light, double radiance, std::size_t sample);
FlatPart part_of(const DiskLight& light, double radiance, std::size_t sample);

/// Where shadow rays to it end, in a scene of this size: before the light, which is an object, too.
Vec3 before_flat_light(const FlatPart& part, double scene_size);

/// What comes of it, taken for a point: radiance times area and cosine over the square of the distance.
LightSample from_flat_light(const FlatPart& part, const LitPoint& at);

/// A direction above the XY plane, unit, in proportion to the cosine from +Z: a disk's point under the
/// hemisphere (Malley). Source: Pharr, Jakob, Humphreys, Physically Based Rendering, 2023, A.5.3.
Vec3 hemisphere_direction(std::size_t sample, std::size_t count);

/// A spot light's cones: the cosine of the outer one, and what the inner one's is more than that.
struct ConeCosines {
    double outer = 0, fall_off = 1;
};
ConeCosines cone_cosines(const SpotLight& light);

/// How far shadow rays to ambient light go.
double occlusion_distance(const AmbientLight& light, double scene_size);

/// A direction of the cone about `axis` (unit) whose angle from it has this cosine, solid angles in
/// proportion to areas of the square. 1 - cosine is asked for: small cones keep their digits.
Vec3 cone_direction(const Vec3& axis, double one_minus_cosine, const Vec2& square);

}  // namespace trilens
