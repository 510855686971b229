// The usual kind of file read by many threads at once: scan lines under zip, four bytes a value.
#pragma once

#include <string>

#include "base/image/image.h"

namespace trilens {

/// Fills the channels of `image`, whose data window and channels by name and type are those of the file's
/// only part. False where the file is of another kind, or anything in it is not as it should be: the caller
/// reads it then in the library's way, which says why.
bool read_zipped(const std::string& file, Image& image);

}  // namespace trilens
