// Random legal scenes: every kind of optic, camera, light and material, at any scale, touching, nested, seen
// edge on and from inside. The same bytes are the same scene with every compiler.
#pragma once

#include <string>
#include <string_view>

namespace trilens_fuzz {

struct RandomScene {
    std::string json;
    int other_resolution = 1;      // beside the scene's own
    bool has_exact_scales = true;  // by powers of two: its camera's rays are no roots, which round
    bool is_unlit = false;         // no light, and nothing brighter than 1: then no pixel is
};

/// Each choice takes a byte or two; where there are no more, choices are the first of each list. All lengths
/// are multiplied by `enlarged`, which a law of scales takes a power of two for.
RandomScene make_random_scene(std::string_view bytes, double enlarged = 1);

}  // namespace trilens_fuzz
