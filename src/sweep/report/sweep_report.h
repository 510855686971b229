// A sweep's plots and its report page.
#pragma once

#include <cstddef>

#include "sweep/store/results.h"

namespace trilens {

class KeptPictures;

inline constexpr std::size_t kMostBytesInPage = 50'000'000;  // of pictures; more lie beside the page

/// Writes plots/*.svg and report.html into summary.folder. Pictures that cannot be read are named in their
/// place with the reason; those in `kept` are not read. Throws OutputError.
void write_sweep_report(const SweepSummary& summary, KeptPictures* kept = nullptr);

}  // namespace trilens
