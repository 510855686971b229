// Folders of one sweep from several machines joined into one.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "base/util/progress.h"

namespace trilens {

/// Copies what is finished in `parts` to `folder` and sums up nothing; what `folder` holds already counts as
/// a part. The plan is that of all parts together, the first part's first. A finished run counts only as
/// load_sweep trusts it; where two parts have one, the first is taken; a failed one is taken where no part
/// has finished it. Truths come with the runs. Returns how many runs were copied. Throws InputError where a
/// part is no sweep's folder, or is another sweep than the first, or holds results of other scenes or another
/// build (a run of one name and another hash); then nothing is copied. OutputError; UsageError where `folder`
/// is another sweep's.
std::size_t merge_folders(const std::vector<std::string>& parts, const std::string& folder,
                          const Progress& progress = {});

}  // namespace trilens
