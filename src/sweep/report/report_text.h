// A sweep in words and numbers, as its report says it, and its fits as a LaTeX table.
#pragma once

#include <string>
#include <vector>

#include "report/page.h"
#include "sweep/store/results.h"

namespace trilens {

/// What stands for the optics of a run together.
inline constexpr const char* kAllOptics = "all";

/// A column's value as a cell: whole, with three digits, of disp_coverage as a percentage; empty where there
/// is none.
std::string count_text(const MetricValues& metrics, const std::string& name);
std::string value_text(const MetricValues& metrics, const std::string& name);
std::string coverage_text(const MetricValues& metrics);

/// The displacement of all optics together; null where the run has no such layer.
const MetricValues* find_all(const RunRecord& run, const std::string& layer);

/// Orders of convergence, what resolution one pixel takes, what was measured.
std::vector<Headline> make_headlines(const SweepSummary& summary);

/// What was swept, in a sentence.
std::string summary_words(const SweepSummary& summary);

/// What plots would say with nothing in them: that all is exact.
std::vector<std::string> exact_sentences(const SweepSummary& summary);

/// That a scene was left out, and why.
std::string left_out_words(const LeftOutScene& scene);

/// Whether times are measurements; empty where all are.
std::string timing_warning(const SweepSummary& summary);

/// A tabular of the booktabs package, a row per group, layer and optic with the order of the mean
/// displacement, its 95 % confidence interval, the constant and the n for one pixel; of sweeps without
/// displacements the order of the colour error. To be read with \input.
std::string summary_latex(const SweepSummary& summary);

}  // namespace trilens
