// Who takes a picture strip by strip, while it is drawn.
#pragma once

#include <functional>
#include <vector>

#include "base/image/image.h"

namespace trilens {

/// Both are called in order, from one thread.
struct StripSink {
    /// First: the picture's windows, its header, and its channels by name and type, without values.
    std::function<void(const Image& layout)> begin;
    /// Then the next `rows` rows of every channel, from the top; the vectors may be longer.
    std::function<void(const std::vector<Channel>& channels, int rows)> add;
};

}  // namespace trilens
