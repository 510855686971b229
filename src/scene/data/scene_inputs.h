// What a scene is loaded with beside its file: values of its JSON changed from outside, and a reader of
// pixels.
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <string>

#include "base/description/material.h"

namespace trilens {

// One value of a scene's JSON changed from outside.

/// One `--set /json/pointer=VALUE`. VALUE is JSON; what does not parse as JSON is taken as a string.
struct SceneOverride {
    std::string pointer;
    std::string value;
    bool removes = false;  // takes what the pointer names away, whatever the value; later entries move up
};

// How the scene room gets pixels without knowing the image room.

/// Returns a linear Rec.709 picture, or throws
/// an InputError that names the file. `encoded` overloads read a picture held in memory (GLB).
struct TextureReader {
    std::function<std::shared_ptr<const Texture>(const std::string& file)> from_file;
    std::function<std::shared_ptr<const Texture>(std::span<const unsigned char> encoded,
                                                 const std::string& name)>
        from_memory;
};

}  // namespace trilens
