// Random legal scenes: every kind of optic, camera, light and material, at any scale, touching, nested, seen
// edge on and from inside. The same bytes are the same scene on every machine.
#pragma once

#include <string>
#include <string_view>

namespace trilens_fuzz {

struct RandomScene {
    std::string json;
    int other_resolution = 1;  // beside the scene's own
    bool is_unlit = false;     // no light, and nothing brighter than 1: then no pixel is
};

/// Each choice takes a byte or two; where there are no more, choices are the first of each list.
RandomScene make_random_scene(std::string_view bytes);

}  // namespace trilens_fuzz
