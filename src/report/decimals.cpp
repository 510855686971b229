#include "report/decimals.h"

#include <array>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "base/error.h"

namespace trilens {
namespace {

/// Room for a number, however long: a double before its point has 309 digits at most.
constexpr std::size_t kNumberRoom = 330;

void append_as_library(std::string& text, double value, std::chars_format format, int digits) {
    char room[kNumberRoom];
    text.append(room, std::to_chars(room, room + kNumberRoom, value, format, digits).ptr);
}

constexpr int kMostDigits = 12;
constexpr std::size_t kUsualRoom = 40;

/// Within these bounds a number's last bit stands for 2^-64 or more, so that 64 bits hold what is behind its
/// point.
constexpr double kLeast = 1.0 / 2048, kMost = 1e6;

/// A number rounded to so many digits, at least 1, behind the point, of two that are as near to the even one.
struct Rounded {
    std::uint64_t whole = 0, share = 0;  // share / 10^digits
};
Rounded round_to(double magnitude, int digits) {
    constexpr std::array<std::uint64_t, kMostDigits + 1> kPower = {
        1,        10,        100,        1000,        10000,        100000,       1000000,
        10000000, 100000000, 1000000000, 10000000000, 100000000000, 1000000000000};
    __extension__ using Wide = unsigned __int128;
    Rounded result{static_cast<std::uint64_t>(magnitude), 0};
    // Both steps are exact.
    const double behind = magnitude - static_cast<double>(result.whole);
    const auto share = static_cast<std::uint64_t>(behind * 0x1p64);
    const std::uint64_t scale = kPower[static_cast<std::size_t>(digits)];
    const Wide product = Wide{share} * scale;
    constexpr std::uint64_t kHalf = std::uint64_t{1} << 63;
    const auto left = static_cast<std::uint64_t>(product);
    result.share = static_cast<std::uint64_t>(product >> 64);
    if (left > kHalf || (left == kHalf && result.share % 2 != 0)) ++result.share;
    if (result.share == scale) {
        result.share = 0;
        ++result.whole;
    }
    return result;
}

void require_digits(int digits, int least) {
    if (digits < least || digits > kMostDigits) throw UsageError("a number is written with up to 12 digits");
}

bool is_usual(double magnitude) {
    return magnitude >= kLeast && magnitude < kMost;
}

/// Sign, digits before the point, the point and the digits behind it; returns their end.
char* put(char* to, double value, const Rounded& rounded, int digits) {
    if (value < 0) *to++ = '-';
    to = std::to_chars(to, to + 20, rounded.whole).ptr;
    *to++ = '.';
    std::uint64_t left = rounded.share;
    for (int i = digits; i-- > 0; left /= 10) to[i] = static_cast<char>('0' + left % 10);
    return to + digits;
}

}  // namespace

void append_fixed(std::string& text, double value, int digits) {
    require_digits(digits, 0);
    const double magnitude = std::abs(value);
    if (digits == 0 || !is_usual(magnitude))
        return append_as_library(text, value, std::chars_format::fixed, digits);
    char room[kUsualRoom];
    text.append(room, put(room, value, round_to(magnitude, digits), digits));
}

void append_significant(std::string& text, double value, int digits) {
    require_digits(digits, 1);
    const double magnitude = std::abs(value);
    int before = 1;
    for (double power = 10; before < digits && magnitude >= power; power *= 10) ++before;
    // Where all digits are before the point it is left to the library, and what is below 1.
    if (before == digits || !is_usual(magnitude) || magnitude < 1)
        return append_as_library(text, value, std::chars_format::general, digits);
    char room[kUsualRoom];
    const int behind = digits - before;
    char* end = put(room, value, round_to(magnitude, behind), behind);
    while (end[-1] == '0') --end;
    if (end[-1] == '.') --end;
    text.append(room, end);
}

}  // namespace trilens
