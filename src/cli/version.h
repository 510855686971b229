// The program's version.
#pragma once

namespace trilens {

inline constexpr const char* kVersion = TRILENS_VERSION;

}  // namespace trilens
