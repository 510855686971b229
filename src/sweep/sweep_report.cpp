// A sweep's plots and its report page.
#include "sweep/sweep_report.h"

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <set>
#include <string>
#include <system_error>

#include "base/error.h"
#include "base/file_bytes.h"
#include "base/files.h"
#include "base/format.h"
#include "base/parallel.h"
#include "report/html.h"
#include "report/text.h"
#include "sweep/fit_runs.h"
#include "sweep/plot_groups.h"
#include "sweep/sweep_pictures.h"
#include "sweep/sweep_plots.h"

namespace trilens {
namespace {

constexpr const char* kAll = "all";
constexpr std::size_t kMostOpen = 12;                 // runs; of more only titles show until they are opened
constexpr std::size_t kMostBytesInPage = 50'000'000;  // of pictures; more lie beside the page
constexpr std::size_t kBatch = 64;                    // runs whose pictures are made at once

std::string count_text(const MetricValues& metrics, const std::string& name) {
    const std::optional<double> value = find_value(metrics, name);
    return value ? fixed_text(*value, 0) : "";
}

std::string value_text(const MetricValues& metrics, const std::string& name) {
    const std::optional<double> value = find_value(metrics, name);
    return value ? rounded_text(*value, 3) : "";
}

std::string coverage_text(const MetricValues& metrics) {
    const std::optional<double> share = find_value(metrics, "disp_coverage");
    return share ? percent_text(*share) : "";
}

const MetricValues* find_all(const RunRecord& run, const std::string& layer) {
    for (const OpticDisplacement& one : run.displacement)
        if (one.layer == layer && one.optic == kAll) return &one.metrics;
    return nullptr;
}

/// "23", or "230 (extrapolated)" where no run was that fine.
std::string resolution_text(const SweepFit& fit, std::optional<double> n) {
    if (!n) return "—";
    double finest = 0;
    for (const SweepPoint& point : fit.points) finest = std::max(finest, point.n);
    return "n = " + rounded_text(*n, 6) + (*n > finest ? " (extrapolated)" : "");
}

std::vector<Headline> layer_headlines(const SweepSummary& summary, const std::string& layer) {
    const SweepFit* const fit = find_fit(summary.fits, layer, kAll, "disp_mean_px");
    if (!fit) return {};
    const std::string range = measured_range(summary, layer);
    const Headline measured =
        fit->coverage
            ? Headline{percent_text(*fit->coverage),
                       layer + ": measured at least, in the runs behind the order (in all: " + range + ")"}
            : Headline{range, layer + ": of its pixels measured"};
    if (is_exact(*fit))
        return {{"exact", layer + ": every displacement that was measured is zero"}, measured};

    std::vector<Headline> headlines;
    headlines.push_back({fit->order ? fixed_text(*fit->order, 2) : "—", layer + ": order of convergence"});
    const SweepFit* const off = find_fit_off_folds(summary.fits, layer, kAll);
    if (off && off->order) headlines.push_back({fixed_text(*off->order, 2), layer + ": order off the folds"});
    if (fit->n_for_1px)
        headlines.push_back(
            {resolution_text(*fit, fit->n_for_1px), layer + ": for a mean of 1 px where measured"});
    if (fit->n_for_half_px)
        headlines.push_back(
            {resolution_text(*fit, fit->n_for_half_px), layer + ": for a mean of 0.5 px where measured"});
    headlines.push_back(measured);
    return headlines;
}

/// The orders of all groups together: "1.98 to 2.03".
std::vector<Headline> orders_headlines(const SweepSummary& summary, const std::string& layer) {
    std::optional<double> least, most;
    for (const SweepFit& fit : summary.fits)
        if (fit.layer == layer && fit.optic == kAll && fit.metric == "disp_mean_px" && fit.order) {
            least = std::min(least.value_or(*fit.order), *fit.order);
            most = std::max(most.value_or(*fit.order), *fit.order);
        }
    std::vector<Headline> headlines;
    if (least)
        headlines.push_back({fixed_text(*least, 2) == fixed_text(*most, 2)
                                 ? fixed_text(*least, 2)
                                 : fixed_text(*least, 2) + " to " + fixed_text(*most, 2),
                             layer + ": orders of convergence of the groups"});
    headlines.push_back({measured_range(summary, layer), layer + ": of its pixels measured"});
    return headlines;
}

std::vector<Headline> make_headlines(const SweepSummary& summary) {
    std::vector<Headline> headlines;
    const bool has_groups = group_runs(summary.manifest.axes, summary.runs).size() > 1;
    for (const std::string& layer : layers_of(summary))
        for (const Headline& headline : orders_headlines(summary, layer))
            if (has_groups) headlines.push_back(headline);
    for (const std::string& layer : layers_of(summary))
        for (const Headline& headline : layer_headlines(summary, layer))
            if (!has_groups) headlines.push_back(headline);
    headlines.push_back(
        {std::to_string(summary.count(RunState::kDone)) + " of " + std::to_string(summary.runs.size()),
         "runs finished"});
    return headlines;
}

std::string summary_words(const SweepSummary& summary) {
    const SweepSubject& subject = summary.manifest.subject;
    std::string words = fmt::format("The {} projection of {} against its ray-traced {} truth", subject.method,
                                    subject.scene, subject.truth);
    if (!subject.camera.empty()) words += ", camera " + subject.camera;
    for (const RunRecord& run : summary.runs)
        if (run.state == RunState::kDone) {
            words += ", " + count_text(run.metrics, "width") + " × " + count_text(run.metrics, "height") +
                     " pixels";
            break;
        }
    for (const Axis& axis : summary.manifest.axes.axes)
        if (axis.kind.name == "spp" || axis.kind.name == "scene" || axis.kind.name == "/film/spp")
            return words + ".";
    words += subject.spp == 1 ? ", one sample each." : fmt::format(", {0} × {0} samples each.", subject.spp);
    return words;
}

/// What plots would say with nothing in them.
std::vector<std::string> exact_sentences(const SweepSummary& summary) {
    std::vector<std::string> sentences;
    for (const std::string& layer : layers_of(summary)) {
        const SweepFit* const fit = find_fit(summary.fits, layer, kAll, "disp_mean_px");
        const bool is_all_exact = std::ranges::all_of(summary.fits, [&](const SweepFit& one) {
            return one.layer != layer || one.optic != kAll || one.metric != "disp_mean_px" || is_exact(one);
        });
        if (!fit || !is_all_exact) continue;
        double lost = 0, missing = 0;
        for (const RunRecord& run : summary.runs)
            if (const MetricValues* const all = find_all(run, layer)) {
                lost += find_value(*all, "disp_lost").value_or(0);
                missing += find_value(*all, "disp_missing").value_or(0);
            }
        sentences.push_back(fmt::format(
            "{}: exact. In all {} runs every displacement that was measured is zero, over {} of the pixels, "
            "with {} lost and {} missing in all runs together.",
            layer, summary.count(RunState::kDone), measured_range(summary, layer), fixed_text(lost, 0),
            fixed_text(missing, 0)));
    }
    const SweepFit* const colour = find_fit(summary.fits, "", kAll, "rgb_rmse");
    const bool is_colour_exact = std::ranges::all_of(
        summary.fits, [](const SweepFit& one) { return one.metric != "rgb_rmse" || is_exact(one); });
    if (colour && is_colour_exact) sentences.push_back("Every colour is the truth's to the last bit.");
    return sentences;
}

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
        for (const char* what : {": measured", ": lost", ": missing", ": mean where measured [px]",
                                 ": mean off folds [px]", ": 95 % [px]", ": max [px]"})
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
            for (const char* name : {"disp_lost", "disp_missing"}) row.push_back(count_text(metrics, name));
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

Facts run_facts(const RunRecord& run) {
    Facts facts;
    for (const OpticDisplacement& one : run.displacement) {
        if (run.displacement.size() > 1 && one.optic == kAll) continue;
        const std::string mean = value_text(one.metrics, "disp_mean_px");
        facts.emplace_back(
            one.layer + ", " + one.optic,
            mean.empty() ? "no displacement could be measured"
                         : "mean " + mean + " px, 95 %: " + value_text(one.metrics, "disp_p95_px") + " px");
        facts.emplace_back(one.layer + ", " + one.optic + ", measured", measured_text(one.metrics));
    }
    facts.emplace_back("RGB RMSE", value_text(run.metrics, "rgb_rmse"));
    facts.emplace_back("largest colour difference", value_text(run.metrics, "rgb_max"));
    facts.emplace_back("time", value_text(run.metrics, "t_total_s") + " s");
    return facts;
}

ReportRun run_section(const std::string& folder, const RunRecord& run) {
    ReportRun section;
    section.title = point_text(run.plan.at);
    section.warnings = run.warnings;
    if (run.state == RunState::kFailed) {
        section.error = "failed (exit code " + std::to_string(run.exit_code) + "): " + run.error;
        return section;
    }
    if (run.state == RunState::kMissing) {
        section.error = "not done yet";
        return section;
    }
    section.pictures = run_pictures(folder, run);
    section.facts = run_facts(run);
    return section;
}

std::size_t bytes_of(const ReportRun& run) {
    std::size_t bytes = 0;
    for (const PagePicture& picture : run.pictures) bytes += picture.png.size() * 4 / 3;
    return bytes;
}

/// Pictures as files beside the page, which then links them.
void put_beside(const std::string& folder, const std::string& id, ReportRun& run) {
    int count = 0;
    for (PagePicture& picture : run.pictures) {
        if (picture.png.empty() || !picture.file.empty()) continue;
        picture.file = fmt::format("pictures/{}-{}.png", id, ++count);
        replace_file(folder + "/" + picture.file, picture.png);
        picture.png.clear();
    }
}

/// Of the folder of an earlier, larger report.
void remove_pictures(const std::string& folder) {
    std::error_code failure;
    std::filesystem::remove_all(folder + "/pictures", failure);
    if (failure) throw OutputError(folder + "/pictures", "cannot be removed: " + failure.message());
}

/// Sections of all runs; where their pictures would make the page too large to open, these lie beside it.
void fill_runs(const SweepSummary& summary, Report& report) {
    const std::vector<RunRecord>& runs = summary.runs;
    report.runs.resize(runs.size());
    remove_pictures(summary.folder);
    std::size_t bytes = 0, embedded = 0;
    for (std::size_t from = 0; from < runs.size(); from += kBatch) {
        const std::size_t to = std::min(runs.size(), from + kBatch);
        // Decoding and encoding pictures is most of a report's time.
        parallel_for(to - from, 1, [&](std::size_t first, std::size_t last) {
            for (std::size_t i = from + first; i < from + last; ++i) {
                report.runs[i] = run_section(summary.folder, runs[i]);
                report.runs[i].is_folded = runs.size() > kMostOpen;
                report.runs[i].row = static_cast<int>(i);
            }
        });
        for (std::size_t i = from; i < to; ++i) bytes += bytes_of(report.runs[i]);
        if (bytes <= kMostBytesInPage) continue;
        make_folder(summary.folder + "/pictures");
        for (; embedded < to; ++embedded)
            put_beside(summary.folder, runs[embedded].plan.id, report.runs[embedded]);
    }
    if (const std::size_t missing = summary.count(RunState::kMissing))
        report.warnings.push_back(std::to_string(missing) + " of the runs are not done yet");
    if (const std::size_t failed = summary.count(RunState::kFailed))
        report.warnings.push_back(std::to_string(failed) + " of the runs failed; each says why below");
    if (runs.size() > kMostOpen) report.pictures_note = "A click on a run shows its pictures. ";
    if (embedded > 0) report.pictures_note += "The pictures lie in the folder pictures beside this page. ";
}

/// The plots as files, without those of an earlier report.
void write_plots(const SweepSummary& summary, Report& report) {
    namespace fs = std::filesystem;
    const std::string folder = summary.folder + "/plots";
    make_folder(folder);
    std::set<std::string> written;
    for (const NamedPlot& plot : make_plots(summary)) {
        const std::string svg = plot_svg(plot.drawing), pdf = plot_pdf(plot.drawing);
        replace_text_file(folder + "/" + plot.name + ".svg", svg);
        replace_text_file(folder + "/" + plot.name + ".pdf", pdf);
        replace_text_file(folder + "/" + plot.name + ".vl.json", plot.vega_lite);
        for (const char* end : {".svg", ".pdf", ".vl.json"}) written.insert(plot.name + end);
        report.plots.push_back(svg);
    }
    std::vector<std::string> stale;
    std::error_code unreadable;
    for (fs::directory_iterator entry(folder, unreadable), end; !unreadable && entry != end;
         entry.increment(unreadable)) {
        const std::string name = entry->path().filename().string(), kind = entry->path().extension().string();
        const bool is_plot = kind == ".svg" || kind == ".pdf" || name.ends_with(".vl.json");
        if (is_plot && written.count(name) == 0) stale.push_back(entry->path().string());
    }
    for (const std::string& file : stale) remove_file(file);
}

/// Whether times are measurements; empty where all are.
std::string timing_warning(const SweepSummary& summary) {
    std::size_t parallel = 0, shared = 0, done = summary.count(RunState::kDone);
    for (const RunRecord& run : summary.runs) {
        if (run.state != RunState::kDone || is_timed_alone(run)) continue;
        ++(find_value(run.metrics, "jobs").value_or(1) > 1 ? parallel : shared);
    }
    std::string words;
    if (parallel > 0)
        words = fmt::format("{} of {} runs were drawn while others of this sweep ran (-j)", parallel, done);
    if (shared > 0)
        words += fmt::format("{}{} of {} runs shared the machine with other programs",
                             words.empty() ? "" : "; ", shared, done);
    return words.empty() ? "" : words + ": their times are no measurements and stand in no plot beside such";
}

}  // namespace

void write_sweep_report(const SweepSummary& summary) {
    Report report;
    const SweepSubject& subject = summary.manifest.subject;
    report.title = subject.title.empty() ? "Sweep of " + subject.scene : subject.title;
    report.summary = summary_words(summary);
    report.headlines = make_headlines(summary);
    report.commands = subject.commands;
    report.versions = subject.versions;
    report.sentences = exact_sentences(summary);
    write_plots(summary, report);
    if (const std::size_t pages = plot_groups(group_runs(summary.manifest.axes, summary.runs)).size();
        pages > kMostPlotsOfAKind)
        report.warnings.push_back(fmt::format(
            "plots show the first {} of {} combinations; the tables have all", kMostPlotsOfAKind, pages));
    report.plots_note =
        "Displacement says how many pixels a seen point lies from where the truth shows it; it is known for "
        "the measured share of the pixels that show the layer in either picture. Lost pixels show what the "
        "truth does not, missing ones are the truth's that the projection does not show. Folds are where two "
        "images of a point meet: there displacements fall more slowly. A straight line is the law error = "
        "constant × n^−order fitted to the points. Runs that lost or miss "
        "more than a tenth of an optic's pixels take no part in its fit, nor does a plateau at the fine end.";
    fill_table(summary, report);
    fill_runs(summary, report);
    if (const std::string warning = timing_warning(summary); !warning.empty())
        report.warnings.push_back(warning);
    report.pictures_note +=
        "The slider moves the border between the projected picture (left) and the truth (right). Each run "
        "has its own colours for displacement and its own factor for differences, both stated at the "
        "picture. A click, a tap or Enter shows a picture at full size.";
    write_report(summary.folder + "/report.html", report);
}

}  // namespace trilens
