// What `trilens bench` answers: both sides' times, their ratios, and what they disagree on.
#pragma once

#include <trilens/bench.h>

#include "terminal/command.h"

namespace trilens {

/// A table of medians, and the fields of `trilens.bench/1`.
Answer race_answer(const BenchResult& bench);

}  // namespace trilens
