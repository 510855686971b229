// A digest of values of many kinds by FNV-1a with 64 bits (Fowler, Noll, Vo): tells whether inputs changed;
// no defence against someone who wants a collision.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "base/math/vec.h"

namespace trilens {

// FNV-1a with 64 bits: tells whether inputs changed; no defence against someone who wants a collision.
// Based on: Fowler, Noll, Vo, The FNV Non-Cryptographic Hash Algorithm (offset basis and prime for 64 bits).

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

// A digest of values of many kinds: tells whether inputs changed.

/// Values are hashed one by one, lists and texts each as one, and the hashes again at the end: no copy of
/// what is large. -0 and 0 are two values.
class Digest {
  public:
    void add(const std::string& text) { hashes_ += hash_text(text); }
    void add(const char* text) = delete;  // a bool otherwise
    void add(double value) { add_bytes(&value, sizeof value); }
    void add(const Vec2& v) { add_all(v.x, v.y); }
    void add(const Vec3& v) { add_all(v.x, v.y, v.z); }
    template <typename T>
    std::enable_if_t<std::is_integral_v<T> || std::is_enum_v<T>> add(T value) {
        const auto wide = static_cast<long long>(value);
        add_bytes(&wide, sizeof wide);
    }
    template <typename T>
    void add(const std::vector<T>& list) {
        static_assert(std::is_trivially_copyable_v<T>);
        add_bytes(list.data(), list.size() * sizeof(T));
    }
    template <typename T, std::size_t N>
    void add(const std::array<T, N>& list) {
        static_assert(std::is_trivially_copyable_v<T>);
        add_bytes(list.data(), N * sizeof(T));
    }
    template <typename... T>
    void add_all(const T&... values) {
        (add(values), ...);
    }

    /// 16 hexadecimal digits.
    std::string digits() const { return hash_text(hashes_); }

  private:
    void add_bytes(const void* bytes, std::size_t size) {
        hashes_ += hash_text({static_cast<const char*>(bytes), size});
    }
    std::string hashes_;
};

}  // namespace trilens
