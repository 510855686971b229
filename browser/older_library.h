// What Emscripten's C++ library, of 2022 in Debian 12, does not have yet.
#pragma once

#include <bit>

#ifndef __cpp_lib_bit_cast
namespace std {
template <typename To, typename From>
constexpr To bit_cast(const From& from) noexcept {
    return __builtin_bit_cast(To, from);
}
}  // namespace std
#endif
