#include "image/png_chunk.h"

#include "image/zlib_stream.h"

namespace trilens {

void put32(Bytes& bytes, std::uint32_t value) {
    for (const int shift : {24, 16, 8, 0}) bytes.push_back(static_cast<unsigned char>(value >> shift));
}

std::uint32_t read32(std::span<const unsigned char> bytes) {
    return std::uint32_t{bytes[0]} << 24 | std::uint32_t{bytes[1]} << 16 | std::uint32_t{bytes[2]} << 8 |
           bytes[3];
}

void put_png_chunk(Bytes& file, const PngChunk& chunk) {
    put32(file, static_cast<std::uint32_t>(chunk.data.size()));
    const std::size_t first = file.size();
    file.insert(file.end(), chunk.type.begin(), chunk.type.end());
    file.insert(file.end(), chunk.data.begin(), chunk.data.end());
    put32(file, png_checksum(std::span(file).subspan(first)));
}

}  // namespace trilens
