// The files of one run: what makes it finished, and what it then says; its picture against the truth, as the
// columns of a sweep.
#pragma once

#include <string>
#include <vector>

#include "base/image/image.h"
#include "measure/displacement/reference_layers.h"
#include "sweep/store/results.h"

namespace trilens {

// One run's image against the truth, as the columns of a sweep.

struct MeasuredRun {
    MetricValues metrics;  // rgb_*, disp_* (of the worse layer, all optics), mismatches, nonfinite, failed_px
    std::vector<OpticDisplacement> displacement;  // each layer that the images have: all optics, then each
    std::vector<std::string> warnings;            // what could not be measured, and why
    Image diff;
};

/// Compares `test` with `truth`. Throws InputError where they cannot be compared.
MeasuredRun measure_run(const Image& test, const ReferenceLayers& truth,
                        const std::vector<SweptOptic>& optics);

/// The length of the displacement at each pixel of a diff image's data window.
struct DisplacementMap {
    std::string layer;
    std::vector<float> pixels;  // NaN: nothing to measure; infinite: lost
};

/// The maps that a diff image of measure_run holds.
std::vector<DisplacementMap> displacement_maps(const Image& diff);

// The files of one run: what makes it finished, and what it then says.

/// The file whose lock (file_lock.h) a process holds while it does or judges the run. Throws OutputError.
std::string run_lock(const std::string& folder, const PlannedRun& plan);

/// Tells apart the failures that the folder keeps of this run, one after the other; empty where it keeps
/// none.
std::string failure_stamp(const std::string& folder, const PlannedRun& plan);

/// What the folder says of this run. Finished only where DONE holds plan.hash and the hashes of files that
/// are as they were written; any damage makes it missing.
RunRecord load_run(const std::string& folder, const PlannedRun& plan);

/// Makes the run unfinished, before it is done again. A failure stays told until the new attempt has ended,
/// so that who sums up meanwhile does not miss the run. Throws OutputError.
void clear_run(const std::string& folder, const PlannedRun& plan);

/// Writes the run's picture and returns the seconds that took. The run is not finished by it. Throws
/// OutputError.
double store_image(const std::string& folder, const PlannedRun& plan, const Image& image);

/// The hash of the picture that store_image wrote. Throws OutputError where it cannot be read back.
std::string hash_of_image(const std::string& folder, const PlannedRun& plan);

/// Writes the difference, metrics.json and last DONE, then forgets an earlier failure. `run.image_hash` is
/// hash_of_image. Throws OutputError.
void store_run(const std::string& folder, const RunRecord& run, const Image& diff);

/// Writes error.json. Throws OutputError.
void store_failure(const std::string& folder, const RunRecord& run);

}  // namespace trilens
