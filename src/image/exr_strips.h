// An OpenEXR file made strip by strip, so that a picture need not be held whole.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "base/image/image.h"

namespace trilens {

/// One part, scan lines, zip, float32 and uint32 channels in their native types to the last bit.
class ExrStrips {
  public:
    /// `layout`: the windows, the channels by name and type (their values are not looked at) and the texts of
    /// the header, whose names start with "trilens:". `name`: for messages. Throws OutputError.
    ExrStrips(const std::string& name, const Image& layout);

    /// Who takes the file's bytes and where they belong, most of them one after the other. What it throws,
    /// add() and finish() throw.
    using Writer = std::function<void(std::uint64_t at, std::span<const unsigned char> bytes)>;

    /// The same; the bytes are not held but handed on.
    ExrStrips(const std::string& name, const Image& layout, Writer writer);
    ~ExrStrips();
    ExrStrips(const ExrStrips&) = delete;
    ExrStrips& operator=(const ExrStrips&) = delete;

    /// The next `rows` rows of every channel of the layout, in its order; `first`: the first of them in the
    /// vectors. Strips of a multiple of 16 rows cost least. Throws OutputError.
    void add(const std::vector<Channel>& channels, int first, int rows);

    /// The file's bytes, once every row of the data window has come; none where a writer has them. They
    /// depend on the values alone, not on how they were cut into strips, nor on the number of threads. Throws
    /// OutputError.
    std::vector<unsigned char> finish();

  private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace trilens
