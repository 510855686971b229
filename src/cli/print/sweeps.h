// What the sweep commands answer: a sweep's fits and failures, as text and as JSON.
#pragma once

#include <trilens/sweep.h>
#include <string>
#include <vector>

#include "terminal/command.h"

namespace trilens {

/// `report`: the page to name, empty for none. `left_out`: scenes that are in none of the sweeps. The exit
/// code tells of failed runs.
Answer answer_of(const std::vector<SweepSummary>& summaries, const std::string& report,
                 const std::vector<LeftOutScene>& left_out = {});

/// The scenes with the reasons, as a list.
Json left_out_json(const std::vector<LeftOutScene>& left_out);

/// The same of sweeps that may not be done, with the parts that are missing: as the indices of a job array
/// with a part per run.
Answer status_answer(const std::vector<SweepSummary>& summaries, const std::string& folder,
                     const std::vector<LeftOutScene>& left_out);

}  // namespace trilens
