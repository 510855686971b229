#include "image/exr_chunk.h"

#include <cstdint>
#include <cstring>
#include <memory>

#include "image/zlib_stream.h"

namespace trilens {
namespace {

/// What a difference of nothing is written as.
constexpr unsigned kDifferenceBias = 128;

/// One half of the sorted bytes under work: every second byte, each as its difference from the one before.
struct Half {
    unsigned char* to = nullptr;
    unsigned char before = 0;

    /// Takes bytes[0], bytes[2], ... of `count` pairs.
    void take(const unsigned char* bytes, std::size_t count) {
        to[0] = static_cast<unsigned char>(bytes[0] - before + kDifferenceBias);
        for (std::size_t i = 1; i < count; ++i)
            to[i] = static_cast<unsigned char>(bytes[2 * i] - bytes[2 * i - 2] + kDifferenceBias);
        to += count;
        before = bytes[2 * count - 2];
    }
};

/// The byte that differences lead to, from the byte `before` them.
unsigned char last_of(std::span<const unsigned char> differences, unsigned before) {
    unsigned sum = before;
    for (const unsigned char difference : differences) sum += difference - kDifferenceBias;
    return static_cast<unsigned char>(sum);
}

/// Calls take(first byte, number of bytes) for each row of each channel, in the order of the file.
template <typename Channels, typename Take>
void for_each_piece(const Channels& channels, int rows, std::size_t row_bytes, const Take& take) {
    for (std::size_t row = 0; row < static_cast<std::size_t>(rows); ++row)
        for (const auto values : channels) take(values + row * row_bytes, row_bytes);
}

}  // namespace

std::vector<unsigned char> zip_block(std::span<const BlockValues> channels, int rows, int columns) {
    const std::size_t row_bytes = 4 * static_cast<std::size_t>(columns);
    const std::size_t size = row_bytes * static_cast<std::size_t>(rows) * channels.size();
    // Two buffers that are not cleared before they are filled.
    const auto sorted = std::make_unique_for_overwrite<unsigned char[]>(size),
               smaller = std::make_unique_for_overwrite<unsigned char[]>(size - 1);
    // The second half goes on where the first one ends.
    const unsigned char last_even = channels.back()[row_bytes * static_cast<std::size_t>(rows) - 2];
    Half even{sorted.get()}, odd{sorted.get() + size / 2, last_even};
    for_each_piece(channels, rows, row_bytes, [&](const unsigned char* bytes, std::size_t count) {
        even.take(bytes, count / 2);
        odd.take(bytes + 1, count / 2);
    });
    // The very first byte stands as it is.
    sorted[0] = channels[0][0];

    const std::size_t deflated = deflate({sorted.get(), size}, {smaller.get(), size - 1});
    std::vector<unsigned char> packed(smaller.get(), smaller.get() + deflated);
    if (!packed.empty()) return packed;
    for_each_piece(channels, rows, row_bytes, [&](const unsigned char* bytes, std::size_t count) {
        packed.insert(packed.end(), bytes, bytes + count);
    });
    return packed;
}

bool unzip_block(std::span<unsigned char> packed, std::span<unsigned char* const> channels, int rows,
                 int columns) {
    const std::size_t row_bytes = 4 * static_cast<std::size_t>(columns);
    const std::size_t size = row_bytes * static_cast<std::size_t>(rows) * channels.size();
    if (packed.size() == size) {
        const unsigned char* from = packed.data();
        for_each_piece(channels, rows, row_bytes, [&](unsigned char* bytes, std::size_t count) {
            std::memcpy(bytes, from, count);
            from += count;
        });
        return true;
    }
    std::vector<unsigned char> sorted(size);
    if (packed.size() > size || !inflate(packed, sorted)) return false;

    // Every second byte comes from the second half, which goes on where the first one ends.
    const unsigned char *even = sorted.data(), *odd = sorted.data() + size / 2;
    unsigned even_byte = kDifferenceBias, odd_byte = last_of({even, size / 2}, kDifferenceBias);
    for_each_piece(channels, rows, row_bytes, [&](unsigned char* bytes, std::size_t count) {
        for (std::size_t i = 0; i < count; i += 2) {
            even_byte += *even++ - kDifferenceBias;
            odd_byte += *odd++ - kDifferenceBias;
            bytes[i] = static_cast<unsigned char>(even_byte);
            bytes[i + 1] = static_cast<unsigned char>(odd_byte);
        }
    });
    return true;
}

}  // namespace trilens
