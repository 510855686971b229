// A digest of values of many kinds: tells whether inputs changed (see hash.h).
#pragma once

#include <array>
#include <string>
#include <type_traits>
#include <vector>

#include "base/math/vec.h"
#include "base/util/hash.h"

namespace trilens {

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
