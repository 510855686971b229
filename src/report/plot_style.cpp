#include "report/plot_style.h"

#include <array>
#include <utility>

namespace trilens {

// The colours and strokes of plots. Based on: Okabe and Ito, Color Universal Design, 2008; each series also
// has a marker of its own, so that none needs colour to be told apart.

namespace {

constexpr std::array<const char*, kPlotColours> kLight = {"#0072b2", "#d55e00", "#009e73", "#cc79a7",
                                                          "#b07d00", "#56b4e9", "#7a4fb5", "#444444"};
constexpr std::array<const char*, kPlotColours> kDark = {"#4aa8e0", "#f0803c", "#2fc79c", "#e3a1c6",
                                                         "#e6b93c", "#8fd0f5", "#b394e0", "#c8c8c8"};

}  // namespace

std::string plot_series_class(std::size_t i) {
    return "tp-c" + std::to_string(i % kLight.size());
}

std::string plot_series_colour(std::size_t i) {
    return kLight[i % kLight.size()];
}

std::string plot_style() {
    std::string rules =
        "text{font-family:system-ui,-apple-system,'Segoe UI',Roboto,'Helvetica Neue','DejaVu "
        "Sans',sans-serif;"
        "font-size:12px;fill:#333}"
        ".tp-paper{fill:#fff}.tp-title{font-size:14px;font-weight:600;fill:#111}.tp-label{font-size:12px}"
        ".tp-grid{stroke:#cdd2d8;stroke-width:1}.tp-minor{stroke:#eceff2;stroke-width:1}"
        ".tp-frame{fill:none;stroke:#8a929b;stroke-width:1}"
        ".tp-level{stroke:#8a929b;stroke-width:1;stroke-dasharray:2 3}"
        ".tp-reference{stroke:#b9c0c8;stroke-width:1.5;stroke-dasharray:7 "
        "4}.tp-note{font-size:11px;fill:#616a73}"
        ".tp-inside{paint-order:stroke;stroke:#fff;stroke-width:3px;stroke-linejoin:round}"
        ".tp-line{fill:none;stroke-width:1.8}.tp-fit{stroke-width:1.8}"
        ".tp-cell{stroke:none}.tp-on-dark{fill:#fff}.tp-on-light{fill:#111}"
        ".tp-join{fill:none;stroke-width:1;stroke-opacity:.35}.tp-marker{stroke-width:1.6;fill-opacity:."
        "9}";
    for (std::size_t i = 0; i < kLight.size(); ++i)
        rules += "." + plot_series_class(i) + "{stroke:" + kLight[i] + "}.tp-marker." + plot_series_class(i) +
                 "{fill:" + kLight[i] + "}";
    rules += ".tp-over{stroke-dasharray:6 6}.tp-marker.tp-over{fill:none;stroke-dasharray:none}";
    return rules;
}

std::string dark_plot_style(const std::string& scope) {
    const std::array<std::pair<const char*, const char*>, 10> rules = {{{"text", "fill:#c9d1d9"},
                                                                        {".tp-paper", "fill:#161b22"},
                                                                        {".tp-title", "fill:#f0f3f6"},
                                                                        {".tp-grid", "stroke:#3a424c"},
                                                                        {".tp-minor", "stroke:#242b33"},
                                                                        {".tp-frame", "stroke:#6e7781"},
                                                                        {".tp-level", "stroke:#8a929b"},
                                                                        {".tp-reference", "stroke:#57606a"},
                                                                        {".tp-note", "fill:#9aa3ad"},
                                                                        {".tp-inside", "stroke:#161b22"}}};
    std::string style;
    for (const auto& [selector, properties] : rules) style += scope + " " + selector + "{" + properties + "}";
    style += scope + " .tp-on-dark{fill:#fff}" + scope + " .tp-on-light{fill:#111}";
    for (std::size_t i = 0; i < kDark.size(); ++i)
        style += scope + " ." + plot_series_class(i) + "{stroke:" + kDark[i] + "}" + scope + " .tp-marker." +
                 plot_series_class(i) + "{fill:" + kDark[i] + "}";
    style += scope + " .tp-marker.tp-over{fill:none}";
    return style;
}

}  // namespace trilens
