// Plots as Vega-Lite specifications (version 5), for those who draw them their own way.
#include <algorithm>
#include <cmath>

#include "report/heat_map.h"
#include "report/plot.h"
#include "report/text.h"

namespace trilens {
namespace {

std::string axis_text(const std::string& field, const std::string& title, bool is_linear) {
    return "{\"field\":" + json_text(field) + ",\"type\":\"quantitative\",\"title\":" + json_text(title) +
           ",\"scale\":{\"type\":\"" + (is_linear ? "linear" : "log") + "\"}}";
}

std::string datum(const std::string& series, double x, double y) {
    return "{\"series\":" + json_text(series) + ",\"x\":" + shortest_text(x) + ",\"y\":" + shortest_text(y) +
           "}";
}

std::string list_of(const std::vector<std::string>& items) {
    std::string text = "[";
    for (std::size_t i = 0; i < items.size(); ++i) text += (i ? ",\n" : "\n") + items[i];
    return text + "\n]";
}

std::string document(const std::string& title, const std::string& rest) {
    return "{\"$schema\":\"https://vega.github.io/schema/vega-lite/v5.json\",\n\"title\":" +
           json_text(title) + ",\n" + rest + "}\n";
}

}  // namespace

std::string vega_lite_plot(const PlotParams& params, std::span<const PlotSeries> series) {
    std::vector<std::string> points, lines;
    for (const PlotSeries& one : series) {
        double least = INFINITY, most = -INFINITY;
        for (const Vec2& point : one.points) {
            const bool can_show = std::isfinite(point.x) && std::isfinite(point.y) &&
                                  (params.is_linear || (point.x > 0 && point.y > 0));
            if (!can_show) continue;
            points.push_back(datum(one.name, point.x, point.y));
            least = std::min(least, point.x), most = std::max(most, point.x);
        }
        if (!one.fit || params.is_linear || !(least <= most)) continue;
        for (const double x : {least, most})
            lines.push_back(datum(one.name, x, one.fit->constant * std::pow(x, -one.fit->order)));
    }
    const std::string encoding = "\"encoding\":{\"x\":" + axis_text("x", params.x_label, params.is_linear) +
                                 ",\"y\":" + axis_text("y", params.y_label, params.is_linear) +
                                 ",\"color\":{\"field\":\"series\",\"type\":\"nominal\",\"title\":null},"
                                 "\"shape\":{\"field\":\"series\",\"type\":\"nominal\",\"title\":null}}";
    std::string layers =
        "\"layer\":[{\"data\":{\"values\":" + list_of(points) + "},\"mark\":\"point\"," + encoding + "}";
    if (!lines.empty())
        layers += ",\n{\"data\":{\"values\":" + list_of(lines) + "},\"mark\":\"line\"," + encoding + "}";
    return document(params.title, layers + "]");
}

std::string vega_lite_heat_map(const HeatMapParams& params) {
    std::vector<std::string> cells;
    for (std::size_t row = 0; row < params.y_values.size(); ++row)
        for (std::size_t column = 0; column < params.x_values.size(); ++column) {
            const double value = params.cell(column, row);
            if (std::isfinite(value))
                cells.push_back("{\"x\":" + json_text(params.x_values[column]) + ",\"y\":" +
                                json_text(params.y_values[row]) + ",\"value\":" + shortest_text(value) + "}");
        }
    const auto axis = [](const char* field, const std::string& title) {
        return std::string("{\"field\":\"") + field +
               "\",\"type\":\"ordinal\",\"sort\":null,\"title\":" + json_text(title) + "}";
    };
    return document(params.title, "\"data\":{\"values\":" + list_of(cells) +
                                      "},\n\"mark\":\"rect\",\n\"encoding\":{\"x\":" +
                                      axis("x", params.x_label) + ",\"y\":" + axis("y", params.y_label) +
                                      ",\"color\":{\"field\":\"value\",\"type\":\"quantitative\",\"title\":" +
                                      json_text(params.value_label) +
                                      ",\"scale\":{\"type\":\"log\",\"scheme\":\"viridis\"}}}");
}

}  // namespace trilens
