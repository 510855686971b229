// TRILENS_CHECK: stops the program on a bug, with the place; never for bad input, never for "no answer".
#pragma once

namespace trilens {

/// Prints the failed condition with its place to stderr and aborts.
[[noreturn]] void check_failed(const char* condition, const char* file, int line, const char* why);

}  // namespace trilens

#define TRILENS_CHECK(condition, why) \
    ((condition) ? static_cast<void>(0) : ::trilens::check_failed(#condition, __FILE__, __LINE__, why))
