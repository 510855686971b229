// Points and labels of a drawing as SVG: ellipses and texts.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "base/math/srgb.h"
#include "base/util/format.h"
#include "render/world/world.h"
#include "vector/drawing.h"

namespace trilens {
namespace {

std::string hex_color(const Vec3& light) {
    const auto code = [](double value) {
        return static_cast<int>(std::lround(255 * srgb_from_linear(std::clamp(value, 0.0, 1.0))));
    };
    return fmt::format("#{:02x}{:02x}{:02x}", code(light.x), code(light.y), code(light.z));
}

std::string ellipse(const PlacedMark& mark) {
    return fmt::format(
        "<ellipse cx=\"{0:.4f}\" cy=\"{1:.4f}\" rx=\"{2:.4f}\" ry=\"{3:.4f}\" transform=\"rotate({4:.4f} "
        "{0:.4f} "
        "{1:.4f})\" fill=\"{5}\" fill-opacity=\"{6:.4f}\"/>",
        mark.pixel.x, mark.pixel.y, std::sqrt(mark.spread.most()), std::sqrt(mark.spread.least()),
        mark.spread.angle() * 180 / std::numbers::pi, hex_color(mark.light), mark.opacity);
}

std::string text(const PlacedMark& mark, const Label& label) {
    const Vec2 left = mark.pixel + label.offset;
    return fmt::format(
        "<text x=\"{:.4f}\" y=\"{:.4f}\" font-size=\"{:g}\" font-family=\"DejaVu Sans, sans-serif\" "
        "dy=\"0.35em\" fill=\"{}\" stroke=\"{}\" stroke-width=\"3\" stroke-opacity=\"0.75\" "
        "paint-order=\"stroke\">{}</text>",
        left.x, left.y, label.style.size, hex_color(mark.light), hex_color(contrast_of(mark.light)),
        svg_text(label.style.text));
}

}  // namespace

std::string marks_svg(const PlacedMarks& marks, const World& world) {
    if (marks.marks.empty()) return "";
    std::string svg = "<g class=\"marks\">\n";
    for (const PlacedMark& mark : marks.marks) {
        svg += fmt::format("<g class=\"{}\" data-{}=\"{}\" data-point=\"{}\"", path_name(mark.path),
                           mark.is_label ? "label" : "points", mark.entry, mark.point);
        if (mark.optic != kNone) svg += fmt::format(" data-optic=\"{}\"", mark.optic);
        svg += ">" + (mark.spread.xx > 0 ? ellipse(mark) : "");
        if (mark.is_label) svg += text(mark, world.scene.labels[mark.entry]);
        svg += "</g>\n";
    }
    return svg + "</g>\n";
}

}  // namespace trilens
