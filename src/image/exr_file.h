// One block of scan lines as OpenEXR's zip keeps it: bytes sorted, differences taken, deflated; and whole
// files of such blocks read by many threads at once.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "base/image/image.h"
#include "base/util/overwritten.h"

namespace trilens {

/// How many scan lines one block of zip holds.
inline constexpr int kZipRows = 16;

/// A channel's values of one block: four bytes each, row after row.
using BlockValues = const unsigned char*;

/// What a block is made in, kept for the next.
struct BlockScratch {
    Overwritten<unsigned char> sorted, smaller;
};

/// The block's bytes in the file, of `rows` x `columns` values in each channel; channels in the order of
/// their names. Values that deflate does not shrink are kept as they are, as the format asks.
/// Source: Kainz and others, Technical Introduction to OpenEXR; zlib streams as RFC 1950 has them.
std::vector<unsigned char> zip_block(std::span<const BlockValues> channels, int rows, int columns,
                                     BlockScratch& scratch);

/// The way back, for zip_block and for other programs' blocks: fills `channels`, each with room for the
/// block's values. False where `packed` is damaged; what the channels hold is then undefined.
bool unzip_block(std::span<unsigned char> packed, std::span<unsigned char* const> channels, int rows,
                 int columns);

// The usual kind of file read by many threads at once: scan lines under zip, four bytes a value.

/// Fills the channels of `image`, whose data window and channels by name and type are those of the file's
/// only part. False where the file is of another kind, or anything in it is not as it should be: the caller
/// reads it then in the library's way, which says why.
bool read_zipped(const std::string& file, Image& image);

// An OpenEXR file that is open for reading, part by part, its channels in the order in which they are
// presented.

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

// An OpenEXR file made strip by strip, so that a picture need not be held whole.

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
