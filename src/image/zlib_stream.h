// Streams as zlib has them (RFC 1950), and the checksum of PNG: THE door to ISA-L.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace trilens {

/// How many bytes of `to` the zlib stream of `from` takes; 0 when it does not fit. `from` is not changed.
std::size_t deflate(std::span<unsigned char> from, std::span<unsigned char> to);

/// Whether the zlib stream `from` is whole and fills `to`. `from` is not changed.
bool inflate(std::span<unsigned char> from, std::span<unsigned char> to);

/// The same of gzip (RFC 1952), of one member or several, as many as fill `to`; `from` may go on after them.
bool inflate_gzip(std::span<unsigned char> from, std::span<unsigned char> to);

/// The checksum of PNG's chunks (PNG, Third Edition, W3C, annex D).
std::uint32_t png_checksum(std::span<const unsigned char> bytes);

}  // namespace trilens
