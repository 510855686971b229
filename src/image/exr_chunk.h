// One block of scan lines as OpenEXR's zip keeps it: bytes sorted, differences taken, deflated; and whole
// files of such blocks read by many threads at once.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "base/image/image.h"

namespace trilens {

/// How many scan lines one block of zip holds.
inline constexpr int kZipRows = 16;

/// A channel's values of one block: four bytes each, row after row.
using BlockValues = const unsigned char*;

/// The block's bytes in the file, of `rows` x `columns` values in each channel; channels in the order of
/// their names. Values that deflate does not shrink are kept as they are, as the format asks.
/// Source: Kainz and others, Technical Introduction to OpenEXR; zlib streams as RFC 1950 has them.
std::vector<unsigned char> zip_block(std::span<const BlockValues> channels, int rows, int columns);

/// The way back, for zip_block and for other programs' blocks: fills `channels`, each with room for the
/// block's values. False where `packed` is damaged; what the channels hold is then undefined.
bool unzip_block(std::span<unsigned char> packed, std::span<unsigned char* const> channels, int rows,
                 int columns);

// The usual kind of file read by many threads at once: scan lines under zip, four bytes a value.

/// Fills the channels of `image`, whose data window and channels by name and type are those of the file's
/// only part. False where the file is of another kind, or anything in it is not as it should be: the caller
/// reads it then in the library's way, which says why.
bool read_zipped(const std::string& file, Image& image);

}  // namespace trilens
