#include "image/exr_chunk.h"

#include <isa-l/igzip_lib.h>
#if defined(__x86_64__)
#include <immintrin.h>
#endif

#include <cstdint>
#include <cstring>
#include <memory>

#include "base/check.h"

namespace trilens {
namespace {

/// Of ISA-L's levels: the densest that costs no more than the one below it.
constexpr std::uint32_t kLevel = 2;
constexpr std::uint32_t kLevelBytes = ISAL_DEF_LVL2_DEFAULT;

/// Clears the upper halves of the vector registers. ISA-L leaves them as they are, and while they are not
/// empty every older vector instruction waits for what its target held before: numeric code after a file was
/// up to three times slower.
#if defined(__x86_64__)
__attribute__((target("avx"))) void clear_upper_halves() {
    _mm256_zeroupper();
}
#endif

struct UpperHalves {
    ~UpperHalves() {
#if defined(__x86_64__)
        static const bool has_any = __builtin_cpu_supports("avx");
        if (has_any) clear_upper_halves();
#endif
    }
};

/// What one thread deflates with, far too large for its stack.
struct Deflater {
    isal_zstream stream;
    std::vector<unsigned char> tables = std::vector<unsigned char>(kLevelBytes);
};

/// How many bytes of `to` the zlib stream of `from` takes; 0 when it does not fit.
std::size_t deflate(std::vector<unsigned char>& from, std::vector<unsigned char>& to) {
    const UpperHalves cleared;
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

/// Whether the zlib stream `from` is whole and fills `to`.
bool inflate(std::span<unsigned char> from, std::vector<unsigned char>& to) {
    const UpperHalves cleared;
    thread_local const auto state = std::make_unique<inflate_state>();
    isal_inflate_init(state.get());
    state->crc_flag = ISAL_ZLIB;
    state->next_in = from.data();
    state->avail_in = static_cast<std::uint32_t>(from.size());
    state->next_out = to.data();
    state->avail_out = static_cast<std::uint32_t>(to.size());
    return isal_inflate_stateless(state.get()) == ISAL_DECOMP_OK && state->block_state == ISAL_BLOCK_FINISH &&
           state->total_out == to.size();
}

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
