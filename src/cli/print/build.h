// What `trilens info` answers: the build, its libraries and the machine.
#pragma once

#include "terminal/command.h"

namespace trilens {

/// The fields of `trilens.info/1`, and a line for each.
Answer build_answer();

}  // namespace trilens
