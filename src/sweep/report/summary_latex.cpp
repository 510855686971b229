#include "sweep/report/summary_latex.h"

#include <algorithm>
#include <optional>
#include <vector>

#include "base/util/error.h"
#include "report/text.h"
#include "sweep/report/sweep_plots.h"

namespace trilens {
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
        for (const Coordinate& one : summary.fits[0].group) header.push_back(latex_text(one.axis));
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
