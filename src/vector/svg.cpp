// A drawing as SVG: conic arcs as cubic Bezier curves within a tolerance, the exact conics beside them.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>

#include "vector/drawing.h"

namespace trilens {
namespace {

constexpr double kStraightPixels = 1e-4;  // an arc whose control point is this near its chord is a line
constexpr int kDeepest = 12;
constexpr double kStrokeWidth = 0.9;
constexpr const char* kFoldColour = "#c01010";

/// An arc in standard form: Bezier weights 1, w, 1.
struct StandardArc {
    Vec2 p0, p1, p2;
    double w = 1;
};

StandardArc standard(const ScreenArc& arc) {
    const auto pixel = [](const Vec3& p) { return Vec2(p.x / p.z, p.y / p.z); };
    return {pixel(arc[0]), pixel(arc[1]), pixel(arc[2]), arc[1].z / std::sqrt(arc[0].z * arc[2].z)};
}

std::string number(double value, const char* format) {
    char buffer[40];
    std::snprintf(buffer, sizeof buffer, format, value);
    return buffer;
}

std::string place(const Vec2& p) {
    return number(p.x, "%.4f") + " " + number(p.y, "%.4f");
}

/// The cubic that meets the conic at its ends and its shoulder, with the same tangents (Floater, An O(h^2n)
/// Hermite approximation for conic sections, 1997): handles this share of the way to the control point.
double handle_share(double w) {
    return 4 * w / (3 * (1 + w));
}

/// How far the cubic leaves the conic: its points put into the conic's equation tau1^2 = 4 w^2 tau0 tau2 of
/// barycentrics of the control triangle, over the gradient.
double cubic_error(const StandardArc& arc) {
    const Vec2 e1 = arc.p1 - arc.p0, e2 = arc.p2 - arc.p0;
    const double whole = cross(e1, e2), share = handle_share(arc.w);
    const Vec2 g1(e2.y / whole, -e2.x / whole),
        g2(-e1.y / whole, e1.x / whole);  // gradients of tau1 and tau2
    double worst = 0;
    for (int i = 1; i < 16; ++i) {
        const double u = i / 16.0, v = 1 - u;
        const Vec2 p = 3 * v * v * u * share * e1 + 3 * v * u * u * (e2 + share * (e1 - e2)) + u * u * u * e2;
        const double t1 = cross(p, e2) / whole, t2 = cross(e1, p) / whole, t0 = 1 - t1 - t2,
                     k = 4 * arc.w * arc.w;
        const Vec2 gradient = 2 * t1 * g1 - k * (t0 * g2 - t2 * (g1 + g2));
        worst = std::max(worst, std::fabs(t1 * t1 - k * t0 * t2) / length(gradient));
    }
    return worst;
}

void append_path(const ScreenArc& exact, int depth, std::string& path) {
    const StandardArc arc = standard(exact);
    const Vec2 chord = arc.p2 - arc.p0;
    const double height = std::fabs(cross(chord, arc.p1 - arc.p0)) / std::max(length(chord), 1e-300);
    if (height <= kStraightPixels) {
        path += "L" + place(arc.p2);
        return;
    }
    if (depth < kDeepest && !(cubic_error(arc) <= kSvgTolerance)) {
        append_path(piece_of(exact, 0, 0.5), depth + 1, path);
        append_path(piece_of(exact, 0.5, 1), depth + 1, path);
        return;
    }
    const double share = handle_share(arc.w);
    path += "C" + place(arc.p0 + share * (arc.p1 - arc.p0)) + " " +
            place(arc.p2 + share * (arc.p1 - arc.p2)) + " " + place(arc.p2);
}

std::string exact_text(const EdgeCurve& curve) {
    std::string text;
    for (const ScreenArc& arc : curve.arcs) {
        const StandardArc s = standard(arc);
        text += text.empty() ? "" : ";";
        text += number(s.p0.x, "%.12g");
        for (const double value : {s.p0.y, s.p1.x, s.p1.y, s.p2.x, s.p2.y, s.w})
            text += " " + number(value, "%.12g");
    }
    return text;
}

/// A dark colour of its own for each object: hues by the golden angle.
std::string colour_of(Id object) {
    const double hue = std::fmod(210 + 137.508 * object, 360) / 60;
    const auto level = [&](double offset) {
        const double h = std::fmod(hue + offset, 6.0);
        const double tent = std::clamp(std::min(h, 4 - h), 0.0, 1.0);
        return static_cast<int>(std::lround(20 + 165 * tent));
    };
    char buffer[16];
    std::snprintf(buffer, sizeof buffer, "#%02x%02x%02x", level(2), level(0), level(4));
    return buffer;
}

std::string description(const Drawing& drawing) {
    std::string text = drawing.lines.wire
                           ? "Wire drawing: hidden edges are drawn too. "
                           : "Hidden edges are removed by testing points about 0.4 px apart against "
                             "a picture of 2 x 2 samples per pixel: visible "
                             "pieces end right to about half a pixel, and edges whose surroundings "
                             "are thinner than a sample may be missing. ";
    text +=
        "Drawn are borders, creases, changes of material and silhouettes of the polygons, as the first optic "
        "shows them through "
        "each of its facets; texture, light, curved silhouettes inside a facet of an optic and lines where "
        "surfaces cut through one another are not. "
        "Facets that own no "
        "sample, and arcs partly behind the camera, are left out. Paths are cubic Bezier curves within " +
        number(kSvgTolerance, "%g") +
        " px of the exact conic arcs in data-conic: x0 y0 x1 y1 x2 y2 w, a rational "
        "quadratic Bezier curve of weights 1 w 1 for each arc.";
    if (drawing.lines.folds)
        text +=
            " Dashed, of class fold: where what an optic or the camera shows turns over on the film, the "
            "images of "
            "caustics as the eye has them, as polygonal lines; none where paths are traced.";
    return text;
}

std::string group(const DrawingLayer& layer, Id object, const std::vector<const EdgeCurve*>& curves,
                  const World& world) {
    std::string svg = "<g class=\"" + layer.path + "\" data-object=\"" + std::to_string(object) + "\"";
    if (layer.optic != kNone) svg += " data-optic=\"" + std::to_string(layer.optic) + "\"";
    svg += " stroke=\"" + colour_of(object) + "\">\n<title>" + svg_text(world.names[object]) + "</title>\n";
    for (const EdgeCurve* curve : curves) {
        std::string path = "M" + place(standard(curve->arcs[0]).p0);
        for (const ScreenArc& arc : curve->arcs) append_path(arc, 0, path);
        svg += "<path d=\"" + path + "\" data-primitive=\"" +
               std::to_string(layer.scene->primitive[curve->triangle]) + "\" data-facet=\"" +
               std::to_string(curve->facet) + "\" data-conic=\"" + exact_text(*curve) + "\"/>\n";
    }
    return svg + "</g>\n";
}

std::string fold_group(const DrawingLayer& layer, const World& world) {
    if (layer.folds.empty()) return "";
    std::string svg = "<g class=\"fold\" data-path=\"" + layer.path + "\"";
    if (layer.optic != kNone) svg += " data-optic=\"" + std::to_string(layer.optic) + "\"";
    svg += " stroke=\"" + std::string(kFoldColour) + "\" stroke-dasharray=\"3 2\">\n<title>" +
           svg_text(layer.optic == kNone ? "camera" : world.names[layer.optic]) + "</title>\n";
    for (const FoldCurve& fold : layer.folds) {
        std::string path = "M" + place(fold.points[0]);
        for (std::size_t i = 1; i < fold.points.size(); ++i) path += "L" + place(fold.points[i]);
        svg += "<path d=\"" + path + "\" data-object=\"" + std::to_string(fold.object) + "\"/>\n";
    }
    return svg + "</g>\n";
}

}  // namespace

std::string svg_text(const std::string& text) {
    std::string out;
    for (const char c : text) {
        if (c == '&')
            out += "&amp;";
        else if (c == '<')
            out += "&lt;";
        else if (c == '>')
            out += "&gt;";
        else if (c == '"')
            out += "&quot;";
        else
            out += static_cast<unsigned char>(c) < 0x20 ? ' ' : c;
    }
    return out;
}

std::string drawing_svg(const Drawing& drawing, const World& world) {
    const std::string width = std::to_string(drawing.width), height = std::to_string(drawing.height);
    std::string svg =
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"" +
        width + "\" height=\"" + height + "\" viewBox=\"0 0 " + width + " " + height + "\">\n<desc>" +
        svg_text(description(drawing)) + "</desc>\n<rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n" +
        "<g fill=\"none\" stroke-width=\"" + number(kStrokeWidth, "%g") +
        "\" stroke-linecap=\"round\" stroke-linejoin=\"round\">\n";
    for (const auto& layer : drawing.layers) {
        std::map<Id, std::vector<const EdgeCurve*>> by_object;
        for (const EdgeCurve& curve : layer->curves)
            by_object[layer->scene->object[curve.triangle]].push_back(&curve);
        for (const auto& [object, curves] : by_object) svg += group(*layer, object, curves, world);
    }
    for (const auto& layer : drawing.layers) svg += fold_group(*layer, world);
    return svg + "</g>\n" + marks_svg(drawing.marks, world) + "</svg>\n";
}

}  // namespace trilens
