// An OpenEXR file made strip by strip, so that a picture need not be held whole.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "base/image.h"

namespace trilens {

class FileReplacement;

/// One part, scan lines, zip, float32 and uint32 channels in their native types to the last bit.
class ExrStrips {
  public:
    /// `layout`: the windows, the channels by name and type (their values are not looked at) and the texts of
    /// the header, whose names start with "trilens:". `name`: for messages. `file`: where given, takes the
    /// bytes as they come; it must outlive this. Throws OutputError.
    ExrStrips(const std::string& name, const Image& layout, FileReplacement* file = nullptr);
    ~ExrStrips();
    ExrStrips(const ExrStrips&) = delete;
    ExrStrips& operator=(const ExrStrips&) = delete;

    /// The next `rows` rows of every channel of the layout, in its order; `first`: the first of them in the
    /// vectors. Strips of a multiple of 16 rows cost least. Throws OutputError.
    void add(const std::vector<Channel>& channels, int first, int rows);

    /// The file's bytes, once every row of the data window has come; none where a file takes them. They
    /// depend on the values alone, not on how they were cut into strips, nor on the number of threads. Throws
    /// OutputError.
    std::vector<unsigned char> finish();

  private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace trilens
