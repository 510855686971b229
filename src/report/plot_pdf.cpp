// A plot's shapes as a PDF document (ISO 32000-1): one page, one content stream, the standard fonts.
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <utility>

#include "report/plot.h"
#include "report/text.h"

namespace trilens {
namespace {

constexpr double kPoint = 0.75;  // points per pixel

/// How a style is drawn; as plot_style says it for SVG.
struct Pen {
    std::string stroke = {}, fill = {};  // "#rrggbb"; empty: none
    double width = 1;
    const char* dash = "";
    double font_size = 12;
    bool is_bold = false;
};

bool has_class(const std::string& style, std::string_view name) {
    return (" " + style + " ").find(" " + std::string(name) + " ") != std::string::npos;
}

std::string series_colour(const std::string& style) {
    for (std::size_t i = 0; i < kPlotColours; ++i)
        if (has_class(style, plot_series_class(i))) return plot_series_colour(i);
    return "#444444";
}

Pen pen_of(const PlotShape& shape) {
    const std::string& style = shape.style;
    if (shape.kind == PlotShape::Kind::kText) {
        if (has_class(style, "tp-title")) return {"", "#111111", 1, "", 14, true};
        if (has_class(style, "tp-note")) return {"", shape.fill.empty() ? "#616a73" : shape.fill, 1, "", 11};
        return {"", shape.fill.empty() ? "#333333" : shape.fill};
    }
    if (has_class(style, "tp-grid")) return {"#cdd2d8"};
    if (has_class(style, "tp-minor")) return {"#eceff2"};
    if (has_class(style, "tp-frame")) return {"#8a929b"};
    if (has_class(style, "tp-level")) return {"#8a929b", "", 1, "2 3"};
    if (has_class(style, "tp-reference")) return {"#b9c0c8", "", 1.5, "7 4"};
    if (has_class(style, "tp-cell")) return {"", shape.fill};
    const std::string colour = series_colour(style);
    const bool is_over = has_class(style, "tp-over");
    if (has_class(style, "tp-marker")) return {colour, is_over ? "" : colour, 1.6};
    // Joins are faint: the colour's third on white.
    return {colour, "", has_class(style, "tp-join") ? 0.5 : 1.8, is_over ? "6 6" : ""};
}

std::string colour_numbers(const std::string& hex) {
    std::string text;
    for (std::size_t i = 1; i + 1 < hex.size(); i += 2)
        text += rounded_text(std::stoi(hex.substr(i, 2), nullptr, 16) / 255.0, 3) + " ";
    return text;
}

std::string number(double value) {
    return fixed_text(value, 2);
}

/// The next character of UTF-8 text in Windows 1252; takes it off the text.
unsigned char next_character(std::string_view& text) {
    const auto byte = [&](std::size_t i) {
        return i < text.size() ? static_cast<unsigned char>(text[i]) : 0u;
    };
    const unsigned lead = byte(0);
    const std::size_t length = lead < 0x80 ? 1 : lead >= 0xF0 ? 4 : lead >= 0xE0 ? 3 : 2;
    std::uint32_t code = lead < 0x80 ? lead : lead & (0xFFu >> (length + 1));
    for (std::size_t i = 1; i < length; ++i) code = code << 6 | (byte(i) & 0x3Fu);
    text.remove_prefix(std::min(length, text.size()));
    constexpr std::array<std::pair<std::uint32_t, unsigned char>, 6> kOthers = {
        {{0x2013, 0x96}, {0x2014, 0x97}, {0x2026, 0x85}, {0x2212, '-'}, {0x2192, '>'}, {0x2264, '<'}}};
    for (const auto& [known, encoded] : kOthers)
        if (code == known) return encoded;
    const bool is_same = (code >= 0x20 && code < 0x7F) || (code >= 0xA0 && code < 0x100);
    return is_same ? static_cast<unsigned char>(code) : '?';
}

// Advance widths of Helvetica, thousandths of the size, characters 32 to 126 (Adobe's font metrics).
constexpr std::array<int, 95> kWidths = {
    278, 278, 355, 556, 556, 889, 667, 191, 333, 333, 389, 584, 278, 333,  278, 278, 556, 556, 556,
    556, 556, 556, 556, 556, 556, 556, 278, 278, 584, 584, 584, 556, 1015, 667, 667, 722, 722, 667,
    611, 778, 722, 278, 500, 667, 556, 833, 722, 778, 667, 778, 722, 667,  611, 722, 667, 944, 667,
    667, 611, 278, 278, 278, 469, 556, 333, 556, 556, 500, 556, 556, 278,  556, 556, 222, 222, 500,
    222, 833, 556, 556, 556, 556, 333, 500, 278, 556, 500, 722, 500, 500,  500, 334, 260, 334, 584};

struct EncodedText {
    std::string escaped;  // as a PDF string's inside
    double width = 0;     // at size 1
};

EncodedText encode(std::string_view utf8) {
    EncodedText text;
    while (!utf8.empty()) {
        const unsigned char c = next_character(utf8);
        if (c == '(' || c == ')' || c == '\\') text.escaped += '\\';
        text.escaped += static_cast<char>(c);
        text.width += (c >= 32 && c < 127 ? kWidths[c - 32u] : 584) / 1000.0;
    }
    return text;
}

/// Where shapes are on the page: points, y up.
struct Page {
    const PlotDrawing& drawing;
    std::string content = {};

