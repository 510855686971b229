// Seconds of wall-clock time, for programs that say how long they took and how long it will still take.
//
//     const trilens::Stopwatch watch;
//     std::printf("%g s\n", watch.seconds());
#pragma once

#include "base/util/error.h"
