// What the sweep commands answer: a sweep's fits and failures, as text and as JSON.
#pragma once

#include <trilens/sweep.h>
#include <string>
#include <vector>

#include "terminal/command.h"

namespace trilens {

/// `report`: the page to name, empty for none. The exit code tells of failed runs.
Answer answer_of(const std::vector<SweepSummary>& summaries, const std::string& report);

}  // namespace trilens
