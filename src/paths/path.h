// The paths of light over optics: their names, and the ends that a sample sees.
#pragma once

#include <cstdint>

#include "base/ray.h"
#include "base/triangle_scene.h"

namespace trilens {

/// How light goes on at the first optic; names the layer that it is written to.
enum class Path : std::uint8_t { kDirect, kReflect, kRefract };

/// "direct", "reflect", "refract".
constexpr const char* path_name(Path path) {
    return path == Path::kReflect ? "reflect" : path == Path::kRefract ? "refract" : "direct";
}

/// One end of a sample's path: the ray that leaves the last optic, and what it sees.
struct PathEnd {
    Path path = Path::kReflect;
    Id parent =
        kNone;  // the end (among the same sample's) from which this one goes on; kNone: the camera's ray
    Ray ray;    // world frame; not unit
    Hit hit;    // of the scene's objects; unset where the ray meets none
};

}  // namespace trilens
