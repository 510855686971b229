#include "report/plot.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>

#include "report/text.h"

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

// Where a value stands along a plot's axis, linear or logarithmic, and which values are worth a tick.

namespace {

constexpr double kMargin = 0.06;  // of the range, at either end

std::string superscript(int value) {
    constexpr const char* kDigits[] = {"⁰", "¹", "²", "³", "⁴", "⁵", "⁶", "⁷", "⁸", "⁹"};
    std::string text = value < 0 ? "⁻" : "";
    for (const char c : std::to_string(std::abs(value))) text += kDigits[c - '0'];
    return text;
}

/// "0.01", "500"; "2·10⁻⁵" where that is shorter.
std::string log_label(int digit, int decade) {
    if (decade >= -3 && decade <= 4) return rounded_text(digit * std::pow(10.0, decade), 1);
    const std::string power = "10" + superscript(decade);
    return digit == 1 ? power : std::to_string(digit) + "·" + power;
}

std::vector<PlotTick> log_ticks(const PlotScale& scale) {
    // The longer the range, the fewer multiples of a decade bear a label or a line.
    const double decades = std::log10(scale.hi / scale.lo);
    const int label_step = std::max(1, static_cast<int>(decades / 8));
    std::vector<PlotTick> ticks;
    for (int decade = static_cast<int>(std::floor(std::log10(scale.lo))); decade <= std::log10(scale.hi);
         ++decade) {
        for (int digit = 1; digit <= (decades > 8 ? 1 : 9); ++digit) {
            const double value = digit * std::pow(10.0, decade);
            if (value < scale.lo || value > scale.hi) continue;
            const bool is_labelled =
                digit == 1 ? decade % label_step == 0 : decades < 2.2 && (digit == 2 || digit == 5);
            ticks.push_back({value, is_labelled ? log_label(digit, decade) : "", digit == 1});
        }
    }
    return ticks;
}

std::vector<PlotTick> linear_ticks(const PlotScale& scale) {
    // The step is 1, 2 or 5 times a power of ten, such that five to ten of them fit.
    const double rough = (scale.hi - scale.lo) / 6;
    const double power = std::pow(10.0, std::floor(std::log10(rough)));
    const double ratio = rough / power;
    const double step = power * (ratio < 1.5 ? 1 : ratio < 3.5 ? 2 : ratio < 7.5 ? 5 : 10);
    std::vector<PlotTick> ticks;
    for (double i = std::ceil(scale.lo / step); i * step <= scale.hi; ++i)
        ticks.push_back({i * step, rounded_text(i * step, 6), true});
    return ticks;
}

}  // namespace

bool PlotScale::can_show(double value) const {
    return std::isfinite(value) && (kind == ScaleKind::kLinear || value > 0);
}

double PlotScale::pixel(double value) const {
    const double share =
        kind == ScaleKind::kLog ? std::log(value / lo) / std::log(hi / lo) : (value - lo) / (hi - lo);
    return first + share * (last - first);
}

PlotScale fit_scale(ScaleKind kind, std::span<const double> values) {
    const bool is_log = kind == ScaleKind::kLog;
    PlotScale scale{kind, INFINITY, -INFINITY, 0, 1};
    for (const double value : values) {
        if (!scale.can_show(value)) continue;
        const double position = is_log ? std::log10(value) : value;
        scale.lo = std::min(scale.lo, position);
        scale.hi = std::max(scale.hi, position);
    }
    if (scale.lo > scale.hi) return {kind, is_log ? 1.0 : 0.0, is_log ? 10.0 : 1.0, 0, 1};

    // A range without length gets one around its middle; then the margins.
    const double shortest = is_log ? 1.0 : std::max(1e-9 * std::abs(scale.hi), scale.hi == 0 ? 1.0 : 0.0);
    const double lacking = std::max(0.0, shortest - (scale.hi - scale.lo)) / 2;
    const double margin = kMargin * (scale.hi - scale.lo + 2 * lacking) + lacking;
    scale.lo -= margin;
    scale.hi += margin;
    if (is_log) {
        scale.lo = std::pow(10.0, scale.lo);
        scale.hi = std::pow(10.0, scale.hi);
    }
    return scale;
}

std::vector<PlotTick> make_ticks(const PlotScale& scale) {
    return scale.kind == ScaleKind::kLog ? log_ticks(scale) : linear_ticks(scale);
}

namespace {

// Of the font size. DejaVu Sans is the widest of the fonts asked for: its digits are 0.636 em, and a text of
// letters and digits is narrower on average.
constexpr double kCharacterWidth = 0.62;
constexpr double kAscent = 0.82, kDescent = 0.24;

bool begins_character(char c) {
    return (static_cast<unsigned char>(c) & 0xC0) != 0x80;
}

}  // namespace

double text_width(const std::string& utf8, double font_size) {
    return kCharacterWidth * font_size *
           static_cast<double>(std::count_if(utf8.begin(), utf8.end(), begins_character));
}

std::string shortened_text(const std::string& utf8, double font_size, double width) {
    if (text_width(utf8, font_size) <= width) return utf8;
    std::string kept;
    for (std::size_t i = 0; i < utf8.size(); ++i) {
        if (begins_character(utf8[i]) && text_width(kept + "……", font_size) > width) break;
        kept += utf8[i];
    }
    return kept + "…";
}

PlotBox text_box(const Vec2& at, const std::string& anchor, const std::string& utf8, double font_size) {
    const double width = text_width(utf8, font_size);
    const double left = at.x - (anchor == "end" ? width : anchor == "middle" ? width / 2 : 0);
    return {{left, at.y - kAscent * font_size}, {left + width, at.y + kDescent * font_size}};
}

bool PlotRoom::is_free(const PlotBox& box) const {
    return std::none_of(taken_.begin(), taken_.end(), [&](const PlotBox& other) {
        return box.lo.x < other.hi.x && other.lo.x < box.hi.x && box.lo.y < other.hi.y &&
               other.lo.y < box.hi.y;
    });
}

bool PlotRoom::take_if_free(const PlotBox& box) {
    if (!is_free(box)) return false;
    take(box);
    return true;
}

}  // namespace trilens
