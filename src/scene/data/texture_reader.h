// How the scene room gets pixels without knowing the image room.
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <string>

#include "base/description/texture.h"

namespace trilens {

/// Returns a linear Rec.709 picture, or throws
/// an InputError that names the file. `encoded` overloads read a picture held in memory (GLB).
struct TextureReader {
    std::function<std::shared_ptr<const Texture>(const std::string& file)> from_file;
    std::function<std::shared_ptr<const Texture>(std::span<const unsigned char> encoded,
                                                 const std::string& name)>
        from_memory;
};

}  // namespace trilens
