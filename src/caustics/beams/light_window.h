// A light as a camera: the windows through which it sees an optic, and the light that goes through parts of
// them.
#pragma once

#include <array>
#include <functional>
#include <span>
#include <vector>

#include "base/raymesh/ray_mesh.h"

namespace trilens {

/// A light whose rays start in one point or are parallel.
struct BeamSource {
    bool is_parallel = false;
    Vec3 position{0};          // where rays start, world; not of parallel ones
    Vec3 direction{0, 0, -1};  // unit, the way that parallel rays go
    /// Linear Rec.709 light that leaves along a unit direction: radiant intensity, or of parallel rays the
    /// irradiance at right angles to them.
    std::function<Vec3(const Vec3& direction)> strength;
};

/// A part of the light's film: places (u, v) in [-1, 1]^2 and the ray of each. Of a point the film is a plane
/// at distance 1 before it, of parallel rays a plane across them.
struct LightWindow {
    bool is_parallel = false;
    Vec3 origin{0};                 // the light; of parallel rays the middle of the window
    Vec3 axis{0};                   // to the window's middle; of parallel rays their direction, unit
    Vec3 across_u{0}, across_v{0};  // half of its sides

    /// Unit direction.
    Ray ray(const Vec2& place) const;
    /// How much of the light's film lies in a triangle of places: solid angle, or area across parallel rays.
    double measure(const Vec2& a, const Vec2& b, const Vec2& c) const;
    /// The same per unit of (u, v).
    double density(const Vec2& place) const;
};

/// One window that holds all of the points, a little wider; six windows around a light that stands among
/// them. `scene_size`: how far from the points parallel rays start. `points` is not empty.
std::vector<LightWindow> windows_on(const BeamSource& source, std::span<const Vec3> points,
                                    double scene_size);

}  // namespace trilens
