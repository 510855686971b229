#include "inverse/fit/fit.h"

#include <algorithm>
#include <cmath>

#include "base/util/format.h"
#include "report/page.h"
#include "report/plot.h"
#include "report/text.h"

namespace trilens {
namespace {

constexpr double kArrowShare = 0.06;  // of the film's width: the longest arrow of a pair that is used
constexpr double kPlotWidth = 640;

std::string line_svg(const Vec2& from, const Vec2& to, const char* style) {
    return fmt::format("<line x1='{:.2f}' y1='{:.2f}' x2='{:.2f}' y2='{:.2f}' {}/>\n", from.x, from.y, to.x,
                       to.y, style);
}

/// Each axis' residuals over the other: what a good fit scatters about the origin.
std::string scatter_plot(const FitResult& result) {
    std::vector<PlotSeries> series{{"used", {}, {}}, {"outlier", {}, {}}};
    for (const FittedPair& pair : result.pairs)
        if (pair.state != PairState::kLost)
            series[pair.state == PairState::kOutlier ? 1 : 0].points.push_back(pair.residual);
    if (series[1].points.empty()) series.pop_back();
    PlotParams params;
    params.title = "residuals";
    params.x_label = "image minus pixel, x [px]";
    params.y_label = "y [px]";
    params.joins_points = false;
    return linear_plot(params, series);
}

std::string correlation_table(const FitResult& result) {
    std::vector<std::string> columns{""};
    std::vector<std::vector<std::string>> rows;
    for (std::size_t i = 0; i < result.parameters.size(); ++i) {
        columns.push_back(std::to_string(i));
        std::vector<std::string> row{std::to_string(i) + "  " + result.parameters[i].pointer};
        for (const double value : result.correlation[i]) row.push_back(fixed_text(value, 3));
        rows.push_back(std::move(row));
    }
    return html_table(columns, rows);
}

}  // namespace

FitArrows residual_arrows(const Scene& scene, std::span<const Correspondence> pairs,
                          const FitResult& result) {
    const double scale = kPlotWidth / scene.film.width, height = scene.film.height * scale;
    double longest = 0;
    for (const FittedPair& pair : result.pairs)
        if (pair.state == PairState::kUsed) longest = std::max(longest, length(pair.residual));
    FitArrows arrows;
    if (longest > 0) {
        const double wanted = kArrowShare * scene.film.width / longest;
        arrows.longer = std::pow(10, std::floor(std::log10(wanted)));
        for (const double step : {5.0, 2.0})
            if (arrows.longer * step <= wanted) {
                arrows.longer *= step;
                break;
            }
    }
    arrows.svg = fmt::format(
        "<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 {:.0f} {:.0f}' width='{:.0f}' "
        "height='{:.0f}'>\n<rect width='100%' height='100%' fill='#fff' stroke='#888'/>\n",
        kPlotWidth, height, kPlotWidth, height);
    for (std::size_t i = 0; i < pairs.size(); ++i) {
        const FittedPair& pair = result.pairs[i];
        const Vec2 at = scale * pairs[i].pixel;
        if (pair.state == PairState::kLost) {
            arrows.svg += line_svg(at - Vec2(4, 4), at + Vec2(4, 4), "stroke='#888'");
            arrows.svg += line_svg(at - Vec2(4, -4), at + Vec2(4, -4), "stroke='#888'");
            continue;
        }
        const char* colour = pair.state == PairState::kOutlier ? "#c2410c" : "#1d4ed8";
        // An outlier would cross the whole film: it keeps its direction.
        const double most = 2 * kArrowShare * kPlotWidth;
        Vec2 arrow = scale * arrows.longer * pair.residual;
        if (length(arrow) > most) arrow *= most / length(arrow);
        arrows.svg += line_svg(at, at + arrow, fmt::format("stroke='{}' stroke-width='1.5'", colour).c_str());
        arrows.svg +=
            fmt::format("<circle cx='{:.2f}' cy='{:.2f}' r='2.5' fill='{}'/>\n", at.x, at.y, colour);
    }
    arrows.svg += "</svg>\n";
    return arrows;
}

std::string fit_html(const Scene& scene, std::span<const Correspondence> pairs, const FitResult& result) {
    const FitArrows arrows = residual_arrows(scene, pairs, result);
    Facts facts{
        {"pairs", fmt::format("{} used, {} outliers, {} lost", result.used, result.outliers, result.lost)},
        {"rms", fmt::format("{} px, {} px where the fit began", rounded_text(result.rms, 4),
                            rounded_text(result.rms_start, 4))},
        {"noise of the pairs used", rounded_text(result.noise, 4) + " px in x and in y"},
        {"iterations", std::to_string(result.iterations)},
        {"rank", fmt::format("{} of {}", result.rank, result.parameters.size())}};
    std::string body = html_text("h1", "Fit of " + scene_title(scene)) + html_facts(facts);
    for (const std::string& motion : result.undetermined)
        body += html_text("p", "No pair tells of: " + motion);
    for (const std::string& warning : result.warnings) body += html_text("p", warning);

    body += html_text("h2", "Parameters");
    std::vector<std::vector<std::string>> rows;
    for (const FittedParameter& one : result.parameters)
        rows.push_back({one.pointer, rounded_text(one.start, 9), rounded_text(one.value, 9),
                        one.sigma > 0 ? rounded_text(one.sigma, 3) : "-"});
    body += html_table({"pointer", "start", "value", "standard deviation"}, rows);
    body += html_text("h2", "Correlations") + correlation_table(result);
    body += html_text("h2",
                      fmt::format("Residuals over the film, {} times as long", shortest_text(arrows.longer)));
    body += arrows.svg + scatter_plot(result);

    rows.clear();
    for (std::size_t i = 0; i < pairs.size(); ++i) {
        const FittedPair& pair = result.pairs[i];
        rows.push_back({std::to_string(i), rounded_text(pairs[i].pixel.x, 7),
                        rounded_text(pairs[i].pixel.y, 7), pair_state_name(pair.state), pair.path,
                        rounded_text(pair.residual.x, 3), rounded_text(pair.residual.y, 3)});
    }
    body += html_text("h2", "Pairs") +
            html_table({"pair", "x", "y", "state", "path", "dx [px]", "dy [px]"}, rows);
    return html_page("fit of " + scene_title(scene), body);
}

}  // namespace trilens
