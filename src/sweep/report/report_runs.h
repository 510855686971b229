// A section of a sweep's report for each run, with its pictures.
#pragma once

#include <cstddef>

#include "report/html.h"
#include "sweep/store/results.h"

namespace trilens {

class KeptPictures;

/// Adds sections of all runs; where their pictures would take more bytes in the page than `most_bytes`, these
/// lie beside it, in the folder pictures, which is else removed. Pictures in `kept` are taken from there, all
/// others made of the runs' files. Throws OutputError.
void fill_runs(const SweepSummary& summary, std::size_t most_bytes, Report& report,
               KeptPictures* kept = nullptr);

}  // namespace trilens
