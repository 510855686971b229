// What patches emit and reflect, and what the scene's lights bring to them, by the shading of pictures.
#pragma once

#include <span>
#include <vector>

#include "radiosity/element_mesh.h"

namespace trilens {

/// A point of one of World::objects' triangles, on one of its sides.
struct ShadedPoint {
    Id triangle = kNone;
    Vec2 barycentric{0};
    bool is_back = false;
};

/// The light that a world's lights bring, whatever the surface is made of: its shading with all white and
/// matt.
class DirectLight {
  public:
    /// The world must live longer. Throws Interrupted soon after `progress`, of the making of lights, says
    /// so, and what asks afterwards does, too.
    explicit DirectLight(const World& world, const Progress& progress = {});

    /// Irradiance over pi at the points, light over optics among it where lights have caustics. Thread-safe.
    std::vector<Vec3> at(std::span<const ShadedPoint> points) const;

  private:
    const World& world_;
    ShadeScene white_;
    const std::atomic<bool>* cancel_;
};

/// Means over one side of a patch.
struct PatchSide {
    Vec3 reflectance{0};  // of the matt part: radiance per irradiance over pi
    Vec3 emission{0};     // radiance
    Vec3 direct{0};       // irradiance over pi that the lights bring
};

/// Light within closed white walls never ends: what reflects more is taken to reflect this.
inline constexpr double kMostReflectance = 0.99;

struct PatchLight {
    std::vector<PatchSide> sides;  // two per element: see side_of
    std::size_t too_white = 0;     // elements that reflect more than kMostReflectance
    std::size_t glossy = 0;        // elements whose materials reflect other than in the matt way
};

/// Points of each side of a patch at which light and materials are looked at: the middles of its parts, of
/// which kPartsPerEdge lie along an edge.
inline constexpr int kPartsPerEdge = 3;
inline constexpr std::size_t kPointsPerSide = std::size_t{kPartsPerEdge} * kPartsPerEdge;

/// The elements as patches. The same for any number of threads. Throws Interrupted.
PatchLight patch_light(const World& world, const DirectLight& direct, const ElementMesh& mesh,
                       const Progress& progress = {});

}  // namespace trilens
