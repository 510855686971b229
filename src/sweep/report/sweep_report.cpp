// A sweep's plots and its report page.
#include "sweep/report/sweep_report.h"

#include <algorithm>
#include <cstddef>
#include <string>
#include <vector>

#include "base/files/files.h"
#include "base/util/format.h"
#include "report/page.h"
#include "sweep/report/sweep_pictures.h"
#include "sweep/store/sweep_folder.h"

namespace trilens {
namespace {

void leave_out_empty_columns(Report& report) {
    for (std::size_t column = report.table_columns.size(); column-- > 0;) {
        const auto is_empty = [&](const std::vector<std::string>& row) { return row[column].empty(); };
        if (!std::ranges::all_of(report.table_rows, is_empty)) continue;
        const auto at = static_cast<std::ptrdiff_t>(column);
        report.table_columns.erase(report.table_columns.begin() + at);
        for (std::vector<std::string>& row : report.table_rows) row.erase(row.begin() + at);
    }
}

void fill_table(const SweepSummary& summary, Report& report) {
    const std::vector<std::string> layers = layers_of(summary);
    for (const Axis& axis : summary.manifest.axes.axes)
        report.table_columns.push_back(axis.kind.name == "resolution" ? "n" : axis.kind.name);
    report.table_columns.insert(report.table_columns.end(), {"status", "facets"});
    for (const std::string& layer : layers)
        for (const char* what :
             {": measured", ": lost", ": missing", ": unmeasured", ": mean where measured [px]",
              ": mean off folds [px]", ": 95 % within [px]", ": max [px]"})
            report.table_columns.push_back(layer + what);
    for (const char* column : {"RGB RMSE", "PSNR [dB]", "SSIM", "time [s]", "spread [s]", "prepare [s]",
                               "draw [s]", "write [s]", "trace [s]", "peak memory [MB]"})
        report.table_columns.push_back(column);

    for (const RunRecord& run : summary.runs) {
        std::vector<std::string> row;
        for (const Coordinate& one : run.plan.at) row.push_back(one.value.text);
        row.insert(row.end(), {state_name(run.state), count_text(run.metrics, "facets")});
        for (const std::string& layer : layers) {
            const MetricValues* const all = find_all(run, layer);
            const MetricValues metrics = all ? *all : MetricValues();
            row.push_back(coverage_text(metrics));
            for (const char* name : {"disp_lost", "disp_missing", "disp_unmeasured"})
                row.push_back(count_text(metrics, name));
            for (const char* name : {"disp_mean_px", "disp_mean_off_folds_px", "disp_p95_px", "disp_max_px"})
                row.push_back(value_text(metrics, name));
        }
        for (const char* name : {"rgb_rmse", "rgb_psnr_db", "rgb_ssim", "t_total_s", "t_spread_s",
                                 "t_prepare_s", "t_draw_s", "t_write_s", "t_trace_s", "peak_rss_mb"})
            row.push_back(value_text(run.metrics, name));
        report.table_rows.push_back(row);
    }
    leave_out_empty_columns(report);
}

/// The plots as files, without those of an earlier report.
void write_plots(const SweepSummary& summary, Report& report) {
    const std::string folder = summary.folder + "/plots";
    const std::vector<NamedPlot> plots = make_plots(summary);
    std::vector<std::string> names;
    for (const NamedPlot& plot : plots)
        for (const char* end : {".svg", ".pdf"}) names.push_back(plot.name + end);
    OwnReportFiles own(summary.folder, "plots");
    own.will_write(names);
    for (const NamedPlot& plot : plots) {
        const std::string svg = plot_svg(plot.drawing);
        replace_text_file(folder + "/" + plot.name + ".svg", svg);
        replace_text_file(folder + "/" + plot.name + ".pdf", plot_pdf(plot.drawing));
        report.plots.push_back(svg);
    }
    own.remove_others();
}

}  // namespace

void write_sweep_report(const SweepSummary& summary, KeptPictures* kept) {
    const FileLock alone = FileLock::wait(plan_lock(summary.folder), LockKind::kOne, {});
    Report report;
    const SweepSubject& subject = summary.manifest.subject;
    report.title = subject.title.empty() ? "Sweep of " + subject.scene : subject.title;
    report.summary = summary_words(summary);
    report.headlines = make_headlines(summary);
    report.commands = subject.commands;
    report.versions = subject.versions;
    report.sentences = exact_sentences(summary);
    for (const LeftOutScene& one : subject.left_out) report.warnings.push_back(left_out_words(one));
    write_plots(summary, report);
    if (const std::size_t pages = plot_groups(group_runs(summary.manifest.axes, summary.runs)).size();
        pages > kMostPlotsOfAKind)
        report.warnings.push_back(fmt::format(
            "plots show the first {} of {} combinations; the tables have all", kMostPlotsOfAKind, pages));
    report.plots_note =
        "Displacement says how many pixels a seen point lies from where the truth shows it; it is known for "
        "the measured share of the pixels that show the layer in either picture. Lost pixels show what the "
        "truth does not, missing ones are the truth's that the projection does not show, unmeasured ones "
        "show "
        "the same as the truth, at a distance that nothing tells. Folds are where two "
        "images of a point meet: there displacements fall more slowly. A straight line is the law error = "
        "constant × n^−order fitted to the points. Runs that lost, miss or leave "
        "unmeasured more than a tenth of an optic's pixels take no part in its fit, nor does a plateau at "
        "the fine end.";
    fill_table(summary, report);
    fill_runs(summary, kMostBytesInPage, report, kept);
    if (const std::string warning = timing_warning(summary); !warning.empty())
        report.warnings.push_back(warning);
    report.pictures_note +=
        "The slider moves the border between the projected picture (left) and the truth (right). The "
        "colours of displacement are the same at all runs, 0.01 to 10 pixels; each run has its own factor "
        "for differences, stated at the picture. A click, a tap or Enter shows a picture at full size.";
    write_report(summary.folder + "/report.html", report);
}

}  // namespace trilens
