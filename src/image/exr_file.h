// An OpenEXR file that is open for reading, part by part, its channels in the order in which they are
// presented.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "base/image/image.h"

namespace trilens {

/// What a part's header says of its shape.
struct ExrWindows {
    int display_x = 0, display_y = 0, display_width = 0, display_height = 0;
    int data_x = 0, data_y = 0, data_width = 0, data_height = 0;
};

class ExrFile {
  public:
    /// Throws InputError, with `name`, where the file or the bytes are no OpenEXR.
    explicit ExrFile(const std::string& file);
    ExrFile(std::span<const unsigned char> encoded, const std::string& name);
    ~ExrFile();
    ExrFile(const ExrFile&) = delete;
    ExrFile& operator=(const ExrFile&) = delete;

    int parts() const;
    std::string part_name(int part) const;  // empty where the file gives none
    ExrWindows windows(int part) const;
    bool is_deep(int part) const;
    /// Whether every channel has a value for every pixel of the data window.
    bool is_sampled_everywhere(int part) const;

    /// Every channel in its native type (half becomes float), in the order of in_layers, and the "trilens:"
    /// texts; the image's window is the data window, its film ends where the display window does. Throws
    /// InputError where the part is truncated, damaged, deep or sampled otherwise, or claims more than the
    /// file can hold.
    Image read(int part);

  private:
    struct State;
    std::unique_ptr<State> state_;
};

// In which order the channels of an OpenEXR file are presented.

/// The same names, layer by layer (what stands before the last dot); in a layer R G B, then where it has an
/// X beside a Y or a Z these three, then A Z, then all others by name. Where it has no such X, A and Z come
/// after B and Y. Long and other usual names (Red, Alpha, Depth ...) stand with the short ones.
std::vector<std::string> in_layers(std::vector<std::string> names);

}  // namespace trilens
