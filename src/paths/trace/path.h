// The paths of light over optics: their names, their histories, and the ends that a sample sees.
#pragma once

#include <cstdint>

#include "base/raymesh/ray_mesh.h"
#include "base/raymesh/triangle_scene.h"

namespace trilens {

/// How light goes on at the first optic; names the layer that it is written to.
enum class Path : std::uint8_t { kDirect, kReflect, kRefract };

/// "direct", "reflect", "refract".
constexpr const char* path_name(Path path) {
    return path == Path::kReflect ? "reflect" : path == Path::kRefract ? "refract" : "direct";
}

/// What happens to a ray at an optic. kReflect: mirrored, or reflected by glass, in part or totally.
/// kTransmit: refracted into or out of glass. kPass: straight through a surface that lies inside a medium of
/// higher priority, where there is no interface.
enum class Event : std::uint8_t { kReflect, kTransmit, kPass };

/// "reflect", "transmit", "pass".
constexpr const char* event_name(Event event) {
    return event == Event::kReflect ? "reflect" : event == Event::kTransmit ? "transmit" : "pass";
}

/// One meeting of a ray with an optic. A history is a sequence of them.
struct Step {
    Id optic = kNone;  // index into PathWorld::optics
    Event event = Event::kReflect;

    bool operator==(const Step&) const = default;
};

/// One meeting of a path with an optic, and where it is, on the exact surface.
struct PathEvent {
    Id optic = kNone;  // index into PathWorld::optics
    Event event = Event::kReflect;
    bool front = true;  // the path comes to the surface's front
    Id face = kNone;    // of the surface: the cage's, or the primitive's
    Vec2 uv{0};         // in the face's domain, the unit square or triangle
    Vec3 point{0};      // world
    Vec3 normal{0};     // unit, world, on the surface's front side whichever side the path is on
};

/// Which of the three colours of light a path carries: light parts into them where glass disperses.
using Colours = std::int8_t;
inline constexpr Colours kAllColours = -1;  // else 0, 1, 2: red, green, blue

/// One end of a sample's path: the ray that leaves the last optic, and what it sees.
struct PathEnd {
    Path path = Path::kReflect;
    bool principal = true;  // the one that layers show: over mirrors, and through glass or, where it reflects
                            // totally, back into it
    Colours colours = kAllColours;
    std::uint16_t step_count = 0;  // meetings with optics, the first among them
    std::size_t first_step = 0;    // of SampleViews::steps
    Id node = kNone;               // of its optic's OpticPaths; kNone: it was followed by itself
    Id medium = kNone;             // the optic in whose glass the ray runs; kNone: in air
    Vec3 weight{1};                // of the light, for all that happens behind the first optic
    Ray ray;                       // world frame; not unit
    Hit hit;                       // of the scene's objects; unset where the ray meets none

    /// Square pixels of the film per unit of area at right angles to the ray where it meets the object:
    /// positive where orientations are as in a direct view, negative where they are mirrored; it changes its
    /// sign through infinity, at folds (the eye's caustics). Of the facet, in closed form; 0: not known.
    double magnification = 0;
};

}  // namespace trilens
