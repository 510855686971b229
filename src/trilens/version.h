// Which trilens this is, and what it stands on.
//
//     #include <trilens/version.h>
//     static_assert(TRILENS_VERSION_MAJOR == 0);
//     for (const std::string& library : trilens::library_versions()) std::puts(library.c_str());
#pragma once

#include <string>
#include <vector>

#include "base/util/version.h"

namespace trilens {

/// The version of the library that runs now, "0.3.0"; kVersion is that of the headers.
std::string version();

/// The libraries underneath with their versions: ray tracing, surfaces, images.
std::vector<std::string> library_versions();

/// Limits the threads of everything that follows, in this library and in those underneath; 0, and what is
/// below, means all that the machine has. Results do not depend on it.
void set_threads(int threads);

/// How many threads are used now, at least 1.
int threads();

}  // namespace trilens
