#include "report/plot_labels.h"

#include <algorithm>
#include <cstddef>

namespace trilens {
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
