// Small scenes that come with the program: what `trilens scene example NAME` prints.
#pragma once

#include <span>

namespace trilens {

struct SceneExample {
    const char* name;
    const char* summary;  // one line
    const char* json;     // a whole scene file that names no other file
};

std::span<const SceneExample> scene_examples();

}  // namespace trilens
