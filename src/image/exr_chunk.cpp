#include "image/exr_chunk.h"

#include <isa-l/igzip_lib.h>

#include <cstdint>
#include <memory>

#include "base/check.h"

namespace trilens {
namespace {

/// Of ISA-L's levels: the densest that costs no more than the one below it.
constexpr std::uint32_t kLevel = 2;
constexpr std::uint32_t kLevelBytes = ISAL_DEF_LVL2_DEFAULT;

/// What one thread deflates with, far too large for its stack.
struct Deflater {
    isal_zstream stream;
    std::vector<unsigned char> tables = std::vector<unsigned char>(kLevelBytes);
};

/// How many bytes of `to` the zlib stream of `from` takes; 0 when it does not fit.
std::size_t deflate(std::vector<unsigned char>& from, std::vector<unsigned char>& to) {
    thread_local const auto deflater = std::make_unique<Deflater>();
    isal_zstream& stream = deflater->stream;
    isal_deflate_init(&stream);
    stream.level = kLevel;
    stream.level_buf = deflater->tables.data();
    stream.level_buf_size = kLevelBytes;
    stream.gzip_flag = IGZIP_ZLIB;
    stream.end_of_stream = 1;
    stream.next_in = from.data();
    stream.avail_in = static_cast<std::uint32_t>(from.size());
    stream.next_out = to.data();
    stream.avail_out = static_cast<std::uint32_t>(to.size());
    TRILENS_CHECK(isal_deflate(&stream) == COMP_OK, "the stream is set up as the library asks");
    return stream.internal_state.state == ZSTATE_END ? stream.total_out : 0;
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

    std::vector<unsigned char> packed(size - 1);
    packed.resize(deflate(sorted, packed));
    if (!packed.empty()) return packed;
    for_each_piece(channels, rows, row_bytes, [&](const unsigned char* bytes, std::size_t count) {
        packed.insert(packed.end(), bytes, bytes + count);
    });
    return packed;
}

}  // namespace trilens
