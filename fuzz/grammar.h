// Bytes as choices: what the grammar of random scenes draws its words from.
#pragma once

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <string>
#include <string_view>

#include "base/math/vec.h"

namespace trilens_fuzz {

using trilens::Vec3;

/// Choices made by bytes; where they are used up, the first of every choice.
class Choices {
  public:
    explicit Choices(std::string_view bytes) : bytes_(bytes) {}

    int below(int count) { return count < 2 ? 0 : byte() % count; }
    bool chance(int of_256) { return byte() >= 256 - of_256; }  // not where no bytes are left
    double between(double low, double high) {
        const int upper = byte(), lower = byte();
        return low + (high - low) * (256 * upper + lower) / 65535.0;
    }
    double log_between(double low, double high) { return std::exp(between(std::log(low), std::log(high))); }
    Vec3 vector(double size) {
        const double x = between(-size, size), y = between(-size, size), z = between(-size, size);
        return {x, y, z};
    }
    Vec3 direction() {
        const Vec3 v = vector(1);
        return length(v) > 1e-3 ? normalize(v) : Vec3(0, 1, 0);
    }
    template <class T, std::size_t kCount>
    const T& of(const std::array<T, kCount>& list) {
        return list[static_cast<std::size_t>(below(static_cast<int>(kCount)))];
    }

  private:
    int byte() {
        if (bytes_.empty()) return 0;
        const int value = static_cast<unsigned char>(bytes_.front());
        bytes_.remove_prefix(1);
        return value;
    }
    std::string_view bytes_;
};

/// A text with its gaps filled. Written with braces, whose expressions every compiler evaluates from left to
/// right: each takes bytes, and arguments in parentheses would take them in another order elsewhere.
struct Phrase {
    template <class... Parts>
    Phrase(std::string_view form, const Parts&... parts) : text(fmt::format(fmt::runtime(form), parts...)) {}
    operator std::string() const { return text; }
    std::string text;
};

inline std::string text_of(const Vec3& v) {
    return fmt::format("[{}, {}, {}]", v.x, v.y, v.z);
}

/// The scene's size as a whole, of which all lengths are multiples.
struct Grammar {
    Choices choose;
    double scale = 1;

    std::string place(const Vec3& at) const { return text_of(scale * at); }
    std::string size(double low, double high) {
        return fmt::format("{}", scale * choose.log_between(low, high));
    }
    /// A number from a list in which the corner cases stand.
    double share() { return choose.of(std::array{1.0, 0.0, 0.5, 0.02, 0.98}); }
};

}  // namespace trilens_fuzz
