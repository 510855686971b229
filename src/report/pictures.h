// Images for reports: tone-mapped pictures, false-colour errors, displacement maps.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/image/image.h"
#include "report/heat_map.h"

namespace trilens {

inline constexpr int kLargestPicture = 1280;  // width, pixels

/// What the colours of a picture mean.
struct ColourLegend {
    ColourRange range;
    std::string unit;
};

/// A picture as a report embeds it, at the film's size where that is no wider than kLargestPicture: PNG bytes
/// and what they show.
struct PagePicture {
    std::string caption;
    int width = 0, height = 0;
    std::vector<unsigned char> png = {};      // empty: there is none, and the caption says why
    std::optional<ColourLegend> legend = {};  // of a colour-mapped one
    bool is_over_previous = false;  // shows the same as the picture before it: a slider between them
    std::string file = {};  // where the page finds it, a path from its folder; empty: it carries the bytes

    bool is_there() const { return !png.empty() || !file.empty(); }
};

/// R G B of the whole film (black outside the data window), scaled down to kLargestPicture where wider;
/// values that are not finite show as magenta. Throws InputError where a channel is missing.
PagePicture beauty_picture(const Image& image, const std::string& caption);

/// scale * |test - truth| per channel, the same way. The films must be of one size.
PagePicture difference_picture(const Image& test, const Image& truth, double scale,
                               const std::string& caption);

/// The colours of `range` over a film of width x height values, rows from the top: NaN (nothing to measure)
/// is grey, infinite (lost) is orange, minus infinite (unmeasured) is white. Where it is scaled down, a pixel
/// shows the largest value under it.
PagePicture displacement_picture(std::span<const float> pixels, int width, const ColourRange& range,
                                 const std::string& caption);

/// What a displacement picture's colours mean beside its scale, for those of the values that occur:
/// "; grey: none, orange: lost".
std::string displacement_colours(std::span<const float> pixels);

/// Viridis from 0 (dark) to 1 (yellow) over a film of width x height values, rows from the top: NaN is grey.
/// Where it is scaled down, a pixel shows the largest value under it.
PagePicture share_picture(std::span<const float> shares, int width, const std::string& caption);

/// The largest power of two, between 1 and 2^20, that keeps scale * difference below 1.
double difference_scale(double difference);

}  // namespace trilens
