// runs.csv and displacement.csv: one row per run, and one row per run, optic and layer.
#include "sweep/store/sweep_folder.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <map>
#include <string_view>
#include <utility>
#include <vector>

#include "measure/compare.h"
#include "report/text.h"

namespace trilens {
namespace {

/// In the order of the file; those that are no metric are filled from the manifest and the plan.
std::vector<std::string> make_columns() {
    // clang-format off
    std::vector<std::string> columns = {
        "id", "scene", "camera", "mesh", "method", "truth", "n", "facets", "width", "height", "spp", "seed"};
    for (const ColourMetric& one : kColourMetrics)
        if (one.is_column) columns.push_back(std::string("rgb_") + one.name);
    columns.insert(columns.end(), {
        "disp_mean_px", "disp_p95_px", "disp_max_px", "disp_coverage", "disp_lost", "disp_missing", "disp_unmeasured", "false_hit", "false_miss",
        "nonfinite", "failed_px",
        "t_surface_s", "t_rays_s", "t_prepare_s", "t_draw_s", "t_shade_s", "t_write_s", "t_first_s", "t_spread_s",
        "t_trace_s", "t_total_s", "repeats", "peak_rss_mb", "threads", "jobs", "machine_used_by_others",
        "status", "exit_code", "image", "diff", "image_fnv1a",
        "coverage_mismatch", "object_mismatch", "primitive_mismatch"});
    // clang-format on
    return columns;
}

const std::vector<std::string>& run_columns() {
    static const std::vector<std::string> columns = make_columns();
    return columns;
}

constexpr std::array<std::string_view, 5> kAxesWithColumns = {"resolution", "scene", "camera", "engine",
                                                              "spp"};
constexpr std::array kDisplacementColumns = {
    "disp_mean_px",      "disp_p50_px",  "disp_p95_px",     "disp_p99_px",
    "disp_max_px",       "disp_pixels",  "disp_lost",       "disp_mean_off_folds_px",
    "disp_near_folds",   "disp_missing", "disp_unmeasured", "disp_coverage",
    "disp_beyond_radius"};

std::string row(const std::vector<std::string>& cells) {
    std::string line;
    for (std::size_t i = 0; i < cells.size(); ++i) line += (i ? "," : "") + csv_text(cells[i]);
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
    const auto along = [&](const char* axis, const std::string& otherwise) {
        const AxisValue* const value = find_coordinate(run.plan.at, axis);
        return value ? value->text : otherwise;
    };
    const std::string spp = along("/film/spp", std::to_string(subject.spp));
    return {{"id", run.plan.id},
            {"scene", along("scene", subject.scene)},
            {"camera", along("camera", subject.camera)},
            {"mesh", along("optic", subject.mesh)},
            {"method", along("engine", subject.method)},
            {"truth", subject.truth},
            {"n", run.plan.n() > 0 ? std::to_string(run.plan.n()) : ""},
            {"spp", along("spp", spp)},
            {"status", state_name(run.state)},
            {"exit_code", run.state == RunState::kMissing ? "" : std::to_string(run.exit_code)},
            {"image", is_done ? files + "/image.exr" : ""},
            {"diff", is_done ? files + "/diff.exr" : ""},
            {"image_fnv1a", run.image_hash}};
}

/// The axes that have no column of their own.
std::vector<std::string> further_axes(const SweepAxes& axes) {
    std::vector<std::string> names;
    for (const Axis& axis : axes.axes)
        if (std::ranges::find(kAxesWithColumns, axis.kind.name) == kAxesWithColumns.end())
            names.push_back(axis.kind.name);
    return names;
}

}  // namespace

std::string runs_csv(const SweepSummary& summary) {
    const std::vector<std::string> axes = further_axes(summary.manifest.axes);
    std::vector<std::string> header = {run_columns().begin(), run_columns().end()};
    header.insert(header.begin() + 1, axes.begin(), axes.end());
    std::vector<std::vector<std::string>> rows = {header};
    for (const RunRecord& run : summary.runs) {
        const std::map<std::string, std::string> words = run_words(summary, run);
        std::vector<std::string>& cells = rows.emplace_back();
        for (const std::string& column : header) {
            const auto word = words.find(column);
            const AxisValue* const value = find_coordinate(run.plan.at, column);
            cells.push_back(word != words.end() ? word->second
                            : value             ? value->text
                                                : metric_text(run.metrics, column));
        }
    }
    return text_of_rows(rows);
}

std::string swept_column(const std::string& axis) {
    return axis == "optic" ? "swept_optic" : axis;
}

std::string displacement_csv(const SweepSummary& summary) {
    std::vector<std::string> header = {"id", "n", "layer", "optic"};
    for (const Axis& axis : summary.manifest.axes.axes)
        if (axis.kind.name != "resolution") header.insert(header.end() - 2, swept_column(axis.kind.name));
    header.insert(header.end(), kDisplacementColumns.begin(), kDisplacementColumns.end());
    std::vector<std::vector<std::string>> rows = {header};
    for (const RunRecord& run : summary.runs)
        for (const OpticDisplacement& one : run.displacement) {
            if (is_only_optic(run.displacement, one)) continue;
            std::vector<std::string> cells = {run.plan.id,
                                              run.plan.n() > 0 ? std::to_string(run.plan.n()) : ""};
            for (const Axis& axis : summary.manifest.axes.axes) {
                const AxisValue* const value = find_coordinate(run.plan.at, axis.kind.name);
                if (axis.kind.name != "resolution") cells.push_back(value ? value->text : "");
            }
            cells.insert(cells.end(), {one.layer, one.optic});
            for (const char* column : kDisplacementColumns) cells.push_back(metric_text(one.metrics, column));
            rows.push_back(cells);
        }
    return text_of_rows(rows);
}

}  // namespace trilens
