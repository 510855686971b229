// Reading and writing of a sweep's JSON files, with checks for damage.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "sweep/store/results.h"

namespace trilens {

std::string manifest_text(const SweepManifest& manifest, const std::vector<PlannedRun>& plan);
std::string plan_text(const std::vector<PlannedRun>& plan);

/// metrics.json of a finished run, error.json of a failed one.
std::string run_text(const RunRecord& run);

std::string summary_text(const SweepSummary& summary);

/// left-out.json of a gallery.
std::string left_out_text(const std::vector<LeftOutScene>& scenes);

/// Throw InputError(file, ...) where the text is damaged or of another kind.
std::vector<LeftOutScene> read_left_out(const std::string& file);
SweepManifest read_manifest(const std::string& file);
std::vector<PlannedRun> read_plan(const std::string& file, const SweepAxes& axes);

/// Fills everything but plan and image_hash from run_text; none where the text is damaged or tells of another
/// run.
std::optional<RunRecord> parse_run(const std::string& text, const PlannedRun& plan);

}  // namespace trilens
