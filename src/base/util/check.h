// TRILENS_CHECK: an assertion that stays in release builds; for bugs, never for bad input or for "no answer".
#pragma once

namespace trilens {

/// Prints the failed condition with its place to stderr and aborts.
[[noreturn]] void check_failed(const char* condition, const char* file, int line, const char* why);

}  // namespace trilens

#define TRILENS_CHECK(condition, why) \
    ((condition) ? static_cast<void>(0) : ::trilens::check_failed(#condition, __FILE__, __LINE__, why))
