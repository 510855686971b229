// A sweep's plots and its report page.
#include "sweep/sweep_report.h"

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <set>
#include <system_error>

#include "base/files.h"
#include "base/format.h"
#include "base/parallel.h"
#include "report/html.h"
#include "report/text.h"
#include "sweep/fit_runs.h"
#include "sweep/sweep_pictures.h"
#include "sweep/sweep_plots.h"

namespace trilens {
namespace {

constexpr const char* kAll = "all";
constexpr std::size_t kMostPictured = 12, kMostFailures = 40;  // runs

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
    int finest = 0;
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

std::vector<Headline> make_headlines(const SweepSummary& summary) {
    std::vector<Headline> headlines;
    for (const std::string& layer : layers_of(summary))
        for (const Headline& headline : layer_headlines(summary, layer)) headlines.push_back(headline);
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
    words += subject.spp == 1 ? ", one sample each." : fmt::format(", {0} × {0} samples each.", subject.spp);
    return words;
}

/// What plots would say with nothing in them.
std::vector<std::string> exact_sentences(const SweepSummary& summary) {
    std::vector<std::string> sentences;
    for (const std::string& layer : layers_of(summary)) {
        const SweepFit* const fit = find_fit(summary.fits, layer, kAll, "disp_mean_px");
        if (!fit || !is_exact(*fit)) continue;
        double lost = 0, missing = 0;
        for (const RunRecord& run : summary.runs)
            if (const MetricValues* const all = find_all(run, layer)) {
                lost += find_value(*all, "disp_lost").value_or(0);
                missing += find_value(*all, "disp_missing").value_or(0);
            }
        sentences.push_back(fmt::format(
            "{}: exact. In all {} runs every displacement that was measured is zero, over {} of the pixels, "
            "with {} lost and {} missing in all runs together.",
            layer, fit->points.size(), measured_range(summary, layer), fixed_text(lost, 0),
            fixed_text(missing, 0)));
    }
    const SweepFit* const colour = find_fit(summary.fits, "", kAll, "rgb_rmse");
    if (colour && is_exact(*colour)) sentences.push_back("Every colour is the truth's to the last bit.");
    return sentences;
}

void fill_table(const SweepSummary& summary, Report& report) {
    const std::vector<std::string> layers = layers_of(summary);
    report.table_columns = {"n", "status", "facets"};
    for (const std::string& layer : layers)
        for (const char* what : {": measured", ": lost", ": missing", ": mean where measured [px]",
                                 ": mean off folds [px]", ": 95 % [px]", ": max [px]"})
            report.table_columns.push_back(layer + what);
    for (const char* column : {"RGB RMSE", "PSNR [dB]", "SSIM", "time [s]"})
        report.table_columns.push_back(column);

    for (const RunRecord& run : summary.runs) {
        std::vector<std::string> row = {std::to_string(run.plan.n), state_name(run.state),
                                        count_text(run.metrics, "facets")};
        for (const std::string& layer : layers) {
            const MetricValues* const all = find_all(run, layer);
            const MetricValues metrics = all ? *all : MetricValues();
            row.push_back(coverage_text(metrics));
            for (const char* name : {"disp_lost", "disp_missing"}) row.push_back(count_text(metrics, name));
            for (const char* name : {"disp_mean_px", "disp_mean_off_folds_px", "disp_p95_px", "disp_max_px"})
                row.push_back(value_text(metrics, name));
        }
        for (const char* name : {"rgb_rmse", "rgb_psnr_db", "rgb_ssim", "t_total_s"})
            row.push_back(value_text(run.metrics, name));
        report.table_rows.push_back(row);
    }
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

/// At most kMostPictured of the finished runs, evenly spread, the first and the last among them.
std::set<std::size_t> pictured_runs(const SweepSummary& summary) {
    std::vector<std::size_t> done;
    for (std::size_t i = 0; i < summary.runs.size(); ++i)
        if (summary.runs[i].state == RunState::kDone) done.push_back(i);
    if (done.size() <= kMostPictured) return {done.begin(), done.end()};
    std::set<std::size_t> chosen;
    for (std::size_t i = 0; i < kMostPictured; ++i)
        chosen.insert(done[i * (done.size() - 1) / (kMostPictured - 1)]);
    return chosen;
}

ReportRun run_section(const std::string& folder, const RunRecord& run) {
    ReportRun section;
    section.title = "n = " + std::to_string(run.plan.n);
    section.warnings = run.warnings;
    if (run.state == RunState::kFailed) {
        section.error = "failed (exit code " + std::to_string(run.exit_code) + "): " + run.error;
        return section;
    }
    section.pictures = run_pictures(folder, run);
    section.facts = run_facts(run);
    return section;
}

void fill_runs(const SweepSummary& summary, Report& report) {
    const std::set<std::size_t> pictured = pictured_runs(summary);
    std::vector<const RunRecord*> runs;  // of each section
    std::size_t failures = 0;
    for (std::size_t i = 0; i < summary.runs.size(); ++i) {
        const RunRecord& run = summary.runs[i];
        const bool is_told = run.state == RunState::kFailed && failures++ < kMostFailures;
        if (is_told || pictured.count(i) > 0) runs.push_back(&run);
    }

    // Decoding and encoding pictures is most of a report's time.
    report.runs.resize(runs.size());
    parallel_for(runs.size(), 1, [&](std::size_t first, std::size_t last) {
        for (std::size_t i = first; i < last; ++i) report.runs[i] = run_section(summary.folder, *runs[i]);
    });

    if (const std::size_t missing = summary.count(RunState::kMissing))
        report.warnings.push_back(std::to_string(missing) + " of the runs are not done yet");
    if (failures > kMostFailures)
        report.warnings.push_back(fmt::format(
            "{} runs failed; the first {} are told below, all are in summary.json", failures, kMostFailures));
    if (const std::size_t done = summary.count(RunState::kDone); done > pictured.size())
        report.pictures_note =
            fmt::format("Pictures of {} of the {} finished runs, evenly spread; the table has all. ",
                        pictured.size(), done);
}

/// The plots as files, without those of an earlier report.
void write_plots(const SweepSummary& summary, Report& report) {
    namespace fs = std::filesystem;
    const std::string folder = summary.folder + "/plots";
    make_folder(folder);
    std::set<std::string> written;
    for (const NamedPlot& plot : make_plots(summary)) {
        replace_text_file(folder + "/" + plot.name + ".svg", plot.svg);
        written.insert(plot.name + ".svg");
        report.plots.push_back(plot.svg);
    }
    std::vector<std::string> stale;
    std::error_code unreadable;
    for (fs::directory_iterator entry(folder, unreadable), end; !unreadable && entry != end;
         entry.increment(unreadable))
        if (entry->path().extension() == ".svg" && written.count(entry->path().filename().string()) == 0)
            stale.push_back(entry->path().string());
    for (const std::string& file : stale) remove_file(file);
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
    report.plots_note =
        "Displacement says how many pixels a seen point lies from where the truth shows it; it is known for "
        "the measured share of the pixels that show the layer in either picture. Lost pixels show what the "
        "truth does not, missing ones are the truth's that the projection does not show. Folds are where two "
        "images of a point meet: there displacements fall more slowly. A straight line is the law error = "
        "constant × n^−order fitted to the points. Runs that lost or miss "
        "more than a tenth of an optic's pixels take no part in its fit, nor does a plateau at the fine end.";
    fill_table(summary, report);
    fill_runs(summary, report);
    report.pictures_note +=
        "The slider moves the border between the projected picture (left) and the truth (right). Each run "
        "has its own colours for displacement and its own factor for differences, both stated at the "
        "picture. A click, a tap or Enter shows a picture at full size.";
    write_report(summary.folder + "/report.html", report);
}

}  // namespace trilens
