// Commands that are programs of their own, since they stand on libraries that not everyone wants.
#pragma once

#include <string>

#include "terminal/console.h"

namespace trilens {

/// Becomes that program, with the same words; beside this program, or where PATH has it. Throws
/// ComputationError, `missing` where it is not installed.
[[noreturn]] void become_program(const std::string& name, const std::string& missing, const Console& console);

}  // namespace trilens
