#include "image/zlib_stream.h"

#include <isa-l/crc.h>
#include <isa-l/igzip_lib.h>
#if defined(__x86_64__)
#include <immintrin.h>
#endif

#include <memory>
#include <vector>

#include "base/util/check.h"

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

}  // namespace

std::size_t deflate(std::span<unsigned char> from, std::span<unsigned char> to) {
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

namespace {

/// One stream: takes what is packed off `from`, and its place off `to`.
bool inflate_one(std::uint32_t kind, std::span<unsigned char>& from, std::span<unsigned char>& to) {
    const UpperHalves cleared;
    thread_local const auto state = std::make_unique<inflate_state>();
    isal_inflate_init(state.get());
    state->crc_flag = kind;
    state->next_in = from.data();
    state->avail_in = static_cast<std::uint32_t>(from.size());
    state->next_out = to.data();
    state->avail_out = static_cast<std::uint32_t>(to.size());
    if (isal_inflate_stateless(state.get()) != ISAL_DECOMP_OK || state->block_state != ISAL_BLOCK_FINISH)
        return false;
    from = from.last(state->avail_in);
    to = to.last(to.size() - state->total_out);
    return true;
}

}  // namespace

bool inflate(std::span<unsigned char> from, std::span<unsigned char> to) {
    return inflate_one(ISAL_ZLIB, from, to) && to.empty();
}

bool inflate_gzip(std::span<unsigned char> from, std::span<unsigned char> to) {
    do
        if (!inflate_one(ISAL_GZIP, from, to)) return false;
    while (!to.empty() && !from.empty());
    return to.empty();
}

std::uint32_t png_checksum(std::span<const unsigned char> bytes) {
    const UpperHalves cleared;
    return crc32_gzip_refl(0, bytes.data(), bytes.size());
}

}  // namespace trilens
