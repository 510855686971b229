// Where a value stands along a plot's axis, linear or logarithmic, and which values are worth a tick.
#pragma once

#include <span>
#include <string>
#include <vector>

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

}  // namespace trilens