    Vec2 place(const Vec2& pixel) const { return {kPoint * pixel.x, kPoint * (drawing.height - pixel.y)}; }
    void set_pen(const Pen& pen) {
        if (!pen.stroke.empty()) content += colour_numbers(pen.stroke) + "RG ";
        if (!pen.fill.empty()) content += colour_numbers(pen.fill) + "rg ";
        content += number(kPoint * pen.width) + " w [" + pen.dash + "] 0 d\n";
    }
    void add_stroke(const std::vector<Vec2>& points, const Vec2& shift) {
        for (std::size_t i = 0; i < points.size(); ++i) {
            const Vec2 at = place(points[i] + shift);
            content += number(at.x) + " " + number(at.y) + (i ? " l " : " m ");
        }
    }
    void add_words(const PlotShape& shape, const Pen& pen) {
        const EncodedText text = encode(shape.words);
        const double size = kPoint * pen.font_size, width = text.width * size,
                     back = shape.anchor == "end"      ? width
                            : shape.anchor == "middle" ? width / 2
                                                       : 0;
        const Vec2 at = place(shape.points[0]) - (shape.is_upright ? Vec2(0, back) : Vec2(back, 0));
        content += std::string("BT /") + (pen.is_bold ? "B" : "F") + " " + number(size) + " Tf " +
                   (shape.is_upright ? "0 1 -1 0 " : "1 0 0 1 ") + number(at.x) + " " + number(at.y) +
                   " Tm (" + text.escaped + ") Tj ET\n";
    }
    void add(const PlotShape& shape) {
        if (shape.points.empty()) return;
        const Pen pen = pen_of(shape);
        set_pen(pen);
        if (shape.kind == PlotShape::Kind::kText) return add_words(shape, pen);
        if (shape.kind == PlotShape::Kind::kMarker) {
            for (const std::vector<Vec2>& stroke : marker_strokes(shape.series)) {
                add_stroke(stroke, shape.points[0]);
                content += stroke.front() != stroke.back() ? "S\n" : pen.fill.empty() ? "s\n" : "b\n";
            }
            return;
        }
        if (shape.kind == PlotShape::Kind::kRectangle) {
            const Vec2 &a = shape.points[0], &b = shape.points[1];
            add_stroke({a, {b.x, a.y}, b, {a.x, b.y}, a}, Vec2(0));
        } else {
            add_stroke(shape.points, Vec2(0));
        }
        content += pen.fill.empty() ? "S\n" : "f\n";
    }
};

}  // namespace

std::string plot_pdf(const PlotDrawing& drawing) {
    Page page{drawing};
    for (const PlotShape& shape : drawing.shapes) page.add(shape);
    const std::string font = "<< /Type /Font /Subtype /Type1 /Encoding /WinAnsiEncoding /BaseFont /Helvetica";
    const std::string objects[] = {
        "<< /Type /Catalog /Pages 2 0 R >>",
        "<< /Type /Pages /Kids [3 0 R] /Count 1 >>",
        "<< /Type /Page /Parent 2 0 R /MediaBox [0 0 " + number(kPoint * drawing.width) + " " +
            number(kPoint * drawing.height) +
            "] /Contents 4 0 R /Resources << /Font << /F 5 0 R /B 6 0 R >> >> >>",
        "<< /Length " + std::to_string(page.content.size()) + " >>\nstream\n" + page.content + "endstream",
        font + " >>",
        font + "-Bold >>",
        "<< /Title (" + encode(drawing.title).escaped + ") /Producer (trilens) >>"};
    std::string pdf = "%PDF-1.4\n%\xE2\xE3\xCF\xD3\n", table;
    std::size_t count = 0;
    for (const std::string& object : objects) {
        const std::string offset = std::to_string(pdf.size());
        table += std::string(10 - offset.size(), '0') + offset + " 00000 n \n";
        pdf += std::to_string(++count) + " 0 obj\n" + object + "\nendobj\n";
    }
    const std::string size = std::to_string(count + 1);
    return pdf + "xref\n0 " + size + "\n0000000000 65535 f \n" + table + "trailer\n<< /Size " + size +
           " /Root 1 0 R /Info 7 0 R >>\nstartxref\n" + std::to_string(pdf.size()) + "\n%%EOF\n";
}

}  // namespace trilens
