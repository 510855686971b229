// The page over several sweeps: each scene with its finest picture, the truth, the difference and the error
// plot.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "sweep/store/results.h"

namespace trilens {

/// Notes in `folder`/left-out.json which scenes the gallery is without; no file where there are none. Throws
/// InputError where a file of that name is none of a gallery's, OutputError.
void keep_left_out(const std::string& folder, const std::vector<LeftOutScene>& left_out);

/// What was noted. Throws InputError where the file is damaged.
std::vector<LeftOutScene> left_out_of_gallery(const std::string& folder);

/// Writes `folder`/report.html over sweeps that lie in folders below it, with a word on each scene that was
/// left out. Throws UsageError where the folder is a sweep's own, InputError as left_out_of_gallery does,
/// OutputError.
void write_sweep_gallery(const std::string& folder, std::span<const SweepSummary> summaries);

}  // namespace trilens
