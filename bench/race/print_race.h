// What a race on a scene came to, as text and as JSON.
#pragma once

#include <string>

#include "bench/race/scene_race.h"

namespace trilens_bench {

/// A table for people.
std::string race_text(const BenchResult& bench);

/// One JSON object of schema trilens.bench/1: times in milliseconds, ratios above 1 where the projector is
/// faster.
std::string race_json(const BenchResult& bench);

}  // namespace trilens_bench
