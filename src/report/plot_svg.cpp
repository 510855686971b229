// A plot's shapes as an SVG document.
#include <array>
#include <cmath>
#include <numbers>

#include "report/plot.h"
#include "report/text.h"

namespace trilens {
namespace {

std::string pixel_text(double pixel) {
    return fixed_text(pixel, 2);
}
std::string attribute(const char* name, double pixel) {
    return std::string(" ") + name + "=\"" + pixel_text(pixel) + "\"";
}
std::string style_of(const PlotShape& shape) {
    return "class=\"" + shape.style + "\"";
}

std::string line(const PlotShape& shape) {
    const Vec2 &a = shape.points[0], &b = shape.points[1];
    return "<line " + style_of(shape) + attribute("x1", a.x) + attribute("y1", a.y) + attribute("x2", b.x) +
           attribute("y2", b.y) + "/>\n";
}

std::string rectangle(const PlotShape& shape) {
    const Vec2 lo = glm::min(shape.points[0], shape.points[1]),
               size = glm::abs(shape.points[1] - shape.points[0]);
    return "<rect " + style_of(shape) + attribute("x", lo.x) + attribute("y", lo.y) +
           attribute("width", size.x) + attribute("height", size.y) +
           (shape.fill.empty() ? "" : " fill=\"" + shape.fill + "\"") + "/>\n";
}

std::string path(const PlotShape& shape) {
    std::string places;
    for (const Vec2& at : shape.points)
        places += (places.empty() ? "M" : "L") + pixel_text(at.x) + "," + pixel_text(at.y);
    return "<path " + style_of(shape) + " d=\"" + places + "\"/>\n";
}

std::string words(const PlotShape& shape) {
    const Vec2 at = shape.is_upright ? Vec2(0) : shape.points[0];
    const std::string text = "<text " + style_of(shape) + attribute("x", at.x) + attribute("y", at.y) +
                             " text-anchor=\"" + shape.anchor + "\">" + escape_markup(shape.words) +
                             "</text>\n";
    if (!shape.is_upright) return text;
    return "<g transform=\"translate(" + pixel_text(shape.points[0].x) + "," + pixel_text(shape.points[0].y) +
           ") rotate(-90)\">" + text + "</g>\n";
}

std::string marker(const PlotShape& shape) {
    const Vec2& at = shape.points[0];
    const bool is_circle = shape.series % 8 == 0;
    std::string start;
    if (is_circle) {
        start = "<circle" + attribute("cx", at.x) + attribute("cy", at.y) + " r=\"4\"";
    } else {
        start = "<path d=\"";
        for (const std::vector<Vec2>& stroke : marker_strokes(shape.series)) {
            for (std::size_t i = 0; i < stroke.size(); ++i)
                start +=
                    (i ? "L" : "M") + pixel_text(at.x + stroke[i].x) + "," + pixel_text(at.y + stroke[i].y);
            if (stroke.front() == stroke.back()) start += "z";
        }
        start += "\"";
    }
    start += " " + style_of(shape);
    if (shape.words.empty()) return start + "/>\n";
    return start + "><title>" + escape_markup(shape.words) + "</title>" +
           (is_circle ? "</circle>\n" : "</path>\n");
}

std::string element(const PlotShape& shape) {
    switch (shape.kind) {
        case PlotShape::Kind::kLine:
            return line(shape);
        case PlotShape::Kind::kRectangle:
            return rectangle(shape);
        case PlotShape::Kind::kPath:
            return path(shape);
        case PlotShape::Kind::kText:
            return words(shape);
        case PlotShape::Kind::kMarker:
            return marker(shape);
    }
    return "";
}

}  // namespace

std::vector<std::vector<Vec2>> marker_strokes(std::size_t series) {
    using Strokes = std::vector<std::vector<Vec2>>;
    static const std::array<Strokes, 8> strokes = [] {
        std::array<Strokes, 8> all;
        std::vector<Vec2> circle;
        for (int i = 0; i <= 24; ++i) {
            const double angle = 2 * std::numbers::pi * (i % 24) / 24;
            circle.push_back({4 * std::cos(angle), 4 * std::sin(angle)});
        }
        all[0] = {circle};
        all[1] = {{{-3.6, -3.6}, {3.6, -3.6}, {3.6, 3.6}, {-3.6, 3.6}, {-3.6, -3.6}}};
        all[2] = {{{0, -5}, {4.6, 3}, {-4.6, 3}, {0, -5}}};
        all[3] = {{{0, -5}, {5, 0}, {0, 5}, {-5, 0}, {0, -5}}};
        all[4] = {{{0, 5}, {4.6, -3}, {-4.6, -3}, {0, 5}}};
        all[5] = {{{-4, -4}, {4, 4}}, {{4, -4}, {-4, 4}}};
        all[6] = {{{0, -5}, {0, 5}}, {{-5, 0}, {5, 0}}};
        all[7] = {{{-5, -2}, {5, -2}, {5, 2}, {-5, 2}, {-5, -2}}};
        return all;
    }();
    return strokes[series % strokes.size()];
}

std::string plot_svg(const PlotDrawing& drawing) {
    const std::string width = shortest_text(drawing.width), height = pixel_text(drawing.height);
    std::string svg = "<svg xmlns=\"http://www.w3.org/2000/svg\" class=\"tp\" width=\"" + width +
                      "\" height=\"" + height + "\" viewBox=\"0 0 " + width + " " + height +
                      "\" role=\"img\" aria-label=\"" + escape_markup(drawing.title) + "\">\n<style>" +
                      plot_style() + "</style>\n<rect class=\"tp-paper\" width=\"" + width + "\" height=\"" +
                      height + "\"/>\n";
    for (const PlotShape& shape : drawing.shapes) svg += element(shape);
    return svg + "</svg>\n";
}

}  // namespace trilens
