// A plot's scales, their ticks, and labels that do not touch one another.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "base/math/vec.h"

namespace trilens {

enum class ScaleKind { kLinear, kLog };

/// Maps values lo..hi to pixels first..last; on a log scale lo and hi are positive.
struct PlotScale {
    ScaleKind kind = ScaleKind::kLinear;
    double lo = 0, hi = 1;
    double first = 0, last = 1;

    /// Whether the scale can show `value` somewhere: finite, and positive on a log scale.
    bool can_show(double value) const;
    double pixel(double value) const;
};

struct PlotTick {
    double value = 0;
    std::string label;    // empty: a faint line only
    bool strong = false;  // a decade, or every labelled tick of a linear scale
};

/// A scale whose range holds all `values` that it can show, with a margin; a log range is at least one decade
/// long. Without any such value: 0..1, or 1..10 on a log scale.
PlotScale fit_scale(ScaleKind kind, std::span<const double> values);

/// The ticks within the range, ascending: decades and their multiples 2..9 on a log scale, round steps on a
/// linear one.
std::vector<PlotTick> make_ticks(const PlotScale& scale);

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
