// One value of a scene's JSON changed from outside.
#pragma once

#include <string>

namespace trilens {

/// One `--set /json/pointer=VALUE`. VALUE is JSON; what does not parse as JSON is taken as a string.
struct SceneOverride {
    std::string pointer;
    std::string value;
    bool removes = false;  // takes what the pointer names away, whatever the value; later entries move up
};

}  // namespace trilens
