// What the mirror shows: a checkered floor with a few things on it in the sun, and their colours.
#pragma once

#include <vector>

#include "base/raymesh/triangle_scene.h"
#include "camera/linear/linear_cameras.h"
#include "projector/scene/prepared_scene.h"

namespace trilens::browser {

struct LittleRoom {
    TriangleScene scene;
    std::vector<Vec3> colour;  // per object, linear
    std::vector<Vec3> normal;  // per corner of `scene`'s points: unit, for smooth things; zero: flat
    std::vector<Vec3> flat;    // per triangle: its plane's unit normal; zero: smooth
    std::unique_ptr<PreparedScene> ready;  // `scene`
    LinearCamera sun;          // looks down from the sun: its picture is the shadow map (Williams 1978)
    std::vector<Visible> lit;  // of the sun's film: what the sun reaches first
};

LittleRoom make_room();

/// The light that comes from the point of the hit towards whoever sees it; linear, 1 is white.
Vec3 light_of(const LittleRoom& room, const Hit& hit);

/// The light of the sky in this direction, any length.
Vec3 sky(const Vec3& direction);

}  // namespace trilens::browser
