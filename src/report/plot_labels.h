// Room for the words of a plot: no word covers another one or a measurement.
#pragma once

#include <string>
#include <vector>

#include "base/math/vec.h"

namespace trilens {

/// A rectangle of pixels, y down.
struct PlotBox {
    Vec2 lo{0}, hi{0};
};

/// The width that a text takes at most in the fonts that plots ask for, pixels.
double text_width(const std::string& utf8, double font_size);

/// The text, or as much of it as fits into `width` pixels, and then "…".
std::string shortened_text(const std::string& utf8, double font_size, double width);

/// Where a text stands: `anchor` is "start", "middle" or "end", `at` is on its baseline.
PlotBox text_box(const Vec2& at, const std::string& anchor, const std::string& utf8, double font_size);

/// What is taken of a picture.
class PlotRoom {
  public:
    void take(const PlotBox& box) { taken_.push_back(box); }
    bool is_free(const PlotBox& box) const;
    /// Takes the box where it is free, and says whether it was.
    bool take_if_free(const PlotBox& box);

  private:
    std::vector<PlotBox> taken_;
};

}  // namespace trilens
