// A sweep's plots and its report page.
#include "sweep/sweep_report.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <optional>
#include <utility>

#include "base/error.h"
#include "base/files.h"
#include "image/image_io.h"
#include "report/html.h"
#include "report/text.h"
#include "sweep/fit_runs.h"
#include "sweep/measure_run.h"
#include "sweep/sweep_plots.h"

namespace trilens {
namespace {

constexpr const char* kAll = "all";

std::string count_text(const MetricValues& metrics, const std::string& name) {
    const std::optional<double> value = find_value(metrics, name);
    return value ? fixed_text(*value, 0) : "";
}

std::string value_text(const MetricValues& metrics, const std::string& name) {
    const std::optional<double> value = find_value(metrics, name);
    return value ? rounded_text(*value, 3) : "";
}

// ---- words and numbers
// --------------------------------------------------------------------------------------------

/// "23", or "230 (extrapolated)" where no run was that fine.
std::string resolution_text(const SweepFit& fit, std::optional<double> n) {
    if (!n) return "—";
    int finest = 0;
    for (const SweepPoint& point : fit.points) finest = std::max(finest, point.n);
    return "n = " + rounded_text(*n, 6) + (*n > finest ? " (extrapolated)" : "");
}

std::vector<Headline> make_headlines(const SweepSummary& summary) {
    std::vector<Headline> headlines;
    for (const std::string& layer : layers_of(summary)) {
        const SweepFit* fit = find_fit(summary.fits, layer, kAll, "disp_mean_px");
        if (!fit) continue;
        headlines.push_back(
            {fit->order ? fixed_text(*fit->order, 2) : "—", layer + ": order of convergence"});
        const SweepFit* off = find_fit_off_folds(summary.fits, layer, kAll);
        if (off && off->order)
            headlines.push_back({fixed_text(*off->order, 2), layer + ": order off the folds"});
        headlines.push_back({resolution_text(*fit, fit->n_for_1px), layer + ": for a mean of 1 px"});
        headlines.push_back({resolution_text(*fit, fit->n_for_half_px), layer + ": for a mean of 0.5 px"});
    }
    headlines.push_back(
        {std::to_string(summary.count(RunState::kDone)) + " of " + std::to_string(summary.runs.size()),
         "runs finished"});
    return headlines;
}

std::string summary_words(const SweepSummary& summary) {
    const SweepSubject& subject = summary.manifest.subject;
    std::string words = "The " + subject.method + " projection of " + subject.scene +
                        " against its ray-traced " + subject.truth + " truth";
    if (!subject.camera.empty()) words += ", camera " + subject.camera;
    for (const RunRecord& run : summary.runs)
        if (run.state == RunState::kDone) {
            words += ", " + count_text(run.metrics, "width") + " × " + count_text(run.metrics, "height") +
                     " pixels";
            break;
        }
    const std::string side = std::to_string(subject.spp);
    words += subject.spp == 1 ? ", one sample each" : ", " + side + " × " + side + " samples each";
    return words +
           ". Displacement says how many pixels a seen point lies from where the truth shows it. "
           "Folds are where two images of a point meet: there displacements fall more slowly.";
}

void fill_table(const SweepSummary& summary, Report& report) {
    const std::vector<std::string> layers = layers_of(summary);
    report.table_columns = {"n", "status", "facets"};
    for (const std::string& layer : layers)
        for (const char* what :
             {": mean [px]", ": mean off folds [px]", ": 95 % [px]", ": max [px]", ": pixels lost"})
            report.table_columns.push_back(layer + what);
    for (const char* column : {"RGB RMSE", "PSNR [dB]", "SSIM", "time [s]"})
        report.table_columns.push_back(column);

    for (const RunRecord& run : summary.runs) {
        std::vector<std::string> row = {std::to_string(run.plan.n), state_name(run.state),
                                        count_text(run.metrics, "facets")};
        for (const std::string& layer : layers) {
            MetricValues metrics;
            for (const OpticDisplacement& one : run.displacement)
                if (one.layer == layer && one.optic == kAll) metrics = one.metrics;
            for (const char* name : {"disp_mean_px", "disp_mean_off_folds_px", "disp_p95_px", "disp_max_px"})
                row.push_back(value_text(metrics, name));
            row.push_back(count_text(metrics, "disp_lost"));
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
        const std::string lost = count_text(one.metrics, "disp_lost");
        facts.emplace_back(one.layer + ", " + one.optic,
                           value_text(one.metrics, "disp_mean_px") +
                               " px, 95 %: " + value_text(one.metrics, "disp_p95_px") + " px" +
                               (lost == "0" ? "" : ", " + lost + " lost"));
    }
    facts.emplace_back("RGB RMSE", value_text(run.metrics, "rgb_rmse"));
    facts.emplace_back("largest colour difference", value_text(run.metrics, "rgb_max"));
    facts.emplace_back("time", value_text(run.metrics, "t_total_s") + " s");
    return facts;
}

// ---- pictures
// -----------------------------------------------------------------------------------------------------

/// What is the same for the pictures of all runs, so that they compare.
struct PictureScales {
    double difference = 1;
    ColourRange displacement;
};

PictureScales picture_scales(const SweepSummary& summary) {
    double difference = 0, largest = 0, smallest = INFINITY;
    for (const RunRecord& run : summary.runs) {
        difference = std::max(difference, find_value(run.metrics, "rgb_p99").value_or(0));
        for (const OpticDisplacement& one : run.displacement) {
            largest = std::max(largest, find_value(one.metrics, "disp_p99_px").value_or(0));
            const double median = find_value(one.metrics, "disp_p50_px").value_or(0);
            if (median > 0) smallest = std::min(smallest, median);
        }
    }
    PictureScales scales{difference_scale(difference), {}};
    if (largest > 0 && std::isfinite(largest)) {
        // Whole decades, at most four.
        const double top = std::ceil(std::log10(largest)),
                     bottom = std::floor(std::log10(std::min(smallest, largest)));
        scales.displacement = {std::pow(10.0, std::max(std::min(bottom, top - 1), top - 4)),
                               std::pow(10.0, top)};
    }
    return scales;
}

/// The picture, or its caption and the reason why there is none.
Thumbnail picture_or_reason(const std::string& caption, const std::function<Thumbnail()>& make) {
    try {
        return make();
    } catch (const InputError& error) {
        return {caption + ": " + error.what(), 0, 0, {}};
    }
}

std::vector<Thumbnail> run_pictures(const SweepSummary& summary, const RunRecord& run, const Image* truth,
                                    const PictureScales& scales) {
    const std::string home = run_folder(summary.folder, run.plan.id);
    std::vector<Thumbnail> pictures;
    std::optional<Image> image;
    pictures.push_back(picture_or_reason("projected", [&] {
        image = read_exr(home + "/image.exr");
        return beauty_picture(*image, "projected");
    }));
    if (truth) {
        pictures.push_back(picture_or_reason("truth", [&] { return beauty_picture(*truth, "truth"); }));
        const std::string difference = "difference × " + rounded_text(scales.difference, 4);
        if (image)
            pictures.push_back(picture_or_reason(difference, [&] {
                return difference_picture(*image, *truth, scales.difference, difference);
            }));
    }
    const Thumbnail failed = picture_or_reason("displacement", [&] {
        const Image diff = read_exr(home + "/diff.exr");
        for (const DisplacementMap& map : displacement_maps(diff))
            pictures.push_back(displacement_picture(map.pixels, diff.data_width, scales.displacement,
                                                    "displacement, " + map.layer));
        return Thumbnail{};
    });
    if (!failed.caption.empty()) pictures.push_back(failed);
    return pictures;
}

std::vector<ReportRun> make_report_runs(const SweepSummary& summary, const PictureScales& scales,
                                        std::vector<std::string>& warnings) {
    std::optional<Image> truth;
    try {
        truth = read_exr(truth_file(summary.folder, summary.runs.front().plan.truth));
    } catch (const InputError& error) {
        warnings.push_back(std::string("no picture of the truth: ") + error.what());
    }
    std::vector<ReportRun> runs;
    for (const RunRecord& run : summary.runs) {
        ReportRun one;
        one.title = "n = " + std::to_string(run.plan.n);
        one.warnings = run.warnings;
        if (run.state == RunState::kMissing) one.error = "not run yet";
        if (run.state == RunState::kFailed)
            one.error = "failed (exit code " + std::to_string(run.exit_code) + "): " + run.error;
        if (run.state == RunState::kDone) {
            one.pictures = run_pictures(summary, run, truth ? &*truth : nullptr, scales);
            one.facts = run_facts(run);
        }
        runs.push_back(one);
    }
    return runs;
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

    make_folder(summary.folder + "/plots");
    for (const NamedPlot& plot : make_plots(summary)) {
        replace_text_file(summary.folder + "/plots/" + plot.name + ".svg", plot.svg);
        report.plots.push_back(plot.svg);
    }

    report.plots_note =
        "A straight line is the law error = constant × n^−order fitted to the points. Runs that lost more "
        "than a "
        "tenth of an optic's pixels take no part in its fit, nor does a plateau at the fine end.";

    fill_table(summary, report);
    const PictureScales scales = picture_scales(summary);
    report.runs = make_report_runs(summary, scales, report.warnings);
    report.pictures_note = "Differences are |projected − truth| × " + rounded_text(scales.difference, 4) +
                           ", the same for all runs. Hover over a projected picture to see the truth in its "
                           "place; click to enlarge.";
    report.legend = {"Displacement, the same colours for all runs; grey: nothing to measure, orange: lost",
                     scales.displacement, "px"};
    if (layers_of(summary).empty()) report.legend.title.clear();
    write_report(summary.folder + "/report.html", report);
}

}  // namespace trilens
