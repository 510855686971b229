#include "image/exr_chunk.h"

#include <libdeflate.h>

#include <cstring>
#include <memory>

#include "base/check.h"

namespace trilens {
namespace {

/// Of libdeflate's levels: the fastest that still finds the repetitions of ids and flat colours.
constexpr int kLevel = 2;

struct FreeCompressor {
    void operator()(libdeflate_compressor* compressor) const { libdeflate_free_compressor(compressor); }
};

libdeflate_compressor& compressor_of_thread() {
    thread_local const std::unique_ptr<libdeflate_compressor, FreeCompressor> compressor(
        libdeflate_alloc_compressor(kLevel));
    TRILENS_CHECK(compressor, "a compressor needs a little memory");
    return *compressor;
}

/// One half of the sorted bytes under work: every second byte, each as its difference from the one before.
struct Half {
    unsigned char* to = nullptr;
    unsigned char before = 0;

    /// Takes bytes[0], bytes[2], ... of `count` pairs.
    void take(const unsigned char* bytes, std::size_t count) {
        constexpr int kBias = 128;
        to[0] = static_cast<unsigned char>(bytes[0] - before + kBias);
        for (std::size_t i = 1; i < count; ++i)
            to[i] = static_cast<unsigned char>(bytes[2 * i] - bytes[2 * i - 2] + kBias);
        to += count;
        before = bytes[2 * count - 2];
    }
};

/// Calls take(first byte, number of bytes) for each row of each channel, in the order of the file.
template <typename Take>
void for_each_piece(std::span<const BlockValues> channels, int rows, std::size_t row_bytes,
                    const Take& take) {
    for (std::size_t row = 0; row < static_cast<std::size_t>(rows); ++row)
        for (const BlockValues values : channels) take(values + row * row_bytes, row_bytes);
}

}  // namespace

std::vector<unsigned char> zip_block(std::span<const BlockValues> channels, int rows, int columns) {
    const std::size_t row_bytes = 4 * static_cast<std::size_t>(columns);
    const std::size_t size = row_bytes * static_cast<std::size_t>(rows) * channels.size();
    std::vector<unsigned char> sorted(size);
    // The second half goes on where the first one ends.
    const unsigned char last_even = channels.back()[row_bytes * static_cast<std::size_t>(rows) - 2];
    Half even{sorted.data()}, odd{sorted.data() + size / 2, last_even};
    for_each_piece(channels, rows, row_bytes, [&](const unsigned char* bytes, std::size_t count) {
        even.take(bytes, count / 2);
        odd.take(bytes + 1, count / 2);
    });
    // The very first byte stands as it is.
    sorted[0] = channels[0][0];

    std::vector<unsigned char> packed(size);
    packed.resize(
        libdeflate_zlib_compress(&compressor_of_thread(), sorted.data(), size, packed.data(), size - 1));
    if (!packed.empty()) return packed;
    for_each_piece(channels, rows, row_bytes, [&](const unsigned char* bytes, std::size_t count) {
        packed.insert(packed.end(), bytes, bytes + count);
    });
    return packed;
}

}  // namespace trilens
