// How a bake's light came to rest, as a plot.
#include "base/files/files.h"
#include "base/util/error.h"
#include "base/util/format.h"
#include "radiosity/bake.h"
#include "report/plot.h"

namespace trilens {

std::string convergence_plot(const BakeReport& report, const std::string& file) {
    PlotSeries series{"unshot", {}, {}};
    constexpr double kApart = 1.1;  // points of a plot, on its logarithmic axis
    double next = 1;
    for (const RadiosityStep& step : report.convergence) {
        const auto rows = static_cast<double>(step.rows);
        if (rows < next && &step != &report.convergence.back()) continue;
        series.points.emplace_back(rows, 100 * step.unshot);
        next = kApart * rows;
    }
    PlotParams params;
    params.title = "Convergence";
    params.subtitle = fmt::format("{} patches", report.patches);
    params.x_label = "rows of form factors";
    params.y_label = "unshot power [%]";
    params.reference_orders = false;
    const PlotDrawing drawing = draw_plot(params, {&series, 1});
    const std::string ending = file_ending(file);
    if (ending == ".svg") return plot_svg(drawing);
    if (ending == ".pdf") return plot_pdf(drawing);
    throw UsageError("the plot \"" + file + "\" must end in .svg or .pdf");
}

}  // namespace trilens
