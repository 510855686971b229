// The library of all other pictures, loaded when the first such picture is met: OpenImageIO brings hundreds
// of libraries with it, and most commands need none of them.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "base/description/material.h"

namespace trilens {

/// What the library can do; contracts as in image_io.h. It is built with this program, from src/pictures.
struct PictureLibrary {
    const char* version = nullptr;  // of trilens: another one's is refused
    std::shared_ptr<const Texture> (*read)(const std::string& file) = nullptr;
    std::shared_ptr<const Texture> (*decode)(std::span<const unsigned char> encoded,
                                             const std::string& name) = nullptr;
    void (*set_threads)(int threads) = nullptr;
};

/// The library, loaded where it is not yet: it lies beside the file of machine code that this function is in,
/// or where the system's loader looks. Null where it is missing, cannot be loaded or belongs to another
/// version; then `reason` says so.
const PictureLibrary* picture_library(std::string& reason);

/// The thread count of the library, now or once it is loaded; 0 means all.
void set_picture_threads(int threads);

/// A library's report as part of an Error's message: one line without a full stop; "unknown reason" where it
/// is empty.
std::string library_reason(const std::string& report);

}  // namespace trilens

/// The library's only symbol.
extern "C" const trilens::PictureLibrary* trilens_picture_library();
