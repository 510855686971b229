#include "sweep/report/sweep_report.h"

#include <algorithm>
#include <optional>
#include <vector>

#include "base/util/error.h"
#include "base/util/format.h"
#include "report/text.h"

namespace trilens {

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
        if (one.layer == layer && one.optic == kAllOptics) return &one.metrics;
    return nullptr;
}

namespace {

/// "23", or "230 (extrapolated)" where no run was that fine.
std::string resolution_text(const SweepFit& fit, std::optional<double> n) {
    if (!n) return "—";
    double finest = 0;
    for (const SweepPoint& point : fit.points) finest = std::max(finest, point.n);
    return "n = " + rounded_text(*n, 6) + (*n > finest ? " (extrapolated)" : "");
}

std::vector<Headline> layer_headlines(const SweepSummary& summary, const std::string& layer) {
    const SweepFit* const fit = find_fit(summary.fits, layer, kAllOptics, "disp_mean_px");
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
    headlines.push_back(
        {fit->order ? fixed_text(*fit->order, 2) : "—", layer + ": order of the mean displacement"});
    const SweepFit* const off = find_fit_off_folds(summary.fits, layer, kAllOptics);
    if (off && off->order)
        headlines.push_back(
            {fixed_text(*off->order, 2), layer + ": order of the mean displacement off the folds"});
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
        if (fit.layer == layer && fit.optic == kAllOptics && fit.metric == "disp_mean_px" && fit.order) {
            least = std::min(least.value_or(*fit.order), *fit.order);
            most = std::max(most.value_or(*fit.order), *fit.order);
        }
    std::vector<Headline> headlines;
    if (least)
        headlines.push_back({fixed_text(*least, 2) == fixed_text(*most, 2)
                                 ? fixed_text(*least, 2)
                                 : fixed_text(*least, 2) + " to " + fixed_text(*most, 2),
                             layer + ": orders of the mean displacement, by group"});
    headlines.push_back({measured_range(summary, layer), layer + ": of its pixels measured"});
    return headlines;
}

}  // namespace

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

std::vector<std::string> exact_sentences(const SweepSummary& summary) {
    std::vector<std::string> sentences;
    for (const std::string& layer : layers_of(summary)) {
        const SweepFit* const fit = find_fit(summary.fits, layer, kAllOptics, "disp_mean_px");
        const bool is_all_exact = std::ranges::all_of(summary.fits, [&](const SweepFit& one) {
            return one.layer != layer || one.optic != kAllOptics || one.metric != "disp_mean_px" ||
                   is_exact(one);
        });
        if (!fit || !is_all_exact) continue;
        double lost = 0, missing = 0, unmeasured = 0;
        for (const RunRecord& run : summary.runs)
            if (const MetricValues* const all = find_all(run, layer)) {
                lost += find_value(*all, "disp_lost").value_or(0);
                unmeasured += find_value(*all, "disp_unmeasured").value_or(0);
                missing += find_value(*all, "disp_missing").value_or(0);
            }
        sentences.push_back(fmt::format(
            "{}: exact. In all {} runs every displacement that was measured is zero, over {} of the pixels, "
            "with {} lost, {} missing and {} unmeasured in all runs together.",
            layer, summary.count(RunState::kDone), measured_range(summary, layer), fixed_text(lost, 0),
            fixed_text(missing, 0), fixed_text(unmeasured, 0)));
    }
    const SweepFit* const colour = find_fit(summary.fits, "", kAllOptics, "rgb_rmse");
    const bool is_colour_exact = std::ranges::all_of(
        summary.fits, [](const SweepFit& one) { return one.metric != "rgb_rmse" || is_exact(one); });
    if (colour && is_colour_exact) sentences.push_back("Every colour is the truth's to the last bit.");
    return sentences;
}

std::string left_out_words(const LeftOutScene& scene) {
    return "left out of the sweep: " + scene.reason;
}

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

namespace {

std::string cell(const std::optional<double>& value, int decimals) {
    return value ? "$" + fixed_text(*value, decimals) + "$" : "--";
}

std::string interval(const SweepFit& fit) {
    if (!fit.order_low || !fit.order_high) return "--";
    return "$[" + fixed_text(*fit.order_low, 2) + ", " + fixed_text(*fit.order_high, 2) + "]$";
}

std::string latex_row(const std::vector<std::string>& cells) {
    std::string line;
    for (const std::string& one : cells) line += (line.empty() ? "" : " & ") + one;
    return line + " \\\\\n";
}

}  // namespace

std::string summary_latex(const SweepSummary& summary) {
    const bool has_displacement =
        std::ranges::any_of(summary.fits, [](const SweepFit& fit) { return fit.metric == "disp_mean_px"; });
    const std::string metric = has_displacement ? "disp_mean_px" : "rgb_rmse";
    std::vector<std::string> header;
    if (!summary.fits.empty())
        for (const Coordinate& one : summary.fits[0].group)
            header.push_back(latex_text(swept_column(one.axis)));
    const std::string words(header.size() + 2, 'l');
    header.insert(header.end(),
                  {"layer", "optic", "order", "95\\,\\%", "constant", "$n$ for 1\\,px", "measured"});
    std::string text = "% " + one_line(summary.manifest.subject.title) +
                       ": error = constant * n^-order; needs \\usepackage{booktabs}\n\\begin{tabular}{" +
                       words + "rrrrr}\n\\toprule\n" + latex_row(header) + "\\midrule\n";
    for (const SweepFit& fit : summary.fits) {
        if (fit.metric != metric) continue;
        std::vector<std::string> cells;
        for (const Coordinate& one : fit.group) cells.push_back(latex_text(one.value.text));
        cells.insert(
            cells.end(),
            {fit.layer.empty() ? "RGB" : latex_text(fit.layer), latex_text(fit.optic), cell(fit.order, 2),
             interval(fit), fit.constant ? "$" + rounded_text(*fit.constant, 3) + "$" : "--",
             cell(fit.n_for_1px, 0), fit.coverage ? latex_text(percent_text(*fit.coverage)) : "--"});
        text += latex_row(cells);
    }
    return text + "\\bottomrule\n\\end{tabular}\n";
}

}  // namespace trilens
