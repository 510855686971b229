// The version of trilens, stated once.
#pragma once

#define TRILENS_VERSION_MAJOR 0
#define TRILENS_VERSION_MINOR 3
#define TRILENS_VERSION_PATCH 0

namespace trilens {

/// "0.3.0": of the headers that were compiled. Before 1.0 a new minor version may change any interface.
inline constexpr const char* kVersion = "0.3.0";

}  // namespace trilens
