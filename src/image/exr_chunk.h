// One block of scan lines as OpenEXR's zip keeps it: bytes sorted, differences taken, deflated.
#pragma once

#include <span>
#include <vector>

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

}  // namespace trilens
