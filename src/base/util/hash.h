// FNV-1a with 64 bits: tells whether inputs changed; no defence against someone who wants a collision.
// Based on: Fowler, Noll, Vo, The FNV Non-Cryptographic Hash Algorithm (offset basis and prime for 64 bits).
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace trilens {

/// The hash of the bytes of `text`, as 16 lower-case hexadecimal digits.
inline std::string hash_text(std::string_view text) {
    std::uint64_t hash = 14695981039346656037ull;
    for (const char c : text) {
        hash ^= static_cast<unsigned char>(c);
        hash *= 1099511628211ull;
    }
    std::string digits(16, '0');
    for (int i = 15; i >= 0; --i, hash >>= 4)
        digits[static_cast<std::size_t>(i)] = "0123456789abcdef"[hash & 15];
    return digits;
}

}  // namespace trilens
