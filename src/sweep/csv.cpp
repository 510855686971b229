// runs.csv and displacement.csv: one row per run, and one row per run, optic and layer.
#include "sweep/csv.h"

#include <array>
#include <cstddef>
#include <map>
#include <utility>
#include <vector>

#include "report/text.h"

namespace trilens {
namespace {

// In the order of the file; those that are no metric are filled from the manifest and the plan.
// clang-format off
constexpr std::array kColumns = {
    "id", "scene", "camera", "mesh", "method", "truth", "n", "facets", "width", "height", "spp", "seed",
    "rgb_mae", "rgb_rmse", "rgb_relmse", "rgb_psnr_db", "rgb_ssim", "rgb_flip", "rgb_max", "rgb_p95", "rgb_p99",
    "disp_mean_px", "disp_p95_px", "disp_max_px", "disp_coverage", "disp_lost", "disp_missing", "false_hit", "false_miss", "nonfinite", "failed_px",
    "t_tess_s", "t_project_s", "t_trace_s", "t_total_s", "peak_rss_mb", "threads", "isa",
    "status", "exit_code", "image", "diff", "image_fnv1a",
    "coverage_mismatch", "object_mismatch", "primitive_mismatch"};
// clang-format on
constexpr std::array kDisplacementColumns = {
    "disp_mean_px",    "disp_p50_px",  "disp_p95_px",   "disp_p99_px",
    "disp_max_px",     "disp_pixels",  "disp_lost",     "disp_mean_off_folds_px",
    "disp_near_folds", "disp_missing", "disp_coverage", "disp_beyond_radius"};

std::string cell(const std::string& text) {
    if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
    std::string quoted = "\"";
    for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
    return quoted + "\"";
}

std::string row(const std::vector<std::string>& cells) {
    std::string line;
    for (std::size_t i = 0; i < cells.size(); ++i) line += (i ? "," : "") + cell(cells[i]);
    return line + "\n";
}

/// The table without the columns that are empty but for their name, unless all are.
std::string text_of_rows(const std::vector<std::vector<std::string>>& rows) {
    std::vector<bool> is_used(rows[0].size(), rows.size() == 1);
    for (std::size_t i = 1; i < rows.size(); ++i)
        for (std::size_t column = 0; column < is_used.size(); ++column)
            if (!rows[i][column].empty()) is_used[column] = true;
    std::string text;
    for (const std::vector<std::string>& cells : rows) {
        std::vector<std::string> kept;
        for (std::size_t column = 0; column < cells.size(); ++column)
            if (is_used[column]) kept.push_back(cells[column]);
        text += row(kept);
    }
    return text;
}

std::string metric_text(const MetricValues& metrics, const std::string& name) {
    const auto found = metrics.find(name);
    return found == metrics.end() ? "" : shortest_text(found->second);
}

/// The cells of a run that are words or settings.
std::map<std::string, std::string> run_words(const SweepSummary& summary, const RunRecord& run) {
    const SweepSubject& subject = summary.manifest.subject;
    const bool is_done = run.state == RunState::kDone;
    const std::string files = "runs/" + run.plan.id;
    return {{"id", run.plan.id},
            {"scene", subject.scene},
            {"camera", subject.camera},
            {"mesh", subject.mesh},
            {"method", subject.method},
            {"truth", subject.truth},
            {"n", std::to_string(run.plan.n)},
            {"spp", std::to_string(subject.spp)},
            {"threads", std::to_string(subject.threads)},
            {"isa", subject.isa},
            {"status", state_name(run.state)},
            {"exit_code", run.state == RunState::kMissing ? "" : std::to_string(run.exit_code)},
            {"image", is_done ? files + "/image.exr" : ""},
            {"diff", is_done ? files + "/diff.exr" : ""},
            {"image_fnv1a", run.image_hash}};
}

}  // namespace

std::string runs_csv(const SweepSummary& summary) {
    std::vector<std::vector<std::string>> rows = {{kColumns.begin(), kColumns.end()}};
    for (const RunRecord& run : summary.runs) {
        const std::map<std::string, std::string> words = run_words(summary, run);
        std::vector<std::string>& cells = rows.emplace_back();
        for (const char* column : kColumns) {
            const auto word = words.find(column);
            cells.push_back(word != words.end() ? word->second : metric_text(run.metrics, column));
        }
    }
    return text_of_rows(rows);
}

std::string displacement_csv(const SweepSummary& summary) {
    std::vector<std::string> header = {"id", "n", "layer", "optic"};
    header.insert(header.end(), kDisplacementColumns.begin(), kDisplacementColumns.end());
    std::vector<std::vector<std::string>> rows = {header};
    for (const RunRecord& run : summary.runs)
        for (const OpticDisplacement& one : run.displacement) {
            std::vector<std::string> cells = {run.plan.id, std::to_string(run.plan.n), one.layer, one.optic};
            for (const char* column : kDisplacementColumns) cells.push_back(metric_text(one.metrics, column));
            rows.push_back(cells);
        }
    return text_of_rows(rows);
}

}  // namespace trilens
