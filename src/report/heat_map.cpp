#include "report/plot.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "base/math/srgb.h"
#include "report/text.h"

namespace trilens {

// A table of numbers as colours: one value per pair of settings.

namespace {

constexpr double kWidth = 400, kLeft = 74, kRight = 14, kTop = 48, kBottom = 44, kScaleRoom = 44;
constexpr double kLeastRow = 22, kMostTall = 620;

struct HeatMap {
    const HeatMapParams& params;
    double cell_width = 0, cell_height = 0, floor = 0;  // pixels; floor: the lower end of the cells
    ColourRange range = {};
    PlotDrawing drawing = {};

    void add_text(const std::string& style, const Vec2& at, const char* anchor, const std::string& words) {
        drawing.shapes.push_back({PlotShape::Kind::kText, style, {at}, words, anchor});
    }
    void add_cell(const Vec2& lo, const Vec2& hi, double share) {
        PlotShape cell{PlotShape::Kind::kRectangle, "tp-cell", {lo, hi}};
        cell.fill = viridis_hex(share);
        drawing.shapes.push_back(cell);
    }
};

ColourRange range_of(const std::vector<double>& values) {
    double least = INFINITY, most = 0;
    for (const double value : values)
        if (std::isfinite(value) && value > 0) least = std::min(least, value), most = std::max(most, value);
    if (!(most > 0)) return {0.1, 1};
    return {least, std::max(most, 1.001 * least)};
}

void draw_cells(HeatMap& map) {
    const HeatMapParams& params = map.params;
    for (std::size_t row = 0; row < params.y_values.size(); ++row)
        for (std::size_t column = 0; column < params.x_values.size(); ++column) {
            const double value = params.cell(column, row);
            if (std::isnan(value)) continue;
            const Vec2 lo(kLeft + map.cell_width * static_cast<double>(column),
                          map.floor - map.cell_height * static_cast<double>(row + 1));
            const double share = value > 0 ? map.range.share(value) : 0;
            map.add_cell(lo, lo + Vec2(map.cell_width, map.cell_height), share);
            const std::string words = rounded_text(value, 2);
            if (text_width(words, 11) > map.cell_width - 2 || map.cell_height < 14) continue;
            map.add_text(share > 0.6 ? "tp-note tp-on-light" : "tp-note tp-on-dark",
                         lo + Vec2(map.cell_width / 2, map.cell_height / 2 + 4), "middle", words);
            map.drawing.shapes.back().fill = share > 0.6 ? "#111111" : "#ffffff";
        }
}

/// Every value along an axis that has room.
void draw_ticks(HeatMap& map) {
    const HeatMapParams& params = map.params;
    PlotRoom room;
    for (std::size_t i = 0; i < params.x_values.size(); ++i) {
        const Vec2 at(kLeft + map.cell_width * (static_cast<double>(i) + 0.5), map.floor + 16);
        PlotBox box = text_box(at, "middle", params.x_values[i], 12);
        box.lo.x -= 3, box.hi.x += 3;
        if (room.take_if_free(box)) map.add_text("tp-tick tp-x", at, "middle", params.x_values[i]);
    }
    for (std::size_t i = 0; i < params.y_values.size(); ++i) {
        const Vec2 at(kLeft - 6, map.floor - map.cell_height * (static_cast<double>(i) + 0.5) + 4);
        const std::string words = shortened_text(params.y_values[i], 12, kLeft - 26);
        if (room.take_if_free(text_box(at, "end", words, 12))) map.add_text("tp-tick tp-y", at, "end", words);
    }
}

void draw_scale(HeatMap& map) {
    constexpr int kSteps = 48;
    const double top = map.floor + kBottom + 6, width = (kWidth - kLeft - kRight) / kSteps;
    for (int i = 0; i < kSteps; ++i) {
        const Vec2 lo(kLeft + i * width, top);
        map.add_cell(lo, lo + Vec2(width + 0.3, 8), (i + 0.5) / kSteps);
    }
    map.add_text("tp-note", {kLeft, top + 21}, "start", rounded_text(map.range.lo, 2));
    map.add_text("tp-note", {kWidth - kRight, top + 21}, "end", rounded_text(map.range.hi, 2));
    map.add_text("tp-note", {(kLeft + kWidth - kRight) / 2, top + 21}, "middle", map.params.value_label);
}

}  // namespace

PlotDrawing draw_heat_map(const HeatMapParams& params) {
    const double rows = static_cast<double>(std::max<std::size_t>(1, params.y_values.size())),
                 columns = static_cast<double>(std::max<std::size_t>(1, params.x_values.size()));
    HeatMap map{params};
    map.cell_width = (kWidth - kLeft - kRight) / columns;
    map.cell_height = std::min(std::max(kLeastRow, 248 / rows), kMostTall / rows);
    map.floor = kTop + map.cell_height * rows;
    map.range = range_of(params.values);
    map.drawing = {kWidth, map.floor + kBottom + kScaleRoom, params.title, {}};
    map.add_text("tp-title", {10, 21}, "start", shortened_text(params.title, 14, kWidth - 20));
    map.add_text("tp-note", {10, 37}, "start", shortened_text(params.subtitle, 11, kWidth - 20));
    draw_cells(map);
    map.drawing.shapes.push_back(
        {PlotShape::Kind::kRectangle, "tp-frame", {{kLeft, kTop}, {kWidth - kRight, map.floor}}});
    draw_ticks(map);
    map.add_text("tp-label", {(kLeft + kWidth - kRight) / 2, map.floor + 36}, "middle",
                 shortened_text(params.x_label, 12, kWidth - kLeft));
    map.add_text("tp-label", {15, (kTop + map.floor) / 2}, "middle",
                 shortened_text(params.y_label, 12, map.floor - kTop + 20));
    map.drawing.shapes.back().is_upright = true;
    draw_scale(map);
    return map.drawing;
}

// From a number to a colour that the colour-blind tell apart and that also prints in grey.

namespace {

constexpr double kCoefficients[7][3] = {
    {0.2777273272234177, 0.005407344544966578, 0.3340998053353061},
    {0.1050930431085774, 1.404613529898575, 1.384590162594685},
    {-0.3308618287255563, 0.214847559468213, 0.09509516302823659},
    {-4.634230498983486, -5.799100973351585, -19.33244095627987},
    {6.228269936347081, 14.17993336680509, 56.69055260068105},
    {4.776384997670288, -13.74514537774601, -65.35303263337234},
    {-5.435455855934631, 4.645852612178535, 26.3124352495832},
};

/// As sRGB code values 0..1, in which the map is defined.
std::array<double, 3> viridis_srgb(double share) {
    const double t = share > 0 ? std::min(share, 1.0) : 0.0;
    std::array<double, 3> colour{};
    for (std::size_t channel = 0; channel < 3; ++channel) {
        double value = 0;
        for (int power = 6; power >= 0; --power) value = value * t + kCoefficients[power][channel];
        colour[channel] = std::clamp(value, 0.0, 1.0);
    }
    return colour;
}

}  // namespace

LinearRgb viridis(double share) {
    const std::array<double, 3> code = viridis_srgb(share);
    return {static_cast<float>(linear_from_srgb(code[0])), static_cast<float>(linear_from_srgb(code[1])),
            static_cast<float>(linear_from_srgb(code[2]))};
}

std::string viridis_hex(double share) {
    std::string text = "#";
    for (const double code : viridis_srgb(share)) {
        const int level = static_cast<int>(std::lround(code * 255));
        text += "0123456789abcdef"[level / 16];
        text += "0123456789abcdef"[level % 16];
    }
    return text;
}

double ColourRange::share(double value) const {
    if (!(value > lo)) return 0;
    return std::min(1.0, std::log(value / lo) / std::log(hi / lo));
}

}  // namespace trilens
